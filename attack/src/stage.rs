//! Builds a planned scene with Bevy and Rapier, and applies its changes.

use crate::lab::{self, set_rate};
use crate::plan::{BodyPlan, Companion, Deed, ElementPlan, Kind, Plan, Shape};
use crate::springs::Springs;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A running scene.
pub struct Stage {
    /// App of the scene.
    pub app: App,
    /// Bodies and points in the order of the plan, including despawned ones.
    pub bodies: Vec<Entity>,
    /// Elements in the order in which they were spawned, including despawned ones.
    pub elements: Vec<Entity>,
    /// Joints that the game itself spawned.
    pub joints: Vec<Entity>,
    springs: Springs,
}

impl Stage {
    /// Builds a scene.
    pub fn new(plan: &Plan, springs: Springs) -> Self {
        let mut stage = Self {
            app: lab::app(springs == Springs::Ours),
            bodies: Vec::new(),
            elements: Vec::new(),
            joints: Vec::new(),
            springs,
        };
        if plan.ground {
            let ground = (RigidBody::Fixed, Collider::cuboid(50.0, 1.0, 50.0));
            let at = Transform::from_xyz(0.0, -4.0, 0.0);
            stage.app.world_mut().spawn((ground, at));
        }
        for body in &plan.bodies {
            stage.body(body);
        }
        for element in &plan.elements {
            stage.element(element);
        }
        stage
    }

    fn of(list: &[Entity], index: u8) -> Option<Entity> {
        (!list.is_empty()).then(|| list[usize::from(index) % list.len()])
    }

    fn body(&mut self, plan: &BodyPlan) {
        let below = plan.below.and_then(|b| Self::of(&self.bodies, b));
        let place = Transform::from_translation(plan.place.into());
        let world = self.app.world_mut();
        let entity = world.spawn(place).id();
        self.bodies.push(entity);
        let mut body = world.entity_mut(entity);
        if let Some(below) = below {
            body.insert(ChildOf(below));
        }
        become_kind(&mut body, plan.kind);
        reshape(&mut body, plan.shape);
        body.insert((
            ColliderMassProperties::Density(0.0),
            mass(plan.mass),
            Velocity {
                linear: plan.speed.into(),
                angular: plan.spin.into(),
            },
            LockedAxes::from_bits_truncate(plan.locks),
            GravityScale(plan.gravity),
        ));
        if plan.iterations > 0 {
            body.insert(AdditionalSolverIterations(plan.iterations.into()));
        }
    }

    fn element(&mut self, plan: &ElementPlan) {
        let ends = plan.ends.map(|end| Self::of(&self.bodies, end));
        let [Some(a), Some(b)] = ends else { return };
        let entity = self.app.world_mut().spawn_empty().id();
        self.elements.push(entity);
        match self.springs {
            Springs::None => return,
            Springs::Engines => {
                self.motor(plan, [a, b]);
                return;
            }
            Springs::Ours => {}
        }
        let mut element = self.app.world_mut().entity_mut(entity);
        let axis = plan.axis.into();
        let rest = plan.rest;
        match plan.kind {
            0 => {
                let new = Spring::new(a, b).with_stiffness(plan.stiffness);
                element.insert(Spring {
                    rest_length: rest,
                    ..new
                });
            }
            1 => {
                element.insert(Damper::new(a, b).with_damping(plan.damping));
            }
            2 => {
                let new = SpringDamper::new(a, b).with_stiffness(plan.stiffness);
                let rest_length = rest;
                element.insert(SpringDamper {
                    rest_length,
                    ..new.with_damping(plan.damping)
                });
            }
            3 => {
                let new = TorsionSpring::new(a, b, axis).with_stiffness(plan.stiffness);
                element.insert(TorsionSpring {
                    rest_angle: rest,
                    ..new
                });
            }
            4 => {
                element.insert(TorsionDamper::new(a, b, axis).with_damping(plan.damping));
            }
            _ => {
                let new = TorsionSpringDamper::new(a, b, axis).with_stiffness(plan.stiffness);
                let rest_angle = rest;
                element.insert(TorsionSpringDamper {
                    rest_angle,
                    ..new.with_damping(plan.damping)
                });
            }
        }
        if let Some([a, b]) = plan.anchors {
            element.insert(Anchors::new(a.into(), b.into()));
        }
        accompany(&mut element, &plan.companion);
    }

    /// Applies one change.
    pub fn act(&mut self, deed: &Deed) {
        let with_springs = self.springs == Springs::Ours;
        match deed {
            Deed::DespawnBody(b) => self.on_body(*b, |body| body.despawn()),
            Deed::DespawnElement(e) => self.on_element(*e, |element| element.despawn()),
            Deed::SpawnElement(plan) => self.element(plan),
            Deed::ToggleBody(b) => self.on_body(*b, |mut body| {
                if body.take::<RigidBodyDisabled>().is_none() {
                    body.insert(RigidBodyDisabled);
                }
            }),
            Deed::ToggleElement(e) => self.on_element(*e, |mut element| {
                use bevy::ecs::entity_disabling::Disabled;
                if element.take::<Disabled>().is_none() {
                    element.insert(Disabled);
                }
            }),
            Deed::Become(b, kind) => self.on_body(*b, |mut body| become_kind(&mut body, *kind)),
            Deed::Teleport(b, at) => self.on_body(*b, |mut body| {
                if let Some(mut place) = body.get_mut::<Transform>() {
                    place.translation = (*at).into();
                }
            }),
            Deed::Kick(b, by) => self.on_body(*b, |mut body| {
                if let Some(mut velocity) = body.get_mut::<Velocity>() {
                    velocity.linear += Vec3::from(*by);
                }
            }),
            Deed::Reshape(b, shape) => self.on_body(*b, |mut body| reshape(&mut body, *shape)),
            Deed::Push(b, by) => self.on_body(*b, |mut body| {
                let mut force = body.get::<ExternalForce>().copied().unwrap_or_default();
                force.force = (*by).into();
                body.insert(force);
            }),
            Deed::Below(b, below) => self.below(*b, *below),
            Deed::Scale(b, by) => self.on_body(*b, |mut body| {
                if let Some(mut place) = body.get_mut::<Transform>() {
                    place.scale = Vec3::splat(*by);
                }
            }),
            Deed::Weigh(b, kilograms) => self.on_body(*b, |mut body| {
                body.insert(mass(*kilograms));
            }),
            Deed::Stiffen(e, stiffness) if with_springs => self.on_element(*e, |mut element| {
                macro_rules! stiffen {
                    ($($kind:ty)*) => {$(
                        if let Some(mut spring) = element.get_mut::<$kind>() {
                            spring.stiffness = *stiffness;
                        }
                    )*};
                }
                stiffen!(Spring SpringDamper TorsionSpring TorsionSpringDamper);
            }),
            Deed::Retie(e, ends) if with_springs => {
                let [Some(a), Some(b)] = ends.map(|end| Self::of(&self.bodies, end)) else {
                    return;
                };
                self.on_element(*e, |mut element| {
                    macro_rules! retie {
                        ($($kind:ty)*) => {$(
                            if let Some(mut tied) = element.get_mut::<$kind>() {
                                (tied.body_a, tied.body_b) = (a, b);
                            }
                        )*};
                    }
                    retie!(Spring Damper SpringDamper);
                    retie!(TorsionSpring TorsionDamper TorsionSpringDamper);
                });
            }
            Deed::Accompany(e, companion) if with_springs => {
                self.on_element(*e, |mut element| accompany(&mut element, companion));
            }
            Deed::Stiffen(..) | Deed::Retie(..) | Deed::Accompany(..) => {}
            Deed::Join(kind, ends) => self.join(*kind, *ends),
            Deed::Gravity(gravity) => {
                let mut all = self.app.world_mut().query::<&mut RapierConfiguration>();
                for mut configuration in all.iter_mut(self.app.world_mut()) {
                    configuration.gravity = (*gravity).into();
                }
            }
            Deed::Rate(dt, steps) => set_rate(&mut self.app, *dt, usize::from(*steps)),
            Deed::Pause(paused) => {
                let mut all = self.app.world_mut().query::<&mut RapierConfiguration>();
                for mut configuration in all.iter_mut(self.app.world_mut()) {
                    configuration.physics_pipeline_active = !*paused;
                }
            }
            Deed::Settings(microsteps, extrapolates, tolerance) => {
                let world = self.app.world_mut();
                if let Some(mut settings) = world.get_resource_mut::<CoiloverSettings>() {
                    settings.microsteps = (*microsteps).into();
                    settings.extrapolation = *extrapolates;
                    settings.tolerance = *tolerance;
                }
            }
        }
    }

    fn on_body(&mut self, index: u8, act: impl FnOnce(EntityWorldMut)) {
        if let Some(entity) = Self::of(&self.bodies, index)
            && let Ok(body) = self.app.world_mut().get_entity_mut(entity)
        {
            act(body);
        }
    }

    fn on_element(&mut self, index: u8, act: impl FnOnce(EntityWorldMut)) {
        if let Some(entity) = Self::of(&self.elements, index)
            && let Ok(element) = self.app.world_mut().get_entity_mut(entity)
        {
            act(element);
        }
    }

    /// Makes a body the child of another one, unless that makes a cycle.
    fn below(&mut self, body: u8, below: Option<u8>) {
        let Some(body) = Self::of(&self.bodies, body) else {
            return;
        };
        let world = self.app.world_mut();
        let Ok(mut entity) = world.get_entity_mut(body) else {
            return;
        };
        let Some(above) = below.and_then(|b| Self::of(&self.bodies, b)) else {
            entity.remove::<ChildOf>();
            return;
        };
        let mut current = Some(above);
        while let Some(here) = current {
            if here == body || world.get_entity(here).is_err() {
                return;
            }
            current = world.get::<ChildOf>(here).map(ChildOf::parent);
        }
        world.entity_mut(body).insert(ChildOf(above));
    }

    fn join(&mut self, kind: u8, ends: [u8; 2]) {
        let [Some(a), Some(b)] = ends.map(|end| Self::of(&self.bodies, end)) else {
            return;
        };
        let world = self.app.world_mut();
        let is_body = |entity| world.get::<RigidBody>(entity).is_some();
        if a == b || !is_body(a) || !is_body(b) {
            return;
        }
        let joint: TypedJoint = match kind {
            0 => SphericalJointBuilder::new().into(),
            1 => RevoluteJointBuilder::new(Vec3::Z).into(),
            2 => PrismaticJointBuilder::new(Vec3::Y).into(),
            3 => FixedJointBuilder::new().into(),
            4 => RopeJointBuilder::new(1.0).into(),
            _ => SpringJointBuilder::new(1.0, 100.0, 1.0).into(),
        };
        let joint = world.spawn((ImpulseJoint::new(a, joint), ChildOf(b))).id();
        self.joints.push(joint);
    }
}

fn mass(kilograms: f32) -> AdditionalMassProperties {
    AdditionalMassProperties::MassProperties(MassProperties {
        mass: kilograms,
        principal_inertia: Vec3::new(0.3, 0.4, 0.5) * kilograms * 0.1,
        ..default()
    })
}

fn become_kind(body: &mut EntityWorldMut, kind: Kind) {
    match kind {
        Kind::Dynamic => body.insert(RigidBody::Dynamic),
        Kind::Fixed => body.insert(RigidBody::Fixed),
        Kind::KinematicPlace => body.insert(RigidBody::KinematicPositionBased),
        Kind::KinematicSpeed => body.insert(RigidBody::KinematicVelocityBased),
        Kind::Point => body.remove::<RigidBody>(),
    };
}

fn reshape(body: &mut EntityWorldMut, shape: Shape) {
    match shape {
        Shape::None => body.remove::<Collider>(),
        Shape::Ball(radius) => body.insert(Collider::ball(radius)),
        Shape::Cube(half) => body.insert(Collider::cuboid(half, half, half)),
    };
}

fn accompany(element: &mut EntityWorldMut, companion: &Companion) {
    match *companion {
        Companion::None => element,
        Companion::Pull => element.insert(SpringAction::Pull),
        Companion::Push => element.insert(SpringAction::Push),
        Companion::Preload(force) => element.insert(Preload(force)),
        Companion::MaxForce(force) => element.insert(MaxForce(force)),
        Companion::Travel(least, most, stiffness) => {
            element.insert(SpringTravel::new(least, most, stiffness))
        }
        Companion::Axis(axis) => element.insert(SpringAxis::BodyA(axis.into())),
        Companion::Breakable(force) => element.insert(Breakable::at_force(force)),
        Companion::Cubic(linear, cubic) => {
            element.insert(SpringLaw::polynomial(linear, 0.0, cubic))
        }
        Companion::Table(a, b) => {
            element.insert(SpringLaw::table([(a[0], a[1]), (0.0, 0.0), (b[0], b[1])]))
        }
        Companion::Sided(bump, rebound) => element.insert(DampingLaw::sided(bump, rebound)),
        Companion::Tuning(frequency, ratio) => {
            element.insert(SpringTuning::frequency(frequency, ratio))
        }
        Companion::HoldPose => element.insert(HoldPose::new()),
    };
}
