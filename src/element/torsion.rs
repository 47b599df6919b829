//! Torsion elements: a moment (N m) about an axis of body A, as a function of the twist of body B against body A about
//! that axis. The twist is an angle (rad), positive by the right-hand rule, and full turns are counted. The
//! [`SpringReadout`] has rad, rad/s and N m in place of m, m/s and N.

use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A torsion spring between two rigid bodies: moment = stiffness · (angle − rest angle).
///
/// The angle is the twist of body B against body A about an axis of body A, rad, positive by the right-hand rule. Full
/// turns are counted. A field or an end that is not valid gives the element a [`SpringFault`](crate::SpringFault), and
/// it does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct TorsionSpring {
    /// End A: the rigid body in whose frame the axis is. It may be a fixed body.
    #[entities]
    pub body_a: Entity,
    /// End B: the rigid body that turns against body A.
    #[entities]
    pub body_b: Entity,
    /// Axis in body A's frame. It may have any finite length but zero.
    pub axis: Vec3,
    /// Angle without moment, rad, full turns counted. `None` for the angle in the first step in which the element acts;
    /// that is then written back here.
    pub rest_angle: Option<f32>,
    /// Stiffness, N m/rad, from 0 to 1e12.
    pub stiffness: f32,
}

impl TorsionSpring {
    /// Returns a torsion spring of 1 N m/rad about an axis of body A. Its rest angle is the angle in the first step in
    /// which it acts.
    pub const fn new(body_a: Entity, body_b: Entity, axis: Vec3) -> Self {
        Self {
            body_a,
            body_b,
            axis,
            rest_angle: None,
            stiffness: 1.0,
        }
    }

    /// Sets the stiffness, N m/rad.
    pub const fn with_stiffness(mut self, stiffness: f32) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Sets the angle without moment, rad. An angle of more than a full turn winds the spring up.
    pub const fn with_rest_angle(mut self, rest_angle: f32) -> Self {
        self.rest_angle = Some(rest_angle);
        self
    }
}

/// A torsion damper between two rigid bodies: moment = damping · rate of the angle.
///
/// The angle is the twist of body B against body A about an axis of body A, rad, positive by the right-hand rule. A
/// field or an end that is not valid gives the element a [`SpringFault`](crate::SpringFault), and it does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct TorsionDamper {
    /// End A: the rigid body in whose frame the axis is. It may be a fixed body.
    #[entities]
    pub body_a: Entity,
    /// End B: the rigid body that turns against body A.
    #[entities]
    pub body_b: Entity,
    /// Axis in body A's frame. It may have any finite length but zero.
    pub axis: Vec3,
    /// Damping, N m s/rad, from 0 to 1e12.
    pub damping: f32,
}

impl TorsionDamper {
    /// Returns a torsion damper of 1 N m s/rad about an axis of body A.
    pub const fn new(body_a: Entity, body_b: Entity, axis: Vec3) -> Self {
        Self {
            body_a,
            body_b,
            axis,
            damping: 1.0,
        }
    }

    /// Sets the damping, N m s/rad.
    pub const fn with_damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }
}

/// A torsion spring and a torsion damper side by side: moment = stiffness · (angle − rest angle) + damping · rate of
/// the angle.
///
/// The angle is the twist of body B against body A about an axis of body A, rad, positive by the right-hand rule. Full
/// turns are counted. A field or an end that is not valid gives the element a [`SpringFault`](crate::SpringFault), and
/// it does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct TorsionSpringDamper {
    /// End A: the rigid body in whose frame the axis is. It may be a fixed body.
    #[entities]
    pub body_a: Entity,
    /// End B: the rigid body that turns against body A.
    #[entities]
    pub body_b: Entity,
    /// Axis in body A's frame. It may have any finite length but zero.
    pub axis: Vec3,
    /// Angle without moment, rad, full turns counted. `None` for the angle in the first step in which the element acts;
    /// that is then written back here.
    pub rest_angle: Option<f32>,
    /// Stiffness, N m/rad, from 0 to 1e12.
    pub stiffness: f32,
    /// Damping, N m s/rad, from 0 to 1e12.
    pub damping: f32,
}

impl TorsionSpringDamper {
    /// Returns a pair of 1 N m/rad and 1 N m s/rad about an axis of body A. Its rest angle is the angle in the first
    /// step in which it acts.
    pub const fn new(body_a: Entity, body_b: Entity, axis: Vec3) -> Self {
        Self {
            body_a,
            body_b,
            axis,
            rest_angle: None,
            stiffness: 1.0,
            damping: 1.0,
        }
    }

    /// Sets the stiffness, N m/rad.
    pub const fn with_stiffness(mut self, stiffness: f32) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Sets the angle without moment, rad. An angle of more than a full turn winds the spring up.
    pub const fn with_rest_angle(mut self, rest_angle: f32) -> Self {
        self.rest_angle = Some(rest_angle);
        self
    }

    /// Sets the damping, N m s/rad.
    pub const fn with_damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }
}
