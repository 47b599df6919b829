//! Describes a scene without reference to an engine: bodies, springs, and the true positions over time.

use bevy::math::{DVec3, Vec3};

/// A scene with a known motion.
pub struct Problem {
    pub gravity: Vec3,
    pub bodies: Vec<Body>,
    pub links: Vec<Link>,
    /// Whether there is a ground plane y = 0, on which wheels stand.
    pub ground: bool,
    /// Simulated time, s.
    pub seconds: f64,
    /// Size of the motion, m. A method has diverged once its error exceeds ten times this size.
    pub size: f64,
    /// Energy by which the energy drift is divided, J. `None` where energy is not conserved.
    pub energy: Option<f64>,
    pub truth: Truth,
}

impl Problem {
    /// Whether the scene has a nonlinear spring, which no joint offers.
    pub fn is_nonlinear(&self) -> bool {
        self.links.iter().any(|link| link.cubic > 0.0)
    }
}

/// A body, or a fixed point.
#[derive(Clone, Copy)]
pub struct Body {
    pub kind: Kind,
    pub at: Vec3,
    pub velocity: Vec3,
    pub spin: Vec3,
}

/// What kind of body it is and how it may move.
#[derive(Clone, Copy)]
pub enum Kind {
    Fixed,
    /// Free body without a shape, with mass (kg) and principal moments of inertia (kg m²).
    Free {
        mass: f32,
        inertia: Vec3,
    },
    /// Body of a mass (kg), without a shape, that moves up and down only.
    Upright {
        mass: f32,
    },
    /// Ball of a mass (kg) and a radius (m) that stands on the ground and moves up and down only.
    Wheel {
        mass: f32,
        radius: f32,
    },
}

/// A spring-damper.
#[derive(Clone, Copy)]
pub struct Link {
    pub ends: [usize; 2],
    /// Anchors in the local frames of the two bodies, m.
    pub anchors: [Vec3; 2],
    pub stiffness: f32,
    pub damping: f32,
    pub rest: f32,
    /// Stiffness of the cubic term of the tension, N/m³.
    pub cubic: f32,
}

/// True positions of the watched bodies at a time in s. `at` returns `None` for times without reference data.
pub struct Truth {
    pub watched: Vec<usize>,
    pub at: Box<dyn Fn(f64) -> Option<Vec<DVec3>>>,
}

impl Truth {
    /// Nothing is known, and nothing is watched: for scenes that are only timed.
    pub fn unknown() -> Self {
        Self {
            watched: Vec::new(),
            at: Box::new(|_| None),
        }
    }
}

impl Body {
    pub fn fixed(at: Vec3) -> Self {
        Self::new(Kind::Fixed, at)
    }

    /// A free body in whose scene the moments of inertia do not matter.
    pub fn point(mass: f32, at: Vec3) -> Self {
        let inertia = Vec3::splat(0.4 * mass);
        Self::new(Kind::Free { mass, inertia }, at)
    }

    pub fn new(kind: Kind, at: Vec3) -> Self {
        Self {
            kind,
            at,
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
        }
    }

    pub fn moving(mut self, velocity: Vec3) -> Self {
        self.velocity = velocity;
        self
    }

    pub fn spinning(mut self, spin: Vec3) -> Self {
        self.spin = spin;
        self
    }

    /// Inverse mass, 1/kg. 0 for a fixed body.
    pub fn inverse_mass(&self) -> f32 {
        match self.kind {
            Kind::Fixed => 0.0,
            Kind::Free { mass, .. } | Kind::Upright { mass } | Kind::Wheel { mass, .. } => {
                mass.recip()
            }
        }
    }
}

impl Link {
    /// A linear spring between the centres of two bodies.
    pub fn new(a: usize, b: usize, stiffness: f32, damping: f32, rest: f32) -> Self {
        Self {
            ends: [a, b],
            anchors: [Vec3::ZERO; 2],
            stiffness,
            damping,
            rest,
            cubic: 0.0,
        }
    }

    /// Attaches the spring at these points, in the local frames of the two bodies.
    pub fn anchored(mut self, anchors: [Vec3; 2]) -> Self {
        self.anchors = anchors;
        self
    }

    /// Adds a cubic term to the tension, N/m³.
    pub fn hardening(mut self, cubic: f32) -> Self {
        self.cubic = cubic;
        self
    }
}

impl Truth {
    /// Reads a reference file with one row every 1/240 s: t, then `width` coordinates of each watched body.
    pub fn rows(text: &str, watched: &[usize], width: usize) -> Self {
        let rows: Vec<Vec<f64>> = text
            .lines()
            .skip(2)
            .map(|line| line.split(',').filter_map(|x| x.parse().ok()).collect())
            .collect();
        let at = move |t: f64| {
            let place = t * 240.0;
            let near = place.round();
            if (place - near).abs() > 1e-6 {
                return None;
            }
            let row = rows.get(near as usize)?;
            let vector = |c: &[f64]| DVec3::new(c[0], c[1], c.get(2).copied().unwrap_or(0.0));
            Some(row.get(1..)?.chunks_exact(width).map(vector).collect())
        };
        Self {
            watched: watched.to_vec(),
            at: Box::new(at),
        }
    }

    /// One watched body, whose position is given by a formula.
    pub fn formula(body: usize, at: impl Fn(f64) -> DVec3 + 'static) -> Self {
        Self {
            watched: vec![body],
            at: Box::new(move |t| Some(vec![at(t)])),
        }
    }
}
