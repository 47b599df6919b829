//! An element's force over a step inside an engine's solver, as pieces each of which is linear within a range.
//!
//! Whether a rope is taut, or a stop touched, is decided in every substep by the range, not once in a step. Decided before
//! the step, a rope that is slack then would not hold what stretches it meanwhile, and have its energy from nothing.

use super::law::{Elastic, Law};
use super::soft::Tangent;

/// Damper, spring below and above a kink, what it hardens by below and above, and stops below and above.
pub(crate) const MOST: usize = 7;

/// Share of how far an element may come over which the slope beside a kink is taken, where it is not there yet.
const BESIDE: f64 = 0.01;

/// Share of its slope by which a spring is stiffer beyond its way for that to be a piece of its own. Pinned by `ground::mixed`.
const HARDENS: f64 = 0.1;

/// Times the force that a piece can come to over a step, as far as can be seen, that it may have.
const ROOM: f64 = 2.0;

/// A force that is linear as long as it does not leave its range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Piece {
    pub tangent: Tangent,
    /// Least and greatest tension, N.
    pub range: [f64; 2],
}

impl Piece {
    /// Tension at a length and its rate.
    pub(crate) fn tension(&self, length: f64, rate: f64) -> f64 {
        let tension = self.tangent.elastic(length) + self.tangent.damping * rate;
        tension.max(self.range[0]).min(self.range[1])
    }

    /// Integral of the tension at rest between two lengths, J: what the bodies lose to it.
    fn work(&self, [from, to]: [f64; 2]) -> f64 {
        let Tangent {
            force,
            at,
            stiffness,
            ..
        } = self.tangent;
        if stiffness <= 0.0 {
            return (to - from) * 0.5 * (self.tension(from, 0.0) + self.tension(to, 0.0));
        }
        // Where it comes to the ends of its range.
        let ends = self.range.map(|tension| at + (tension - force) / stiffness);
        let until = |length: f64| {
            let within = length.max(ends[0]).min(ends[1]);
            let inside = self.tangent.work([at, within]);
            let outside = length - within;
            inside
                + if outside == 0.0 {
                    0.0
                } else {
                    outside * self.tension(length, 0.0)
                }
        };
        until(to) - until(from)
    }

    /// Whether its range ends on one side nearer than on the other.
    pub(crate) fn ends(&self) -> bool {
        self.middle().0 != 0.0
    }

    /// Its range as one that lies evenly about a middle, and half of its width.
    pub(crate) fn middle(&self) -> (f64, f64) {
        let [least, greatest] = self.range;
        if least == -greatest {
            (0.0, greatest)
        } else {
            (0.5 * (least + greatest), 0.5 * (greatest - least))
        }
    }
}

/// How far an element may come over a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outreach {
    /// Lengths at its start and at its end, as the last steps went on, m.
    pub way: [f64; 2],
    /// Rate over it, m/s.
    pub rate: f64,
    /// Greatest change of length that can be thought of, m,
    pub change: f64,
    /// and greatest rate, m/s.
    pub speed: f64,
    /// Stiffness, N/m, and damping, N s/m, above which a piece whose range ends on one side is softened.
    pub firmest: [f64; 2],
}

/// All pieces of an element's force.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pieces {
    all: [Piece; MOST],
    count: usize,
}

impl Pieces {
    /// Of a linear element.
    pub(crate) fn linear(stiffness: f64, damping: f64, rest_length: f64) -> Self {
        let mut pieces = Self::default();
        pieces.push(Piece {
            tangent: Tangent::linear(stiffness, damping, rest_length),
            range: [f64::NEG_INFINITY, f64::INFINITY],
        });
        pieces
    }

    /// Of a law.
    pub(crate) fn of(law: &Law, rest_length: f64, reach: Outreach) -> Self {
        let mut pieces = Self::default();
        let drag = law.drag.at(reach.rate);
        let damping = if reach.rate == 0.0 {
            drag.slope
        } else {
            drag.force / reach.rate
        };
        let damping = damping.max(0.0);
        let spring = |length| law.spring_beyond(length, rest_length);
        match law.kink(rest_length) {
            None => {
                let way = reach.way_between(law.uncut_between(rest_length));
                let tangent = Tangent::chord(spring, way);
                let tangent = Tangent { damping, ..tangent };
                let range = law.range();
                pieces.push_softened(&reach, tangent, range);
                let edges = [way[0].min(way[1]), way[0].max(way[1])];
                pieces.push_hardening(&reach, edges, spring, [tangent.stiffness; 2], range);
            }
            Some(kink) => {
                let uncut = law.uncut_between(rest_length);
                pieces.push_split(&reach, spring, kink, damping, uncut, law.range());
            }
        }
        for above in [false, true] {
            let away = law.to_stop(above, reach.way[0]);
            if away.is_none_or(|away| away > reach.change) {
                continue;
            }
            let mut tangent = Tangent::chord(|length| law.stop_beyond(above, length), reach.way);
            tangent.damping = law.stop_damping();
            let range = if above {
                [0.0, f64::INFINITY]
            } else {
                [f64::NEG_INFINITY, 0.0]
            };
            pieces.push_softened(&reach, tangent, range);
        }
        let has_stop = [false, true].map(|above| law.to_stop(above, reach.way[0]));
        if pieces.iter().any(Piece::ends) || has_stop != [None; 2] {
            // A damper beside them must not be firmer either, nor one beside a stop that is not near.
            for piece in &mut pieces.all {
                piece.tangent.damping = piece.tangent.damping.min(reach.firmest[1]);
            }
        }
        pieces
    }

    /// A spring whose slope leaps: a piece that comes up to the kink from below, and one that goes on above it. Its force is
    /// not cut from `low` to `high`.
    fn push_split(
        &mut self,
        reach: &Outreach,
        spring: impl Fn(f64) -> Elastic,
        kink: f64,
        damping: f64,
        [low, high]: [f64; 2],
        [least, greatest]: [f64; 2],
    ) {
        let free = least.is_finite() == greatest.is_finite();
        let mut sides = [[low, kink.min(high)], [kink.max(low), high]]
            .map(|side| Tangent::chord(&spring, reach.way_between(side)));
        if !free {
            // A rope's damper is a part of what pulls.
            sides[usize::from(least == 0.0)].damping = damping;
        }
        let slopes = sides.map(|tangent| tangent.stiffness);
        // A side that never acts softens nothing.
        let at_kink = spring(kink).force.max(least).min(greatest);
        let share = sides
            .iter()
            .zip([at_kink > least, at_kink < greatest])
            .filter(|(_, acts)| *acts)
            .map(|(tangent, _)| reach.share(tangent, [0.0, f64::INFINITY]))
            .fold(1.0, f64::min);
        if free {
            // Damping of its own, which neither side's range cuts off. It has what the spring leaves of the limit.
            let tangent = Tangent::linear(0.0, share * damping, kink);
            let [from, to] = reach.way.map(|length| {
                let force = share * spring(length).force;
                force.max(least).min(greatest)
            });
            let left = [least - from.min(to), greatest - from.max(to)];
            self.push(reach.piece(tangent, left));
        }
        let middle = (share * spring(kink).force).max(least).min(greatest);
        let [below, mut above] = sides.map(|tangent| tangent.times(share));
        above.force -= middle;
        self.push(reach.piece(below, [least, middle]));
        self.push(reach.piece(above, [0.0, greatest - middle]));
        let [from, to] = reach.way;
        let edges = [from.min(to).min(kink), from.max(to).max(kink)];
        self.push_hardening(reach, edges, spring, slopes, [least, greatest]);
    }

    /// What a spring is stiffer by beyond these lengths, below and above, than the pieces that go on there with these slopes. A
    /// blow takes it farther than the last steps tell: it would store what was never taken from its bodies.
    fn push_hardening(
        &mut self,
        reach: &Outreach,
        edges: [f64; 2],
        spring: impl Fn(f64) -> Elastic,
        slopes: [f64; 2],
        limits: [f64; 2],
    ) {
        for above in [false, true] {
            let side = usize::from(above);
            let edge = edges[side];
            if limits[side].is_finite() || reach.change <= 0.0 {
                continue;
            }
            let (far, range) = if above {
                (edge + reach.change, [0.0, f64::INFINITY])
            } else {
                (edge - reach.change, [f64::NEG_INFINITY, 0.0])
            };
            let beyond = (spring(far).force - spring(edge).force) / (far - edge);
            let harder = beyond - slopes[side];
            if harder > HARDENS * slopes[side] {
                self.push_softened(reach, Tangent::linear(harder, 0.0, edge), range);
            }
        }
    }

    /// A force of such a range, as firm as one with this range may be.
    fn push_softened(&mut self, reach: &Outreach, tangent: Tangent, range: [f64; 2]) {
        let share = reach.share(&tangent, range);
        self.push(reach.piece(tangent.times(share), range));
    }

    fn push(&mut self, piece: Piece) {
        self.all[self.count] = piece;
        self.count += 1;
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Piece> {
        self.all[..self.count].iter()
    }

    /// The spring with its damper.
    pub(crate) fn spring(&mut self) -> &mut Tangent {
        &mut self.all[0].tangent
    }

    /// Tension at a length and its rate.
    pub(crate) fn tension(&self, length: f64, rate: f64) -> f64 {
        self.iter().map(|piece| piece.tension(length, rate)).sum()
    }

    /// Integral of the tension at rest between two lengths, J.
    pub(crate) fn work(&self, way: [f64; 2]) -> f64 {
        self.iter().map(|piece| piece.work(way)).sum()
    }

    /// Greatest slope, N/m.
    pub(crate) fn stiffness(&self) -> f64 {
        self.iter().map(|piece| piece.tangent.stiffness.abs()).sum()
    }
}

impl Outreach {
    /// Its way where a spring's force is not cut, or a beginning of it there: that of a rope is what it has once it is taut.
    fn way_between(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let way = self.way.map(|length| length.max(low).min(high));
        if !(way[0].is_finite() && way[1].is_finite()) {
            return self.way;
        }
        let inward = BESIDE * self.change;
        if way == [low; 2] {
            [low, (low + inward).min(high)]
        } else if way == [high; 2] {
            [high, (high - inward).max(low)]
        } else {
            way
        }
    }

    /// What is left of a piece with such a range, as a share. The motor that moves its middle is as strong as all that it
    /// may come to, and in f32 their difference would be lost.
    fn share(&self, tangent: &Tangent, [least, greatest]: [f64; 2]) -> f64 {
        if least.is_finite() == greatest.is_finite() {
            return 1.0;
        }
        let [stiffness, damping] = self.firmest;
        let over = (tangent.stiffness.abs() / stiffness).max(tangent.damping / damping);
        over.max(1.0).recip()
    }

    /// A piece whose range is closed, if it ends on one side: it may be as strong as it can come to be, and more.
    fn piece(&self, tangent: Tangent, [least, greatest]: [f64; 2]) -> Piece {
        let now = tangent.elastic(self.way[0]).abs();
        let more = tangent.stiffness.abs() * self.change + tangent.damping * self.speed;
        let most = (ROOM * (now + more)).max(f64::MIN_POSITIVE);
        let range = match [least, greatest].map(f64::is_finite) {
            [true, false] => [least, most.max(least)],
            [false, true] => [(-most).min(greatest), greatest],
            _ => [least, greatest],
        };
        Piece { tangent, range }
    }
}

#[cfg(test)]
mod tests;
