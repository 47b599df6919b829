//! A lab that keeps a list of its bodies and springs, so that their energy follows from geometry alone.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A spring of the scene.
#[derive(Clone, Copy)]
pub struct SceneSpring {
    pub ends: [Entity; 2],
    pub anchors: [Vec3; 2],
    pub stiffness: f32,
    pub rest_length: f32,
}

pub struct Stand {
    pub lab: Lab,
    pub bodies: Vec<Entity>,
    pub coils: Vec<SceneSpring>,
    pub gravity: f64,
}

/// The step methods of the plugin. Tests of held elements demand the same result of each.
pub fn ways() -> [(&'static str, CoiloverPlugin); 5] {
    let plain = CoiloverPlugin::default;
    [
        ("1", plain()),
        ("4", plain().with_microsteps(4)),
        ("16", plain().with_microsteps(16)),
        ("extrapolated", plain().with_extrapolation()),
        ("by tolerance", plain().with_tolerance(1e-3)),
    ]
}

impl Stand {
    pub fn new(plugin: CoiloverPlugin, engine: Engine) -> Self {
        Self {
            gravity: f64::from(engine.gravity.length()),
            lab: Lab::with(plugin, engine),
            bodies: Vec::new(),
            coils: Vec::new(),
        }
    }

    /// Spawns a half-space with friction 0.8.
    pub fn ground(&mut self) -> Entity {
        self.lab.spawn((
            Collider::halfspace(Vec3::Y).expect("up"),
            Friction::new(0.8),
            Transform::default(),
        ))
    }

    pub fn body(&mut self, at: impl Into<Transform>, bundle: impl Bundle) -> Entity {
        let entity = self.lab.spawn((
            RigidBody::Dynamic,
            at.into(),
            Velocity::default(),
            Sleeping::default(),
            ReadMassProperties::default(),
        ));
        self.lab.app.world_mut().entity_mut(entity).insert(bundle);
        self.bodies.push(entity);
        entity
    }

    /// Spawns a cube with edges of half a metre.
    pub fn cube(&mut self, at: Vec3, mass: f32) -> Entity {
        let mass = ColliderMassProperties::Mass(mass);
        let body = (Collider::cuboid(0.25, 0.25, 0.25), mass);
        self.body(Transform::from_translation(at), body)
    }

    /// Spawns a body that a joint guides up and down. Its mass is in kg.
    pub fn guided(&mut self, at: Vec3, mass: f32) -> Entity {
        let base = self.lab.spawn((RigidBody::Fixed, Transform::default()));
        let guide = GenericJointBuilder::new(
            JointAxesMask::LIN_X | JointAxesMask::LIN_Z | JointAxesMask::ANG_AXES,
        );
        let joint = ImpulseJoint::new(base, TypedJoint::GenericJoint(guide.build()));
        let mass = AdditionalMassProperties::Mass(mass);
        self.body(Transform::from_translation(at), (mass, joint))
    }

    /// Spawns a spring between two anchors. Without a `rest_length` it is at rest where it is.
    pub fn coil(
        &mut self,
        ends: [Entity; 2],
        anchors: [Vec3; 2],
        [stiffness, damping]: [f32; 2],
        rest_length: Option<f32>,
    ) -> Entity {
        let rest_length = rest_length.unwrap_or_else(|| self.distance(ends, anchors));
        let element = self.lab.spawn((
            SpringDamper::new(ends[0], ends[1])
                .with_stiffness(stiffness)
                .with_damping(damping)
                .with_rest_length(rest_length),
            Anchors::new(anchors[0], anchors[1]),
        ));
        self.coils.push(SceneSpring {
            ends,
            anchors,
            stiffness,
            rest_length,
        });
        element
    }

    pub fn distance(&self, ends: [Entity; 2], anchors: [Vec3; 2]) -> f32 {
        let [a, b] = self.places(ends, anchors);
        a.distance(b)
    }

    /// Positions of two anchors, m.
    pub fn places(&self, ends: [Entity; 2], anchors: [Vec3; 2]) -> [Vec3; 2] {
        [0, 1].map(|end| {
            let body = self.lab.get::<Transform>(ends[end]);
            body.transform_point(anchors[end])
        })
    }

    pub fn length(&self, coil: &SceneSpring) -> f64 {
        f64::from(self.distance(coil.ends, coil.anchors))
    }

    /// Kinetic energy of all bodies, J.
    pub fn motion(&self) -> f64 {
        let of = |body: &Entity| {
            let m = self.lab.get::<ReadMassProperties>(*body).get();
            let (v, turn) = (
                self.lab.get::<Velocity>(*body),
                self.lab.get::<Transform>(*body),
            );
            let axes = turn.rotation * m.principal_inertia_local_frame;
            let spin = axes.inverse() * v.angular;
            let linear = f64::from(m.mass) * f64::from(v.linear.length_squared());
            0.5 * (linear + f64::from((m.principal_inertia * spin).dot(spin)))
        };
        self.bodies.iter().map(of).sum()
    }

    /// Energy stored in all springs, J.
    pub fn stored(&self) -> f64 {
        let of = |coil: &SceneSpring| {
            let stretch = self.length(coil) - f64::from(coil.rest_length);
            0.5 * f64::from(coil.stiffness) * stretch * stretch
        };
        self.coils.iter().map(of).sum()
    }

    /// Kinetic energy, energy of height above y = 0 and energy of the springs, J.
    pub fn energy(&self) -> f64 {
        let weight = |body: &Entity| {
            let m = self.lab.get::<ReadMassProperties>(*body).get();
            f64::from(m.mass) * self.gravity * f64::from(self.lab.position(*body).y)
        };
        self.motion() + self.stored() + self.bodies.iter().map(weight).sum::<f64>()
    }

    /// Runs for a time in s. Returns the greatest energy after a tick, J.
    pub fn most(&mut self, seconds: f64) -> f64 {
        let mut most = f64::NEG_INFINITY;
        for _ in 0..self.lab.ticks(seconds) {
            self.lab.tick();
            most = most.max(self.energy());
        }
        most
    }

    /// Runs for a time in s. Returns the greatest distance of a body from its first place, m.
    pub fn wander(&mut self, seconds: f64) -> f64 {
        let start: Vec<_> = self.bodies.iter().map(|b| self.lab.position(*b)).collect();
        let mut far = 0.0_f32;
        for _ in 0..self.lab.ticks(seconds) {
            self.lab.tick();
            for (body, start) in self.bodies.iter().zip(&start) {
                far = far.max(self.lab.position(*body).distance(*start));
            }
        }
        f64::from(far)
    }

    /// Greatest speed of a body, m/s.
    pub fn speed(&self) -> f64 {
        let of = |body: &Entity| f64::from(self.lab.velocity(*body).length());
        self.bodies.iter().map(of).fold(0.0, f64::max)
    }

    pub fn awake(&self) -> usize {
        let awake = |body: &&Entity| !self.lab.is_sleeping(**body);
        self.bodies.iter().filter(awake).count()
    }
}
