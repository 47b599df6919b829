//! The rotational twins: moment (N m) about an axis of body A, over the angle (rad) by which body B is twisted
//! about it against body A, positive by the right hand. Turns are counted past a full one. Their
//! [`SpringReadout`] has angles, rad/s and N m in the place of lengths, m/s and N.

use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A torsion spring: moment = stiffness · (angle − rest angle).
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct TorsionSpring {
    /// The rigid body whose axis it is; a fixed one will do.
    #[entities]
    pub body_a: Entity,
    /// The rigid body that turns against it.
    #[entities]
    pub body_b: Entity,
    /// In body A's frame; any length but zero.
    pub axis: Vec3,
    /// Angle without moment, rad, full turns counted; `None` is the angle at the first step it acts, written
    /// back here then.
    pub rest_angle: Option<f32>,
    /// N m/rad, finite and not negative.
    pub stiffness: f32,
}

impl TorsionSpring {
    /// About an axis of body A, with coefficients of 1 and the angle of the first step as rest angle.
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

    /// Sets the angle without moment, rad; more than a turn winds it up.
    pub const fn with_rest_angle(mut self, rest_angle: f32) -> Self {
        self.rest_angle = Some(rest_angle);
        self
    }
}

/// A torsion damper: moment = damping · rate of the angle.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct TorsionDamper {
    /// The rigid body whose axis it is; a fixed one will do.
    #[entities]
    pub body_a: Entity,
    /// The rigid body that turns against it.
    #[entities]
    pub body_b: Entity,
    /// In body A's frame; any length but zero.
    pub axis: Vec3,
    /// N m s/rad, finite and not negative.
    pub damping: f32,
}

impl TorsionDamper {
    /// About an axis of body A, with coefficients of 1.
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

/// A torsion spring and damper side by side.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct TorsionSpringDamper {
    /// The rigid body whose axis it is; a fixed one will do.
    #[entities]
    pub body_a: Entity,
    /// The rigid body that turns against it.
    #[entities]
    pub body_b: Entity,
    /// In body A's frame; any length but zero.
    pub axis: Vec3,
    /// Angle without moment, rad, full turns counted; `None` is the angle at the first step it acts, written
    /// back here then.
    pub rest_angle: Option<f32>,
    /// N m/rad, finite and not negative.
    pub stiffness: f32,
    /// N m s/rad, finite and not negative.
    pub damping: f32,
}

impl TorsionSpringDamper {
    /// About an axis of body A, with coefficients of 1 and the angle of the first step as rest angle.
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

    /// Sets the angle without moment, rad; more than a turn winds it up.
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
