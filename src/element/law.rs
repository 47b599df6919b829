use super::ForceTable;
use crate::dynamics::law::Function;
use bevy::prelude::*;
use std::fmt;
use std::sync::Arc;

/// Force of the spring over its stretch (length less rest length), beside [`Spring`](crate::Spring) or
/// [`SpringDamper`](crate::SpringDamper); without this component it is linear. Beside a [`CustomSpringLaw`] the element
/// is at fault and does not act.
///
/// On a torsion element angles (rad) and moments (N m) take the place of lengths and forces, in every
/// companion.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum SpringLaw {
    /// The element's stiffness times the stretch.
    #[default]
    Linear,
    /// The element's stiffness, here in N/m³, times the stretch cubed.
    Cubic,
    /// Coefficients of its own; the element's stiffness plays no part.
    Polynomial {
        /// For stretch.
        pull: Polynomial,
        /// For compression.
        push: Polynomial,
    },
    /// Force over stretch; the element's stiffness plays no part.
    Table(ForceTable),
}

/// Force k₁ x + k₂ |x| x + k₃ x³ for a stretch x; none of them negative.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone)]
pub struct Polynomial {
    /// k₁, N/m.
    pub linear: f32,
    /// k₂, N/m².
    pub quadratic: f32,
    /// k₃, N/m³.
    pub cubic: f32,
}

impl Polynomial {
    /// k₁ (N/m), k₂ (N/m²) and k₃ (N/m³).
    pub const fn new(linear: f32, quadratic: f32, cubic: f32) -> Self {
        Self {
            linear,
            quadratic,
            cubic,
        }
    }
}

impl SpringLaw {
    /// The same polynomial for stretch and compression.
    pub const fn polynomial(linear: f32, quadratic: f32, cubic: f32) -> Self {
        let both = Polynomial::new(linear, quadratic, cubic);
        Self::Polynomial {
            pull: both,
            push: both,
        }
    }

    /// One polynomial for stretch and another for compression.
    pub const fn sided(pull: Polynomial, push: Polynomial) -> Self {
        Self::Polynomial { pull, push }
    }

    /// Points (stretch in m, force in N).
    pub fn table(points: impl IntoIterator<Item = (f32, f32)>) -> Self {
        Self::Table(ForceTable::new(points))
    }
}

/// A force law of your own.
///
/// It has to be the same function whenever it is asked, finite, and must not fall as x rises: then the element
/// is as stable as any other. (Where it falls, the element stays bounded but is less exact.) NaN makes
/// the element inert, with a message.
pub trait ForceLaw: Send + Sync + 'static {
    /// Force (N, tension positive) at a stretch (m), or for a damper at a rate (m/s).
    fn force(&self, x: f64) -> f64;

    /// Slope of the force. By default from two neighbouring forces.
    fn slope(&self, x: f64) -> f64 {
        let h = 1e-6 * x.abs().max(1e-3);
        (self.force(x + h) - self.force(x - h)) / (2.0 * h)
    }

    /// Integral of the force from 0: the stored energy, J. By default by Gauss–Legendre quadrature in eight
    /// parts, which is exact to rounding for smooth laws; a law with bends should give it exactly.
    fn energy(&self, x: f64) -> f64 {
        const NODES: [(f64, f64); 3] = [
            (-0.774_596_669_241_483_4, 5.0 / 9.0),
            (0.0, 8.0 / 9.0),
            (0.774_596_669_241_483_4, 5.0 / 9.0),
        ];
        let half = x / 16.0;
        let part = |i: i32| {
            let middle = half * f64::from(2 * i + 1);
            NODES
                .iter()
                .map(|(at, weight)| weight * self.force(middle + half * at))
                .sum::<f64>()
        };
        half * (0..8).map(part).sum::<f64>()
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync + 'static> ForceLaw for F {
    fn force(&self, x: f64) -> f64 {
        self(x)
    }
}

/// [`ForceLaw`] of your own as the spring's force, instead of a [`SpringLaw`]; the element's stiffness
/// plays no part. With both on one entity the element is at fault and does not act.
///
/// ```
/// # use bevy_coilover::CustomSpringLaw;
/// let hardening = CustomSpringLaw::new(|stretch: f64| 50.0 * stretch.sinh());
/// ```
#[derive(Component, Clone)]
pub struct CustomSpringLaw(pub(crate) Arc<dyn ForceLaw>);

/// [`ForceLaw`] of your own as the damper's force over the rate of the length, instead of a
/// [`DampingLaw`](crate::DampingLaw); with both on one entity the element is at fault and does not act. It must have the sign of the rate; where it has not it is taken as zero.
#[derive(Component, Clone)]
pub struct CustomDampingLaw(pub(crate) Arc<dyn ForceLaw>);

impl CustomSpringLaw {
    /// From a function or anything else that is a [`ForceLaw`].
    pub fn new(law: impl ForceLaw) -> Self {
        Self(Arc::new(law))
    }
}

impl CustomDampingLaw {
    /// From a function or anything else that is a [`ForceLaw`].
    pub fn new(law: impl ForceLaw) -> Self {
        Self(Arc::new(law))
    }
}

/// A user's law as the integrators see it.
#[derive(Clone)]
pub(crate) struct Theirs(pub Arc<dyn ForceLaw>);

impl fmt::Debug for Theirs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a user's law")
    }
}

impl Function for Theirs {
    fn force(&self, x: f64) -> f64 {
        self.0.force(x)
    }

    fn slope(&self, x: f64) -> f64 {
        self.0.slope(x)
    }

    fn integral(&self, x: f64) -> f64 {
        self.0.energy(x)
    }
}
