//! How many micro-steps a spring needs.

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.81;

/// Length of the element that is assumed, m.
const LENGTH: f64 = 1.0;

/// Most radians per micro-step at which a spring's own motion is surely resolved.
const RESOLVED: f64 = 2.0;

/// As [`CoiloverSettings::max_microsteps`](crate::CoiloverSettings::max_microsteps) has it by default.
const MOST: f64 = 256.0;

/// Micro-steps per engine step for
/// [`CoiloverPlugin::with_microsteps`](crate::CoiloverPlugin::with_microsteps) so that the error of position
/// that is added stays near `tolerance` metres per second of motion.
///
/// `stiffness` in N/m, `damping` in N s/m, `dt` the engine step in s. `mass` in kg is that of the body on the
/// spring, or 1/(1/m₁ + 1/m₂) of two. At least 1, at most 256; 1 where an argument makes no sense.
///
/// Along its line a lone element is exact, so the error comes from the line's turning. Drift–kick–drift of
/// step h is (Ωh)²/24 too fast where something turns at Ω: a weight that swings over a length L is wrong by
/// L Ω³ h²/24 more every second, with Ω² = g/L. `docs/speed_vs_error.md` measures 0.3 to 1 times that at
/// ω·dt from 0.06 to 4, and up to five times more at critical damping, hence
///
/// > error per second = g^(3/2)/(24 √L) · (1 + 5 min(ζ, 1)²) · (dt/n)²,  ζ = c/(2 √(k m)),  L = 1 m
///
/// Errors go with L Ω³: a spring of a quarter of a metre has twice as much, and so needs 1.4 times as many
/// micro-steps. Besides, n is at least ω·dt/2, so that the spring's own motion is resolved. Elements that
/// share bodies were measured to need up to three times as many. To have it found out while the game runs,
/// use [`with_tolerance`](crate::CoiloverPlugin::with_tolerance).
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
    let k = if sound(k) { k } else { 0.0 };
    let accurate = dt * (swing(k, c, m) / tolerance).sqrt();
    let resolved = dt * (k / m).sqrt() / RESOLVED;
    accurate.max(resolved).ceil().clamp(1.0, MOST) as u32
}

/// Error per second and square of the micro-step, m/s³, of a mass on a spring that swings.
fn swing(k: f64, c: f64, m: f64) -> f64 {
    let ratio = c / (2.0 * (k * m).sqrt());
    let ratio = if ratio.is_finite() && ratio > 0.0 {
        ratio.min(1.0)
    } else {
        0.0
    };
    (GRAVITY * GRAVITY.sqrt()) / (24.0 * LENGTH.sqrt()) * (1.0 + 5.0 * ratio * ratio)
}

/// The error of position, m per second of motion, that so many micro-steps add: [`recommend`] the other way round.
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
    fn nonsense_takes_one() {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(recommend(50.0, 0.0, bad, DT, 1e-9), 1);
            assert_eq!(recommend(50.0, 0.0, 1.0, bad, 1e-9), 1);
            assert_eq!(recommend(50.0, 0.0, 1.0, DT, bad), 1);
            assert_eq!(recommend(bad, bad, 1.0, DT, 1.0), 1);
        }
        assert_eq!(recommend(f32::MAX, 0.0, 1.0, DT, 1.0), 256);
    }
}
