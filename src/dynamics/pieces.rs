//! Splits an element's force inside an engine's solver into pieces, each of which is linear within a range of tension.
//!
//! The range decides in every substep whether a rope is taut or a stop is touched. If this were decided once before the
//! step, a rope that is slack then would not resist the stretching during the step. It would gain stored energy from
//! nothing.

use super::law::{Elastic, Law};
use super::soft::Tangent;

/// Greatest number of pieces: a damper, the spring below and above a kink, its hardening below and above, and the stops
/// below and above.
pub(crate) const MOST: usize = 7;

/// Length of the interval beside a kink or limit over which a slope is taken if the element has not got there yet, as a
/// share of [`Outreach::change`]. It must be small beside the lengths over which a law hardens. Pinned by `pieces::tests`.
const BESIDE: f64 = 0.01;

/// Increase of a spring's slope beyond the predicted lengths, as a share of the slope, above which the increase becomes a
/// piece of its own. Pinned by `ground::mixed`.
const HARDENS: f64 = 0.1;

/// Bound on the force of a one-sided piece, as a multiple of the greatest force that it is expected to reach in the step.
/// Below 1, a rope would be too weak for its load. Rapier needs a bound, and f32 loses what is small beside it, so it is not much more.
/// Pinned by `pieces::tests`.
const ROOM: f64 = 2.0;

/// A force that is linear within its range and constant outside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Piece {
    pub tangent: Tangent,
    /// Least and greatest tension, N.
    pub range: [f64; 2],
}

impl Piece {
    /// Tension at a length (m) and its rate (m/s), N.
    pub(crate) fn tension(&self, length: f64, rate: f64) -> f64 {
        let tension = self.tangent.elastic(length) + self.tangent.damping * rate;
        tension.max(self.range[0]).min(self.range[1])
    }

    /// Integral of the tension without damping between two lengths, J: the energy that the bodies lose to the piece.
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
        // Lengths at which the tension reaches the ends of its range.
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

    /// Whether its range is not symmetric about zero.
    pub(crate) fn ends(&self) -> bool {
        self.middle().0 != 0.0
    }

    /// Middle of its range and half the width of the range, N.
    pub(crate) fn middle(&self) -> (f64, f64) {
        let [least, greatest] = self.range;
        if least == -greatest {
            (0.0, greatest)
        } else {
            (0.5 * (least + greatest), 0.5 * (greatest - least))
        }
    }
}

/// Predicted change of an element's length over a step, and bounds on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outreach {
    /// Length at the start of the step, and length at its end extrapolated from the last steps, m.
    pub way: [f64; 2],
    /// Predicted rate of the length over the step, m/s.
    pub rate: f64,
    /// Greatest possible change of length in the step, m.
    pub change: f64,
    /// Greatest possible rate of the length, m/s.
    pub speed: f64,
    /// Stiffness (N/m) and damping (N s/m) above which a piece with a one-sided range is scaled down.
    pub firmest: [f64; 2],
}

/// All pieces of an element's force.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pieces {
    all: [Piece; MOST],
    count: usize,
}

impl Pieces {
    /// The one piece of a linear element.
    pub(crate) fn linear(stiffness: f64, damping: f64, rest_length: f64) -> Self {
        let mut pieces = Self::default();
        pieces.push(Piece {
            tangent: Tangent::linear(stiffness, damping, rest_length),
            range: [f64::NEG_INFINITY, f64::INFINITY],
        });
        pieces
    }

    /// Pieces of an element with a force law.
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
                let mut tangent = Tangent::chord(spring, way);
                let range = law.range();
                tangent.damping = match (range, law.uncut_between(rest_length)) {
                    ([0.0, _], [taut, _]) => reach.met(damping, &tangent, reach.beyond(taut, true)),
                    ([_, 0.0], [_, met]) => reach.met(damping, &tangent, reach.beyond(met, false)),
                    _ => damping,
                };
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
            let beyond = reach
                .way
                .map(|length| -law.to_stop(above, length).unwrap_or(0.0));
            tangent.damping = reach.met(law.stop_damping(), &tangent, beyond);
            let range = if above {
                [0.0, f64::INFINITY]
            } else {
                [f64::NEG_INFINITY, 0.0]
            };
            pieces.push_softened(&reach, tangent, range);
        }
        let has_stop = [false, true].map(|above| law.to_stop(above, reach.way[0]));
        if pieces.iter().any(Piece::ends) || has_stop != [None; 2] {
            // A damper beside one-sided pieces must not be firmer either, even while a stop is out of reach.
            for piece in &mut pieces.all {
                piece.tangent.damping = piece.tangent.damping.min(reach.firmest[1]);
            }
        }
        pieces
    }

    /// Adds a spring whose slope jumps at a kink: one piece up to the kink and one above it. The limits do not cut the
    /// spring's force between the lengths `low` and `high`.
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
            // The damper of a rope or buffer is part of its one-sided piece.
            let pulls = least == 0.0;
            let beyond = reach.beyond(if pulls { low } else { high }, pulls);
            let side = &mut sides[usize::from(pulls)];
            side.damping = reach.met(damping, side, beyond);
        }
        let slopes = sides.map(|tangent| tangent.stiffness);
        // A side on which the spring never acts must not reduce the share.
        let at_kink = spring(kink).force.max(least).min(greatest);
        let share = sides
            .iter()
            .zip([at_kink > least, at_kink < greatest])
            .filter(|(_, acts)| *acts)
            .map(|(tangent, _)| reach.share(tangent, [0.0, f64::INFINITY]))
            .fold(1.0, f64::min);
        if free {
            // The damper is a piece of its own, so that the range of neither side cuts it off. Its range is what the
            // spring leaves of the limits.
            let tangent = Tangent::linear(0.0, share * damping, kink);
            let forces = reach.way.map(|length| {
                let force = share * spring(length).force;
                force.max(least).min(greatest)
            });
            let [from, to] = forces;
            let one_way = least == 0.0 || greatest == 0.0;
            let left = if one_way && forces == [0.0; 2] {
                // A rope or buffer that stays slack does not damp. The range is not quite empty, because the joints of a
                // component are made anew if their number changes, and that of a range about zero has no second motor.
                [
                    least.max(-f64::MIN_POSITIVE),
                    greatest.min(f64::MIN_POSITIVE),
                ]
            } else {
                [least - from.min(to), greatest - from.max(to)]
            };
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

    /// Adds pieces where a spring becomes stiffer beyond `edges`, below and above, than the present pieces, which go on
    /// with the constant `slopes`. An impact takes the element farther than the last steps predict. Without these pieces
    /// it would store energy that was not taken from its bodies.
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

    /// Adds a force with this range, scaled down if it is firmer than a piece with this range may be.
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

    /// The first piece: the spring with its damper. If the spring has a kink, it is the damper alone, or for a rope or
    /// buffer the spring below the kink.
    pub(crate) fn spring(&mut self) -> &mut Tangent {
        &mut self.all[0].tangent
    }

    /// Tension at a length (m) and its rate (m/s), N.
    pub(crate) fn tension(&self, length: f64, rate: f64) -> f64 {
        self.iter().map(|piece| piece.tension(length, rate)).sum()
    }

    /// Integral of the tension without damping between two lengths, J.
    pub(crate) fn work(&self, way: [f64; 2]) -> f64 {
        self.iter().map(|piece| piece.work(way)).sum()
    }

    /// Upper bound on the slope of the tension, N/m.
    pub(crate) fn stiffness(&self) -> f64 {
        self.iter().map(|piece| piece.tangent.stiffness.abs()).sum()
    }
}

impl Outreach {
    /// Returns the way clamped to the lengths between which a spring's force is not cut. If the whole way is outside,
    /// returns a short interval at the nearer end: a slack rope gets the slope that it will have once it is taut.
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

    /// How far the way is beyond a length at its start and its end, above it or below it, m.
    fn beyond(&self, length: f64, above: bool) -> [f64; 2] {
        self.way
            .map(|way| if above { way - length } else { length - way })
    }

    /// Damping that a one-sided force has of its law's `damping` (N s/m) in this step. `beyond` is how far the force is pressed at the
    /// start and at the end of the way, m. The engine cuts the sum of spring and damper, so a damper would act before its spring is
    /// pressed, as far ahead as damping times rate over stiffness. It may do so no farther ahead than the way leads beyond that point.
    fn met(&self, damping: f64, spring: &Tangent, beyond: [f64; 2]) -> f64 {
        let (stiffness, rate) = (spring.stiffness.abs(), self.rate.abs());
        let nearest = beyond[0].max(beyond[1]);
        // Farther away it does not act, whatever its damping.
        let may_act = stiffness * nearest + damping * rate > 0.0;
        if beyond[0] >= 0.0 || beyond[1] < beyond[0] || !may_act {
            return damping;
        }
        damping.min(stiffness * nearest.max(0.0) / rate.max(f64::MIN_POSITIVE))
    }

    /// Share to which a spring with this range is scaled down, at most 1. A second motor, as strong as the greatest force
    /// of a one-sided piece, shifts the middle of its range. In a firmer piece the difference of the two motors would be
    /// lost in f32.
    fn share(&self, tangent: &Tangent, [least, greatest]: [f64; 2]) -> f64 {
        if least.is_finite() == greatest.is_finite() {
            return 1.0;
        }
        let over = tangent.stiffness.abs() / self.firmest[0];
        over.max(1.0).recip()
    }

    /// Makes a piece. If its range is one-sided, the open side gets a bound of [`ROOM`] times the force that the piece
    /// can reach in the step, and its damping is at most the firmest. A spring carries its load with any damping, so the
    /// spring stays as it is.
    fn piece(&self, mut tangent: Tangent, [least, greatest]: [f64; 2]) -> Piece {
        if least.is_finite() != greatest.is_finite() {
            tangent.damping = tangent.damping.min(self.firmest[1]);
        }
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
