use bevy::prelude::*;

/// Computes the [`Preload`](crate::Preload) with which the load rests where it was spawned, instead of sagging first.
///
/// Put it beside an element. In the first step in which the element acts, the preload is computed from the weight of
/// the load, the direction of the element, and the force that its spring already has there. The result is inserted as a
/// [`Preload`](crate::Preload), in place of an existing one, and this component is removed.
///
/// The *load* is the end that moves. If both ends move, say which one is the load: [`of_a`](Self::of_a) or
/// [`of_b`](Self::of_b). The other end counts as fixed. Only the weight counts, not your own forces.
///
/// - A load without joints: the element carries its share of the weight. Springs that carry a load together have shares
///   that add up to 1. On a slanted element, the tension is its share of the weight divided by the cosine of the angle
///   to the direction of gravity.
/// - A load on a joint whose other body cannot move, such as the arm of a lamp on a hinge: the element carries its
///   share of what the joint does not carry. Joints between two bodies that move are ignored. For a torsion element,
///   the joint to the element's other end counts as well.
///
/// If no preload can hold the load, the element gets a [`SpringFault`](crate::SpringFault) that says why: the element
/// is level, the ends cannot move, or [`SpringAction`](crate::SpringAction) or [`MaxForce`](crate::MaxForce) do not
/// allow the tension.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn tray(commands: &mut Commands, hooks: [Entity; 4], corners: [Vec3; 4], tray: Entity) {
/// for (hook, corner) in hooks.into_iter().zip(corners) {
///     commands.spawn((
///         SpringDamper::new(hook, tray).with_stiffness(200.0),
///         Anchors::new(Vec3::ZERO, corner),
///         HoldPose::share(0.25),
///     ));
/// }
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct HoldPose {
    /// Which end is the load.
    pub load: HeldEnd,
    /// Share of the load that this element carries: above zero, 1 for all of it.
    pub share: f32,
    /// Mass of the load, kg, above zero, if it is not the mass of the body alone: for example with passengers. `None`
    /// for the mass of the body.
    pub mass: Option<f32>,
}

/// Which end of an element is its load; see [`HoldPose`].
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone, Hash)]
pub enum HeldEnd {
    /// The end that moves. If both ends move, the element gets a [`SpringFault`](crate::SpringFault).
    #[default]
    Moving,
    /// End A.
    A,
    /// End B.
    B,
}

impl Default for HoldPose {
    fn default() -> Self {
        Self::new()
    }
}

impl HoldPose {
    /// Carries the whole load; the load is the end that moves.
    pub const fn new() -> Self {
        Self {
            load: HeldEnd::Moving,
            share: 1.0,
            mass: None,
        }
    }

    /// Carries a share of the load; the load is the end that moves.
    pub const fn share(share: f32) -> Self {
        Self::new().with_share(share)
    }

    /// Carries end A: for example a chassis, where end B is its wheel.
    pub const fn of_a() -> Self {
        Self {
            load: HeldEnd::A,
            ..Self::new()
        }
    }

    /// Carries end B: for example a lamp, where end A is the body from which it hangs.
    pub const fn of_b() -> Self {
        Self {
            load: HeldEnd::B,
            ..Self::new()
        }
    }

    /// Sets the share of the load that this element carries.
    pub const fn with_share(mut self, share: f32) -> Self {
        self.share = share;
        self
    }

    /// Sets the mass of the load, kg, instead of the body's own.
    pub const fn with_mass(mut self, mass: f32) -> Self {
        self.mass = Some(mass);
        self
    }
}
