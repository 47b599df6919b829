//! A law as a sum of pieces, each of which is smooth but for the range that it never leaves: the spring, which a rope has
//! pull only, and the stops, which push only where they are touched.

use super::{Elastic, Law, Stop};

impl Stop {
    /// As [`Stop::at`], and going on beyond where it is touched as if it held there too.
    fn held_at(&self, p: f64) -> Elastic {
        if p >= 0.0 {
            return self.at(p);
        }
        Elastic {
            force: self.stiffness * p,
            stiffness: self.stiffness,
            energy: 0.5 * self.stiffness * p * p,
        }
    }
}

impl Law {
    /// The spring with its preload, going on beyond its range.
    pub(crate) fn spring_beyond(&self, length: f64, rest_length: f64) -> Elastic {
        self.bare(length - rest_length)
    }

    /// The length at which the spring's slope leaps, if it does: tables are smooth, and only pull and push may differ.
    pub(crate) fn kink(&self, rest_length: f64) -> Option<f64> {
        self.spring.is_bent().then_some(rest_length)
    }

    /// Lengths between which the spring's force is not cut.
    pub(crate) fn uncut_between(&self, rest_length: f64) -> [f64; 2] {
        self.at_limits.map(|stretch| rest_length + stretch)
    }

    /// Least and greatest tension of spring and damper together, N.
    pub(crate) fn range(&self) -> [f64; 2] {
        [
            self.limits[0].max(-self.most),
            self.limits[1].min(self.most),
        ]
    }

    /// How far a length is from the touch of a stop, below or above; none where there is no such stop.
    pub(crate) fn to_stop(&self, above: bool, length: f64) -> Option<f64> {
        let away = if above {
            self.travel[1] - length
        } else {
            length - self.travel[0]
        };
        (away.is_finite() && self.stop.stiffness > 0.0).then_some(away)
    }

    /// Tension of a stop, going on beyond its range.
    pub(crate) fn stop_beyond(&self, above: bool, length: f64) -> Elastic {
        let mut stop = if above {
            self.stop.held_at(length - self.travel[1])
        } else {
            self.stop.held_at(self.travel[0] - length)
        };
        if !above {
            stop.force = -stop.force;
        }
        stop
    }

    /// Damping of a stop, N s/m.
    pub(crate) fn stop_damping(&self) -> f64 {
        self.stop.damping
    }
}
