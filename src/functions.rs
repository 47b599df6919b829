//! Functions whose last bit depends on the platform. With the feature `enhanced-determinism` they come from the crate
//! `libm` and are the same everywhere.
//!
//! Every processor rounds sums, products, quotients and square roots alike (IEEE 754), but not these functions. Vectors
//! and quaternions use the functions of Bevy, which the same feature makes equal everywhere too.

#[cfg(feature = "enhanced-determinism")]
pub(crate) use libm::{asin, atan, atan2, cbrt, cos, exp, expm1 as exp_m1, sin, tanh};
#[cfg(not(feature = "enhanced-determinism"))]
pub(crate) use platform::{asin, atan, atan2, cbrt, cos, exp, exp_m1, sin, tanh};

#[cfg(not(feature = "enhanced-determinism"))]
mod platform {
    pub(crate) fn asin(x: f64) -> f64 {
        x.asin()
    }

    pub(crate) fn atan(x: f64) -> f64 {
        x.atan()
    }

    pub(crate) fn atan2(y: f64, x: f64) -> f64 {
        y.atan2(x)
    }

    pub(crate) fn cbrt(x: f64) -> f64 {
        x.cbrt()
    }

    pub(crate) fn cos(x: f64) -> f64 {
        x.cos()
    }

    pub(crate) fn exp(x: f64) -> f64 {
        x.exp()
    }

    pub(crate) fn exp_m1(x: f64) -> f64 {
        x.exp_m1()
    }

    pub(crate) fn sin(x: f64) -> f64 {
        x.sin()
    }

    pub(crate) fn tanh(x: f64) -> f64 {
        x.tanh()
    }
}
