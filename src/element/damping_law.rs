use super::ForceTable;
use bevy::prelude::*;

/// Force of the damper over the rate of its length, beside [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper); without this component it is linear. Beside a
/// [`CustomDampingLaw`](crate::CustomDampingLaw) the element is at fault and does not act.
///
/// All but `Linear` have coefficients of their own, and the element's damping plays no part. *Bump* is while
/// the length shrinks, *rebound* while it grows.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum DampingLaw {
    /// The element's damping times the rate.
    #[default]
    Linear,
    /// One coefficient each way.
    Sided {
        /// N s/m while the length shrinks.
        bump: f32,
        /// N s/m while the length grows.
        rebound: f32,
    },
    /// Force c₁ v + c₂ |v| v: flow through an orifice.
    Quadratic {
        /// c₁, N s/m.
        linear: f32,
        /// c₂, N s²/m².
        quadratic: f32,
    },
    /// Degressive: a valve that opens at a speed.
    BlowOff {
        /// N s/m up to the knee.
        damping: f32,
        /// Speed at which the valve opens, m/s.
        knee: f32,
        /// N s/m of what the speed is beyond the knee.
        beyond: f32,
    },
    /// Force over rate, no force at rest.
    Table(ForceTable),
}

impl DampingLaw {
    /// Coefficients (N s/m) while the length shrinks and while it grows.
    pub const fn sided(bump: f32, rebound: f32) -> Self {
        Self::Sided { bump, rebound }
    }

    /// Points (rate in m/s, force in N).
    pub fn table(points: impl IntoIterator<Item = (f32, f32)>) -> Self {
        Self::Table(ForceTable::new(points))
    }
}
