//! Splits a law into pieces that continue smoothly beyond the range in which they act: the spring (that of a rope only
//! pulls), and the stops, which only push where they are touched. [`crate::dynamics::pieces`] uses them.

use super::{Elastic, Law, Stop};

impl Stop {
    /// Like [`Stop::at`], but continued to where the stop is not touched, as if it were fastened there.
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
    /// Spring and preload, continued beyond the limits.
    pub(crate) fn spring_beyond(&self, length: f64, rest_length: f64) -> Elastic {
        self.bare(length - rest_length)
    }

    /// Length at which the spring's slope jumps, if it does, m. It only jumps between different stiffnesses of pull and push,
    /// because tables are smooth.
    pub(crate) fn kink(&self, rest_length: f64) -> Option<f64> {
        self.spring.is_bent().then_some(rest_length)
    }

    /// Lengths between which no limit cuts the spring's force, m.
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

    /// Distance of a length from the stop at the least or (`above`) the greatest length, m; negative where the stop is touched.
    /// None if there is no such stop.
    pub(crate) fn to_stop(&self, above: bool, length: f64) -> Option<f64> {
        let away = if above {
            self.travel[1] - length
        } else {
            length - self.travel[0]
        };
        (away.is_finite() && self.stop.stiffness > 0.0).then_some(away)
    }

    /// Tension of a stop, continued to where it is not touched.
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
