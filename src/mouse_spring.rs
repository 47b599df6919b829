//! Pulls a body by one of its points: with a mouse, a hand or a tractor beam. Runs before `CoiloverSystems::Prepare`.

use crate::backend::Wrench;
use crate::backend::rapier::body::read;
use crate::compat;
use crate::dynamics::single;
use crate::element::{Anchors, MaxForce, SpringAxis, SpringDamper, SpringFault, SpringTuning};
use crate::input::check::MOST;
use crate::input::say::{Stays, say};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{
    RapierContextEntityLink, RapierRigidBodyHandle, RapierRigidBodySet, RigidBody,
};
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// Pulls a point of a body to a target point of the world by critically damped springs, so that the body follows a
/// pointer without swinging.
///
/// Spawn it on an entity of its own without a parent. Write [`target`](Self::target) as the pointer moves. To let go,
/// despawn the entity or remove this component.
///
/// At the next step three children are spawned: one [`SpringDamper`] along each axis of the world, without those along
/// which [`LockedAxes`](bevy_rapier3d::prelude::LockedAxes) let nothing move. They are tuned to the mass that the body
/// has at that point when nothing else holds it. So heavy and light bodies follow equally fast, and a body that stands
/// on the ground is lifted. Under gravity the point hangs g/ω² below the target, with ω = 2π · frequency: 6 cm at 2 Hz.
/// The point follows a steadily moving target without lag. If the target jumps, the point overshoots by an eighth of
/// the jump (e⁻²). A body that is gone or cannot be moved is not pulled.
///
/// A copy of the entity, as from a scene that was saved meanwhile, spawns springs of its own. Springs that were copied with
/// it are despawned.
///
/// If the target, point, frequency or greatest force is not a valid number, or the frequency needs a spring of more than
/// 1e12 N/m, this entity gets a [`SpringFault`], and nothing is pulled until that is corrected.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn grab(commands: &mut Commands, body: Entity, at: &GlobalTransform, pointer: Vec3) -> Entity {
/// let point = at.affine().inverse().transform_point3(pointer);
/// commands.spawn(MouseSpring::new(body, point, pointer).with_max_force(500.0)).id()
/// # }
/// # fn follow(mut held: Single<&mut MouseSpring>, pointer: Vec3) {
/// held.target = pointer;
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
#[require(Transform)]
pub struct MouseSpring {
    /// Dynamic body that is pulled.
    #[entities]
    pub body: Entity,
    /// Point of the body that is held, in the body's frame, m. The scale of the body applies to it.
    pub point: Vec3,
    /// Point of the world to which `point` is pulled, m.
    pub target: Vec3,
    /// Natural frequency of the springs, Hz, above zero. The point reaches the target after about 1/frequency seconds.
    pub frequency: f32,
    /// Greatest force along each axis of the world, N, above zero. `None` for no limit.
    pub max_force: Option<f32>,
}

impl MouseSpring {
    /// Pulls `point` of `body` (body's frame, m) to `target` (world, m), with 2 Hz and no force limit.
    pub const fn new(body: Entity, point: Vec3, target: Vec3) -> Self {
        Self {
            body,
            point,
            target,
            frequency: 2.0,
            max_force: None,
        }
    }

    /// Sets the natural frequency, Hz.
    pub const fn with_frequency(mut self, frequency: f32) -> Self {
        self.frequency = frequency;
        self
    }

    /// Sets the greatest force along each axis of the world, N.
    pub const fn with_max_force(mut self, newtons: f32) -> Self {
        self.max_force = Some(newtons);
        self
    }

    /// Returns the field and the reason if this component cannot pull.
    fn fault(&self) -> Option<(&'static str, &'static str)> {
        let is_positive = |x: f32| x > 0.0 && x.is_finite();
        let is_place = |at: Vec3| at.abs().cmple(Vec3::splat(MOST)).all();
        if !is_place(self.target) {
            Some(("MouseSpring::target", "is NaN or larger than 1e12"))
        } else if !is_place(self.point) {
            Some(("MouseSpring::point", "is NaN or larger than 1e12"))
        } else if !is_positive(self.frequency) {
            Some(("MouseSpring::frequency", "is not above zero, or not finite"))
        } else if !self.max_force.is_none_or(is_positive) {
            Some(("MouseSpring::max_force", "is not above zero, or not finite"))
        } else {
            None
        }
    }

    /// Returns the field and the reason if no spring can pull a mass (kg) with this frequency.
    fn is_too_stiff(&self, mass: f32) -> Option<(&'static str, &'static str)> {
        let (stiffness, damping) = self.coefficients(mass);
        let can_be = stiffness <= MOST && damping <= MOST;
        (!can_be).then_some((
            "MouseSpring::frequency",
            "is too high for the mass of the body: the springs would be stiffer than 1e12 N/m",
        ))
    }

    /// Stiffness (N/m) and damping (N s/m) of the spring for a mass, kg.
    fn coefficients(&self, mass: f32) -> (f32, f32) {
        SpringTuning::frequency(self.frequency, 1.0).coefficients(mass, 0.0)
    }

    /// Whether both can use the same springs: they differ at most in the target.
    fn pulls_like(&self, other: &Self) -> bool {
        Self {
            target: other.target,
            ..*self
        } == *other
    }
}

/// Axes of the world, along each of which a spring pulls.
const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

/// The springs of a [`MouseSpring`], and the component for which they were made.
#[derive(Component, Clone, Copy, Debug)]
// The springs are those of the original. A copy of the entity gets its own.
#[component(clone_behavior = Ignore)]
pub(crate) struct Grip {
    /// None along an axis along which the point cannot move.
    springs: [Option<Entity>; 3],
    of: MouseSpring,
}

/// Spawns the springs of each [`MouseSpring`], moves their end A to the target, and despawns them when it lets go.
pub(crate) fn hold(
    mut held: Query<(
        Entity,
        &MouseSpring,
        &mut Transform,
        Option<&Grip>,
        Has<SpringFault>,
    )>,
    released: Query<(Entity, &Grip), Or<(Without<MouseSpring>, With<Disabled>)>>,
    bodies: Query<
        (
            &RapierRigidBodyHandle,
            &RapierContextEntityLink,
            Option<&GlobalTransform>,
        ),
        With<RigidBody>,
    >,
    sets: Query<&RapierRigidBodySet>,
    children: Query<&Children>,
    springs: Query<(&SpringDamper, &SpringAxis)>,
    mut commands: Commands,
) {
    let body_of = |entity| {
        let (handle, context, frame) = bodies.get(entity).ok()?;
        let body = sets.get(context.0).ok()?.bodies.get(handle.0)?;
        // Rapier's body has no scale: its points are in metres of the world.
        let scale = frame.map_or(Vec3::ONE, GlobalTransform::scale);
        // A new body has no mass before its first step.
        (body.is_dynamic() && body.mass() > 0.0).then_some((body, scale))
    };
    for (entity, grip) in &released {
        release(entity, grip, &mut commands);
    }
    for (entity, spring, mut at, grip, told) in &mut held {
        let wrong = spring.fault();
        let body = body_of(spring.body).filter(|_| wrong.is_none());
        let masses =
            body.map(|(body, scale)| AXES.map(|axis| mass_at(body, scale * spring.point, axis)));
        let holds = |grip: &Grip| {
            let pulls = |spring: Option<Entity>| spring.is_some_and(|one| springs.contains(one));
            grip.of.pulls_like(spring)
                && masses.is_some_and(|masses| {
                    masses.map(|mass| mass.is_some()) == grip.springs.map(pulls)
                })
        };
        let grip = match grip {
            Some(grip) if !holds(grip) => {
                release(entity, grip, &mut commands);
                None
            }
            grip => grip,
        };
        if grip.is_some() {
            tell(entity, None, told, &mut commands);
            at.translation = spring.target;
            continue;
        }
        // Without a grip it has no springs of its own. Those of a copied entity would pull beside them.
        let below = children.get(entity).into_iter().flatten();
        for spring in below.filter(|child| is_grip(**child, entity, &springs)) {
            commands.entity(*spring).try_despawn();
        }
        let heaviest = masses.into_iter().flatten().flatten().reduce(f32::max);
        let wrong = wrong.or_else(|| spring.is_too_stiff(heaviest?));
        tell(entity, wrong, told, &mut commands);
        if let Some(masses) = masses.filter(|_| wrong.is_none()) {
            at.translation = spring.target;
            let springs = [0, 1, 2].map(|i| {
                let mass = masses[i]?;
                Some(along(AXES[i], entity, spring, mass))
            });
            // Silenced, because the game may have let go (despawned the entity) in the same tick.
            let (mut grip, of) = (commands.entity(entity), *spring);
            grip.queue_silenced(move |mut grip: EntityWorldMut| take_hold(&mut grip, of, springs));
        }
    }
}

/// Spawns the springs of a [`MouseSpring`].
fn take_hold(held: &mut EntityWorldMut, of: MouseSpring, springs: [Option<impl Bundle>; 3]) {
    let springs = held.world_scope(|world| {
        springs.map(|spring| {
            let mut spring = world.spawn(spring?);
            if let Some(newtons) = of.max_force {
                spring.insert(MaxForce(newtons));
            }
            Some(spring.id())
        })
    });
    held.insert(Grip { springs, of });
}

/// Removes the fault of a [`MouseSpring`] when the component is removed.
pub(crate) fn forget(gone: compat::Removed<MouseSpring>, mut commands: Commands) {
    commands.entity(gone.entity).try_remove::<SpringFault>();
}

/// Whether a child of a [`MouseSpring`] is a spring that [`along`] makes for it.
fn is_grip(child: Entity, entity: Entity, springs: &Query<(&SpringDamper, &SpringAxis)>) -> bool {
    springs.get(child).is_ok_and(|(spring, axis)| {
        spring.body_a == entity
            && spring.rest_length == Some(0.0)
            && matches!(axis, SpringAxis::World(_))
    })
}

/// Returns the spring along an axis of the world, for an effective mass at the held point, kg.
fn along(axis: Vec3, entity: Entity, spring: &MouseSpring, mass: f32) -> impl Bundle + use<> {
    let (stiffness, damping) = spring.coefficients(mass);
    (
        SpringDamper::new(entity, spring.body)
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_rest_length(0.0),
        SpringAxis::World(axis),
        Anchors::new(Vec3::ZERO, spring.point),
        ChildOf(entity),
    )
}

/// Effective mass of a body at one of its points (body's frame, scale applied, m) along an axis of the world, kg: the
/// inverse of 1/m + (r × n) · I⁻¹ (r × n), without the components of n and r × n that the body's locked axes take. What else holds
/// the body does not count. None if it cannot move the point that way.
fn mass_at(body: &RapierBody, point: Vec3, axis: Vec3) -> Option<f32> {
    let com = body.mass_properties().local_mprops.local_com;
    let body = read(body, Vec3::ZERO, &Wrench::default(), true);
    let axis = axis.as_dvec3();
    let torque = (body.rotation * (point - com).as_dvec3()).cross(axis);
    let turned = torque.dot(body.turned_by(torque));
    let inverse = axis.dot(body.inverse_mass * axis) + turned;
    (inverse > 0.0).then(|| single(inverse.recip()))
}

fn release(entity: Entity, grip: &Grip, commands: &mut Commands) {
    for spring in grip.springs.into_iter().flatten() {
        commands.entity(spring).try_despawn();
    }
    commands.entity(entity).try_remove::<Grip>();
}

/// Reports a fault once, and removes it once it is corrected.
fn tell(
    entity: Entity,
    fault: Option<(&'static str, &'static str)>,
    told: bool,
    commands: &mut Commands,
) {
    let mut held = commands.entity(entity);
    match fault {
        Some((field, reason)) => {
            let fault = SpringFault {
                entity,
                field: field.into(),
                reason: reason.into(),
            };
            held.queue_silenced(move |mut held: EntityWorldMut| {
                say(&mut held, fault, Stays::UntilMended);
            });
        }
        None if told => {
            held.try_remove::<SpringFault>();
        }
        None => {}
    }
}
