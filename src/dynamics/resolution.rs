//! How finely motion has to be stepped.

use super::line::Motion;

/// Phase per coarse step up to which the fourth-order combination converges.
pub(super) const EXTRAPOLATION_LIMIT: f64 = 1.5;

/// (ω h)² of the stiffest mode beyond which a network steps finer.
pub(super) const RESOLVED: f64 = 4.0;

/// Most that a network steps finer by itself to resolve a stiff mode.
const EXTRA_STEPS: u32 = 4;

/// How far ahead a bend of a law is looked for, as a multiple of the way in a step.
const AHEAD: f64 = 1.25;

/// Micro-steps that resolve a network's stiffest mode, of (ω h)² = `z`; one where that is out of reach.
pub(super) fn finer(z: f64) -> u32 {
    let finer = (z / RESOLVED).sqrt().ceil();
    if finer <= f64::from(EXTRA_STEPS) {
        finer.max(1.0) as u32
    } else {
        1
    }
}

/// Ways along the line that the present motion can lead to in a step, as fast as it is in its middle and in its end
/// under what acts from outside.
pub(super) fn predicted_travel(motion: &Motion, time: f64) -> [f64; 2] {
    [0.5, 1.0].map(|share| AHEAD * time * (motion.axial + share * time * motion.pushed))
}
