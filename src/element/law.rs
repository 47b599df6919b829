use super::ForceTable;
use crate::dynamics::law::Function;
use bevy::prelude::*;
use std::fmt;
use std::sync::Arc;

/// Force of the spring as a function of its stretch (length minus rest length), beside [`Spring`](crate::Spring) or
/// [`SpringDamper`](crate::SpringDamper). Without this component the spring is linear. With an invalid value, with a
/// [`CustomSpringLaw`] on the same entity, or on a damper without a spring, the element gets a
/// [`SpringFault`](crate::SpringFault) and does not act.
///
/// On a torsion element, angles (rad) and moments (N m) take the place of lengths and forces. This holds for all
/// companions of an element.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub enum SpringLaw {
    /// Force = the element's stiffness · stretch.
    #[default]
    Linear,
    /// Force = the element's stiffness, here in N/m³, · stretch³.
    Cubic,
    /// One polynomial for stretch and one for compression. The element's stiffness is ignored.
    Polynomial {
        /// Force when the length is above the rest length.
        pull: Polynomial,
        /// Force when the length is below the rest length.
        push: Polynomial,
    },
    /// Force over stretch, from a table. The element's stiffness is ignored.
    Table(ForceTable),
}

/// Force k₁ x + k₂ |x| x + k₃ x³ for a stretch x (m). Each coefficient must be from 0 to 1e12.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone)]
pub struct Polynomial {
    /// Linear coefficient k₁, N/m.
    pub linear: f32,
    /// Quadratic coefficient k₂, N/m².
    pub quadratic: f32,
    /// Cubic coefficient k₃, N/m³.
    pub cubic: f32,
}

impl Polynomial {
    /// Coefficients k₁ (N/m), k₂ (N/m²) and k₃ (N/m³).
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

    /// Points (stretch in m, force in N) of a [`SpringLaw::Table`].
    pub fn table(points: impl IntoIterator<Item = (f32, f32)>) -> Self {
        Self::Table(ForceTable::new(points))
    }
}

/// A force law of your own, for [`CustomSpringLaw`] and [`CustomDampingLaw`].
///
/// It must always return the same force for the same argument. The force must be finite, and must not fall as `x`
/// rises: then the element is as stable as any other. (Where the force falls, the element stays bounded but is less
/// exact.) If the law returns NaN or infinity, the element gets a [`SpringFault`](crate::SpringFault) and does not act.
pub trait ForceLaw: Send + Sync + 'static {
    /// Force, N, tension positive. `x` is the stretch, m; for a damper it is the rate of the length, m/s. On a torsion
    /// element, this is the moment, N m, and `x` is in rad or rad/s.
    fn force(&self, x: f64) -> f64;

    /// Slope of the force at `x`, N/m or N s/m. By default a central difference of two forces.
    fn slope(&self, x: f64) -> f64 {
        let h = 1e-6 * x.abs().max(1e-3);
        (self.force(x + h) - self.force(x - h)) / (2.0 * h)
    }

    /// Integral of the force from 0 to `x`: for a spring the stored energy, J. By default three-point Gauss–Legendre
    /// quadrature in eight equal parts. It is exact for polynomials up to degree 5 and accurate for other smooth laws.
    /// A law with kinks should implement this method exactly.
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

/// A [`ForceLaw`] of your own as the force of the spring over its stretch, instead of a [`SpringLaw`]. The element's
/// stiffness is ignored. With a [`SpringLaw`] on the same entity, the element gets a
/// [`SpringFault`](crate::SpringFault) and does not act.
///
/// ```
/// # use bevy_coilover::CustomSpringLaw;
/// let hardening = CustomSpringLaw::new(|stretch: f64| 50.0 * stretch.sinh());
/// ```
#[derive(Component, Clone)]
pub struct CustomSpringLaw(pub(crate) Arc<dyn ForceLaw>);

/// A [`ForceLaw`] of your own as the force of the damper over the rate of the length, instead of a
/// [`DampingLaw`](crate::DampingLaw). The element's damping is ignored. The force must have the sign of the rate; a
/// force of the other sign counts as zero. With a force at rest, or with a [`DampingLaw`](crate::DampingLaw) on the same
/// entity, the element gets a [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Component, Clone)]
pub struct CustomDampingLaw(pub(crate) Arc<dyn ForceLaw>);

impl CustomSpringLaw {
    /// From a function, or any other type that implements [`ForceLaw`].
    pub fn new(law: impl ForceLaw) -> Self {
        Self(Arc::new(law))
    }
}

impl CustomDampingLaw {
    /// From a function, or any other type that implements [`ForceLaw`].
    pub fn new(law: impl ForceLaw) -> Self {
        Self(Arc::new(law))
    }
}

/// A user's law in the form that the integrators use.
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
