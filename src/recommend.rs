//! How many micro-steps springs that share bodies need.

use crate::dynamics::thresholds::MOST_PHASE;
use crate::settings::MAX_MICROSTEPS;

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.81;

/// Assumed length of the element, m.
const LENGTH: f64 = 1.0;

/// Largest result: the default of [`CoiloverSettings::max_microsteps`](crate::CoiloverSettings::max_microsteps).
const MOST: f64 = MAX_MICROSTEPS as f64;

/// Returns the number of micro-steps per engine step, for
/// [`CoiloverPlugin::with_microsteps`](crate::CoiloverPlugin::with_microsteps), that keeps the added position error
/// near `tolerance`, in metres per second of motion.
///
/// `stiffness` is in N/m, `damping` in N s/m, and the engine step `dt` in s. `mass`, in kg, is that of the body on the
/// spring, or 1/(1/m₁ + 1/m₂) for two bodies. The result is 1 to 256. It is 1 if `mass`, `dt` or `tolerance` is not
/// finite and above zero. A `stiffness` or `damping` that is not finite and above zero counts as 0.
///
/// It holds for elements that share bodies, or that pull beside the centre of a body. A lone element between two centres
/// needs no more than one micro-step, because its error is of fourth order: below 0.2 mm in 10 s at 60 Hz.
///
/// The motion along the lines is all but exact, so the error comes from the turning of the lines.
/// Drift–kick–drift with micro-steps of length h makes a rate of turning Ω too high by the share (Ωh)²/24. For a weight
/// that swings on a length L, with Ω² = g/L, the error grows by L Ω³ h²/24 every second. Measured on two springs side by
/// side, it is 0.3 to 1 times this value at ω·dt from 0.06 to 4, and up to five times more at critical damping. Hence:
///
/// > error per second = g^(3/2)/(24 √L) · (1 + 5 min(ζ, 1)²) · (dt/n)²,  ζ = c/(2 √(k m)),  L = 1 m
///
/// The error is proportional to L Ω³. A spring of 0.25 m has twice the error of one of 1 m, and so needs 1.4 times as
/// many micro-steps. In addition, n is at least ω·dt/2, so that the spring's own motion is resolved. Chains and lattices
/// needed up to three times as many in measurements. To let the game find the number while it runs, use
/// [`with_tolerance`](crate::CoiloverPlugin::with_tolerance).
///
/// ```
/// # use bevy_coilover::prelude::*;
/// let microsteps = recommend(500.0, 5.0, 1.0, 1.0 / 60.0, 1e-4);
/// assert_eq!(microsteps, 2);
/// let plugin = CoiloverPlugin::default().with_microsteps(microsteps);
/// ```
pub fn recommend(stiffness: f32, damping: f32, mass: f32, dt: f32, tolerance: f32) -> u32 {
    let [k, c, m, dt, tolerance] = [stiffness, damping, mass, dt, tolerance].map(f64::from);
    let sound = |x: f64| x.is_finite() && x > 0.0;
    if !(sound(m) && sound(dt) && sound(tolerance)) {
        return 1;
    }
    let [k, c] = [k, c].map(|x| if sound(x) { x } else { 0.0 });
    let accurate = dt * (swing(k, c, m) / tolerance).sqrt();
    let resolved = dt * (k / m).sqrt() / MOST_PHASE;
    accurate.max(resolved).ceil().clamp(1.0, MOST) as u32
}

/// Position error per second of a mass that swings on a spring, divided by the square of the micro-step, m/s³.
fn swing(k: f64, c: f64, m: f64) -> f64 {
    // Of a damper without a spring it is infinite; without both it is NaN.
    let ratio = c / (2.0 * (k * m).sqrt());
    let ratio = if ratio > 0.0 { ratio.min(1.0) } else { 0.0 };
    (GRAVITY * GRAVITY.sqrt()) / (24.0 * LENGTH.sqrt()) * (1.0 + 5.0 * ratio * ratio)
}

/// Position error that this number of micro-steps adds, m per second of motion: the inverse of [`recommend`].
#[cfg(feature = "workbench")]
pub(crate) fn error_per_second(
    stiffness: f32,
    damping: f32,
    mass: f32,
    dt: f32,
    microsteps: u32,
) -> f32 {
    let [k, c, m, dt] = [stiffness, damping, mass, dt].map(f64::from);
    let step = dt / f64::from(microsteps.max(1));
    (swing(k.max(0.0), c, m) * step * step) as f32
}

#[cfg(test)]
mod tests {
    use super::recommend;

    const DT: f32 = 1.0 / 60.0;

    #[test]
    fn a_hundredth_of_the_tolerance_takes_ten_times_as_many() {
        assert_eq!(recommend(50.0, 0.0, 1.0, DT, 1e-3), 1);
        let (coarse, fine) = (
            recommend(50.0, 0.0, 1.0, DT, 1e-6),
            recommend(50.0, 0.0, 1.0, DT, 1e-8),
        );
        assert!((9..=11).contains(&(fine / coarse)), "{coarse} {fine}");
        assert_eq!(
            recommend(50.0, 0.0, 1.0, DT / 4.0, 1e-6),
            coarse.div_ceil(4)
        );
    }

    #[test]
    fn stiff_springs_are_resolved() {
        // ω·dt = 3.7 and 37
        assert_eq!(recommend(5e4, 0.0, 1.0, DT, 1.0), 2);
        assert_eq!(recommend(5e6, 0.0, 1.0, DT, 1.0), 19);
    }

    #[test]
    fn a_damper_without_a_spring_counts_as_critical() {
        // ζ = c/(2 √(k m)): 100 N s/m are critical at 2500 N/m and 1 kg.
        let critical = recommend(2500.0, 100.0, 1.0, DT, 1e-6);
        assert_eq!(recommend(0.0, 100.0, 1.0, DT, 1e-6), critical);
        assert!(critical > 2 * recommend(2500.0, 0.0, 1.0, DT, 1e-6));
    }

    #[test]
    fn nonsense_takes_one() {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(recommend(50.0, 0.0, bad, DT, 1e-9), 1);
            assert_eq!(recommend(50.0, 0.0, 1.0, bad, 1e-9), 1);
            assert_eq!(recommend(50.0, 0.0, 1.0, DT, bad), 1);
            // Nonsense counts as no spring and no damper, which are not taken for a stiff pair.
            assert_eq!(recommend(bad, bad, 1.0, DT, 1e-4), 2);
        }
        assert_eq!(recommend(f32::MAX, 0.0, 1.0, DT, 1.0), 256);
    }
}
