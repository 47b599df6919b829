//! Micro-steps that follow a stiff mode are taken only where the mode moves.
//!
//! How stiff a component is says how many micro-steps follow its fastest motion. Whether there is such a motion is seen by
//! going over the step with few and with twice as many: where both come to the same end, the stiff modes are at rest. (They
//! cannot hide: a mode of phase x turns by 2·atan(x/2) in one kick of the midpoint rule and by 4·atan(x/4) in two, and these
//! are never the same angle.)

use super::tolerance::Motion;
use bevy::math::DVec3;

/// What the two ends may differ by, m per simulated second. Pinned by `stiff_by_default`, and by the map of mass ratios that
/// `compare` draws.
const UNNOTICED: f64 = 1e-4;

/// What they may differ by as a share of the way that bodies go against each other: as far off is a mode that is just
/// followed ([`super::resolution`]).
const SMALL: f64 = 2e-3;

/// Micro-steps from which on it pays to try with fewer.
const WORTH: u32 = 8;

/// Share of [`UNNOTICED`] below which the next step begins with half as many: the error goes with their square, and some
/// is left so that it does not go to and fro.
const FAR_BELOW: f64 = 0.1;

/// Most steps until it is tried again, where it was in vain: the attempts then cost a thirtieth of all.
const LONGEST_WAIT: u8 = 16;

/// Memory of how finely a motion had to be followed.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Excited {
    /// Micro-steps with which the next attempt begins.
    first: u16,
    /// Steps until the next attempt, and from the last one to then.
    wait: u8,
    span: u8,
}

impl Excited {
    /// Runs over the step in `all` micro-steps, or in fewer, but no fewer than `least`, that come to the same end. Tells how
    /// many kicks that took.
    pub(super) fn run(
        &mut self,
        motion: &mut impl Motion,
        time: f64,
        [least, all]: [u32; 2],
    ) -> u32 {
        if all < WORTH.max(least.saturating_mul(4)) {
            motion.run(time, all);
            return all;
        }
        if self.wait > 0 {
            self.wait -= 1;
            motion.run(time, all);
            return all;
        }
        let mut count = u32::from(self.first).max(least);
        let mut kicks = count;
        motion.save(0);
        motion.run(time, count);
        // Beyond, all of them at once are no dearer.
        while count.saturating_mul(4) <= all {
            motion.save(1);
            motion.load(0);
            motion.run(time, 2 * count);
            kicks += 2 * count;
            let apart = motion.distance(1);
            let allowed = (UNNOTICED * time).max(SMALL * motion.travelled(0));
            if apart <= allowed {
                let calm = apart <= FAR_BELOW * allowed;
                let first = if calm { count / 2 } else { count };
                self.first = u16::try_from(first).unwrap_or(u16::MAX);
                self.span = 0;
                return kicks;
            }
            count *= 2;
        }
        // An eighth, a quarter: they tell at little cost whether it has come to rest.
        self.first = u16::try_from(all / 8).unwrap_or(u16::MAX);
        self.span = (2 * self.span).clamp(1, LONGEST_WAIT);
        self.wait = self.span;
        motion.load(0);
        motion.run(time, all);
        kicks + all
    }
}

/// Half the size of the box about all displacements: none where all went the same way.
pub(super) fn spread(displacements: impl Iterator<Item = DVec3>) -> f64 {
    let (least, most) = displacements.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), d| {
        (a.min(d), b.max(d))
    });
    if least.is_finite() {
        0.5 * (most - least).length()
    } else {
        0.0
    }
}
