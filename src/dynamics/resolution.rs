//! How finely motion has to be stepped.

use super::line::Motion;
use super::tolerance::Least;

/// Phase per coarse step up to which the fourth-order combination converges.
pub(super) const EXTRAPOLATION_LIMIT: f64 = 1.5;

/// (ω h)² of the stiffest mode beyond which a network steps finer.
pub(super) const RESOLVED: f64 = 4.0;

/// (ω h)² at which a network follows the motion that it resolves: its frequencies are right to a few parts in a million, and
/// so little energy sways that nothing of it is taken for won. Pinned by `stiff_by_default`.
const FOLLOWED: f64 = 0.1;

/// Most that a network steps finer by itself to resolve a stiff mode, whatever its size and whatever is asked.
const EXTRA_STEPS: u32 = 4;

/// Kicks that a network takes to follow what it resolves already: few, as it is not wrong by much.
const FEW_KICKS: usize = 16;

/// Most micro-steps that resolve a lone element, whatever is asked: ω·dt of 64, at a microsecond.
const MOST_ALONE: u32 = 32;

/// How far ahead a bend of a law is looked for, as a multiple of the way in a step.
const AHEAD: f64 = 1.25;

/// Micro-steps that resolve a lone element of (ω h)² = `z`, along whose line the step is exact then; one where that is more
/// than `most`.
pub(super) fn lone_steps(z: f64, most: u32) -> Least {
    Least::of(
        z,
        within((z / RESOLVED).sqrt(), most.min(MOST_ALONE)).unwrap_or(1),
    )
}

/// Micro-steps with which a network of so many elements follows its stiffest mode, of (ω h)² = `z`, if they are not more than
/// `most`; else those that just resolve it, if they are few.
pub(super) fn network_steps(z: f64, elements: usize, most: u32) -> Least {
    // These are its own, whatever others there are; none where just one step is asked for.
    let few = if most == 0 {
        1
    } else {
        (FEW_KICKS / elements.max(1)) as u32
    };
    let most = if z <= RESOLVED { few } else { most.max(few) };
    let count = within((z / FOLLOWED).sqrt(), most)
        .or_else(|| within((z / RESOLVED).sqrt(), EXTRA_STEPS))
        .unwrap_or(1);
    Least::of(z, count)
}

impl Least {
    /// So many micro-steps for a motion of (ω h)² = `z` in the whole step.
    fn of(z: f64, count: u32) -> Self {
        Self {
            count,
            suffice: z <= RESOLVED * f64::from(count).powi(2),
        }
    }

    /// (ω h)² in one of the micro-steps.
    pub(super) fn in_each(self, z: f64) -> f64 {
        z / f64::from(self.count).powi(2)
    }
}

fn within(steps: f64, most: u32) -> Option<u32> {
    (steps <= f64::from(most)).then(|| steps.ceil().max(1.0) as u32)
}

/// Ways along the line that the present motion can lead to in a step, as fast as it is in its middle and in its end
/// under what acts from outside.
pub(super) fn predicted_travel(motion: &Motion, time: f64) -> [f64; 2] {
    [0.5, 1.0].map(|share| AHEAD * time * (motion.axial + share * time * motion.pushed))
}
