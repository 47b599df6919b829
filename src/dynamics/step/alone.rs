//! Micro-steps of a lone element.

use super::Component;
use crate::dynamics::element::End;
use crate::dynamics::energy::Energy;
use crate::dynamics::guard::Guard;
use crate::dynamics::kick::{self, Map};
use crate::dynamics::line::Line;

impl Component {
    /// Takes `count` micro-steps of a lone element.
    pub(super) fn run_alone(&mut self, step: f64, count: u32) {
        // The map does not move the ends, so the line is that of the guard.
        let line = self.elements[0].line(&self.bodies);
        let guard = Guard::begin(&self.elements[0], &self.bodies, line.as_ref(), step);
        let damped = self.elements[0].damping > 0.0;
        let before = damped.then(|| self.energy_and_work());
        self.map(line.as_ref(), step, Map::ToStepped);
        for _ in 0..count {
            self.drift(step / 2.0);
            let memo = &mut self.memory.memo;
            kick::kick(&self.elements[0], &mut self.bodies, step, memo);
            self.drift(step / 2.0);
            self.aim(step);
        }
        let line = self.elements[0].line(&self.bodies);
        self.map(line.as_ref(), step, Map::ToTrue);
        if let Some(guard) = guard {
            guard.end(&self.elements[0], &mut self.bodies, step * f64::from(count));
        }
        if let Some((energy, work)) = before {
            let (now, done) = self.energy_and_work();
            self.elements[0].work += done - work;
            self.elements[0].heat += energy + done - work - now;
        }
    }

    /// Returns the energy minus the work of the users' torques, and the work of a lone element's moving ends so far, J.
    fn energy_and_work(&self) -> (f64, f64) {
        let mut work = 0.0;
        let element = &self.elements[0];
        let led = element.ends.iter().any(End::is_path);
        let line = led.then(|| element.line(&self.bodies)).flatten();
        for (i, end) in element.ends.iter().enumerate() {
            if let (End::Path(path), Some(line)) = (end, &line) {
                let hold = &line.holds[i];
                for body in &self.bodies {
                    work += if hold.twist {
                        body.given.1.dot(path.turning)
                    } else {
                        body.given.0.dot(end.motion(hold, &self.bodies).0)
                    };
                }
            }
        }
        (Energy::of(&self.elements, &self.bodies).sum(), work)
    }

    fn map(&mut self, line: Option<&Line>, step: f64, map: Map) {
        let memo = &mut self.memory.memo;
        if let Some(line) = line {
            kick::map_velocity(&self.elements[0], line, &mut self.bodies, step, map, memo);
        }
    }
}
