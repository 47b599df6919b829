//! What happens in a scene, said without any engine: bodies, springs, and where everything should be when.

use bevy::math::{DVec3, Vec3};

/// A scene with a known motion.
pub struct Problem {
    pub gravity: Vec3,
    pub bodies: Vec<Body>,
    pub links: Vec<Link>,
    /// A plane y = 0 that carries wheels.
    pub ground: bool,
    /// How long the motion is followed, s.
    pub seconds: f64,
    /// Size of the motion, m: whoever is off by ten times as much has diverged.
    pub size: f64,
    /// Energy against which its drift is measured, J; `None` where it is not conserved.
    pub energy: Option<f64>,
    pub truth: Truth,
}

impl Problem {
    /// Whether there is a spring that no joint can be.
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

/// How a body moves.
#[derive(Clone, Copy)]
pub enum Kind {
    Fixed,
    /// Mass (kg) and principal inertia (kg m²), without a shape.
    Free {
        mass: f32,
        inertia: Vec3,
    },
    /// As `Free`, up and down only.
    Upright {
        mass: f32,
    },
    /// A ball that stands on the ground, up and down only.
    Wheel {
        mass: f32,
        radius: f32,
    },
}

/// A spring-damper.
#[derive(Clone, Copy)]
pub struct Link {
    pub ends: [usize; 2],
    /// In the bodies' frames.
    pub anchors: [Vec3; 2],
    pub stiffness: f32,
    pub damping: f32,
    pub rest: f32,
    /// What the cube of the stretch adds, N/m³.
    pub cubic: f32,
}

/// Where the watched bodies are at a time; `None` where it is not known.
pub struct Truth {
    pub watched: Vec<usize>,
    pub at: Box<dyn Fn(f64) -> Option<Vec<DVec3>>>,
}

impl Body {
    pub fn fixed(at: Vec3) -> Self {
        Self::new(Kind::Fixed, at)
    }

    /// A body whose inertia plays no part.
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

    /// 0 for a fixed one.
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
    /// Between the centres of two bodies.
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

    /// Between these points of the bodies.
    pub fn anchored(mut self, anchors: [Vec3; 2]) -> Self {
        self.anchors = anchors;
        self
    }

    /// With a cubic part, N/m³.
    pub fn hardening(mut self, cubic: f32) -> Self {
        self.cubic = cubic;
        self
    }
}

impl Truth {
    /// Rows of a reference file, one every 1/240 s: t, then `width` coordinates of each watched body.
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

    /// One body whose place is a formula.
    pub fn formula(body: usize, at: impl Fn(f64) -> DVec3 + 'static) -> Self {
        Self {
            watched: vec![body],
            at: Box::new(move |t| Some(vec![at(t)])),
        }
    }
}
