//! Lets a damper with a limited force bring its ends to rest and keep them there, as a clutch does.
//!
//! The force of a slipping clutch has no slope, so the linearised kick takes it as constant. In the step in which its ends come to
//! rest against each other, that force would throw them back, and in the next step again. There the force falls with the speed, as
//! fast as it must for the ends to be at rest at the end of the step.

use super::bounds::of_others;
use super::{Network, Row};
use crate::dynamics::element::Element;
use crate::dynamics::strut::Strut;

/// Ratio of secant and slope above which the force of a damper counts as limited. Below, it may be rounding. Pinned by
/// `network::tests`.
const LIMITED: f64 = 1.001;

impl Network {
    /// Makes limited dampers hold whose ends would reverse under the present solution. Returns whether there are any; then the
    /// system must be solved anew.
    pub(super) fn hold_slipping(&mut self, elements: &[Element], step: f64) -> bool {
        let mut any = false;
        for (row, strut) in self.rows.iter_mut().zip(&mut self.system.struts) {
            let element = &elements[row.element];
            if element.law.is_none() {
                continue;
            }
            let gained = strut.relative(&self.acceleration).dot(row.line.direction);
            let rate = row.before.axial;
            let reverses = rate * (rate + step * gained) < 0.0;
            if reverses && row.braking > LIMITED * element.drag(row.line.length, rate).slope {
                let others = step * of_others(&self.damping, &row.line, row.braking);
                any |= row.hold(strut, gained, others, step);
            }
        }
        any
    }
}

impl Row {
    /// Makes its damper hold. `gained` is the relative acceleration under its full force, m/s², and `others` is c h/m of the other
    /// dampers at its ends. Returns whether that changes anything.
    fn hold(&mut self, strut: &mut Strut, gained: f64, others: f64, step: f64) -> bool {
        let (gained, rate) = (gained.abs(), self.before.axial.abs());
        let own = self.braking * step * self.line.inverse_mass;
        // Each of several clutches at a body has its share in stopping it.
        let inverse_mass = self.line.inverse_mass * (own + others) / own;
        // By this factor, the linear part of the element already reduces a change of the acceleration.
        let resists = 1.0 + inverse_mass * strut.along;
        let stops = (step * gained / rate - 1.0) / inverse_mass;
        // Where something else reverses the motion, the force turns round with it, but not beyond its limit.
        let turned = 2.0 * self.drag.abs();
        let left = resists * gained - turned * inverse_mass;
        let most = if left > 0.0 {
            turned / left
        } else {
            f64::INFINITY
        };
        let more = resists * stops.min(most);
        if more > 0.0 {
            self.damping += more;
            self.centripetal_gain += more;
            strut.along += more;
        }
        more > 0.0
    }
}
