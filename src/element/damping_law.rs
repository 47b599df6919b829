use super::ForceTable;
use bevy::prelude::*;

/// Force of the damper as a function of the rate of its length, beside [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper). Without this component the damper is linear. On a torsion element, angles
/// (rad) and moments (N m) take the place of lengths and forces.
///
/// All variants but `Linear` have coefficients of their own, and the element's damping is ignored. Coefficients must be
/// from 0 to 1e12. *Bump* means that the length shrinks, *rebound* that it grows. With an invalid value, with a
/// [`CustomDampingLaw`](crate::CustomDampingLaw) on the same entity, or on a spring without a damper, the element gets
/// a [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum DampingLaw {
    /// Force = the element's damping · rate.
    #[default]
    Linear,
    /// One coefficient for each direction.
    Sided {
        /// Damping while the length shrinks, N s/m.
        bump: f32,
        /// Damping while the length grows, N s/m.
        rebound: f32,
    },
    /// Force = c₁ v + c₂ |v| v for a rate v, as of flow through an orifice.
    Quadratic {
        /// Linear coefficient c₁, N s/m.
        linear: f32,
        /// Quadratic coefficient c₂, N s²/m².
        quadratic: f32,
    },
    /// Degressive damper: a valve opens at a certain speed, and beyond it the force has another slope.
    BlowOff {
        /// Damping up to the knee, N s/m.
        damping: f32,
        /// Speed at which the valve opens, m/s.
        knee: f32,
        /// Slope of the force beyond the knee, N s/m.
        beyond: f32,
    },
    /// Force over rate, from a table. The force at rest must be zero.
    Table(ForceTable),
}

impl DampingLaw {
    /// Coefficients (N s/m) while the length shrinks, and while it grows: [`DampingLaw::Sided`].
    pub const fn sided(bump: f32, rebound: f32) -> Self {
        Self::Sided { bump, rebound }
    }

    /// Points (rate in m/s, force in N) of a [`DampingLaw::Table`].
    pub fn table(points: impl IntoIterator<Item = (f32, f32)>) -> Self {
        Self::Table(ForceTable::new(points))
    }
}
