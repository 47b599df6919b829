use bevy::prelude::*;

/// Finds the [`Preload`](crate::Preload) with which the load rests where it was spawned, instead of sagging first.
///
/// Put it beside an element. At the first step that the element acts, the preload is worked out from the weight of the
/// load, the direction of the element and what its spring gives there already. It is inserted as a
/// [`Preload`](crate::Preload), in place of one that was there, and this component is removed.
///
/// The *load* is the end that moves. Where both do, say which: [`of_a`](Self::of_a) or [`of_b`](Self::of_b). The other
/// end counts as if it stood still. Only weight is counted, not your own forces.
///
/// - A load without joints: the element carries the share of its weight, so springs that carry it together have shares
///   that sum up to 1. Along a slanted element the tension is the weight's share divided by the cosine.
/// - A load on a joint whose other body cannot move, such as the arm of a lamp on a hinge: the element carries what the
///   joint leaves, times the share. Joints between bodies that move are not looked at. For a torsion element, the joint
///   to its other end counts as well.
///
/// Where no preload can do it, the element has a [`SpringFault`](crate::SpringFault) that says why: the element is level,
/// the ends cannot move, or [`SpringAction`](crate::SpringAction) or [`MaxForce`](crate::MaxForce) forbid it.
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
    /// Mass of the load, kg, where it is not that of the body alone: with passengers on it, say. `None` is the body's.
    pub mass: Option<f32>,
}

/// The end of an element that is its load; see [`HoldPose`].
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone, Hash)]
pub enum HeldEnd {
    /// The one that moves; a fault where both do.
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
    /// Carries all of the end that moves.
    pub const fn new() -> Self {
        Self {
            load: HeldEnd::Moving,
            share: 1.0,
            mass: None,
        }
    }

    /// Carries a share of the end that moves.
    pub const fn share(share: f32) -> Self {
        Self::new().with_share(share)
    }

    /// Carries end A: a chassis, where end B is its wheel.
    pub const fn of_a() -> Self {
        Self {
            load: HeldEnd::A,
            ..Self::new()
        }
    }

    /// Carries end B: a lamp, where end A is the body that it hangs on.
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
