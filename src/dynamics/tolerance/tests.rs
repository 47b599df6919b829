use super::*;

/// A timestep, s.
pub(in crate::dynamics) const STEP: f64 = 1.0 / 240.0;

/// A motion whose error is C/n² + D/n⁴ per second in steps of [`STEP`].
pub(in crate::dynamics) struct Model {
    errors: (f64, f64),
    now: f64,
    slots: [f64; 3],
    kicks: u32,
    /// Whether extrapolation converges.
    resolved: bool,
}

impl Model {
    pub(in crate::dynamics) fn new(errors: (f64, f64)) -> Self {
        Self {
            errors,
            now: 0.0,
            slots: [0.0; 3],
            kicks: 0,
            resolved: true,
        }
    }
}

impl Steppable for Model {
    fn save(&mut self, slot: usize) {
        self.slots[slot] = self.now;
    }
    fn load(&mut self, slot: usize) {
        self.now = self.slots[slot];
    }
    fn least(&mut self, _: f64, _: u32) -> Least {
        Least {
            count: 1,
            suffice: true,
        }
    }
    fn run(&mut self, time: f64, count: u32) {
        let n = f64::from(count) * STEP / time;
        self.now += time * (self.errors.0 / n.powi(2) + self.errors.1 / n.powi(4));
        self.kicks += count;
    }
    fn distance(&self, slot: usize) -> f64 {
        (self.now - self.slots[slot]).abs()
    }
    fn travelled(&self, slot: usize) -> f64 {
        self.distance(slot)
    }
    fn extrapolate(&mut self, slot: usize) {
        self.now += (self.now - self.slots[slot]) / 3.0;
    }
    fn is_resolved(&mut self, _: f64) -> bool {
        self.resolved
    }
}

/// The given tolerance (m/s), with at least one micro-step.
fn accuracy(tolerance: f64) -> Accuracy {
    Accuracy {
        microsteps: 1,
        resolve: 1,
        extrapolate: false,
        tolerance: Some(tolerance),
        max_microsteps: 256,
        max_iterations: 1,
    }
}

#[test]
fn the_tolerance_is_kept_when_the_timestep_changes() {
    for errors in [(1.0, 1e-2), (1.0, 1.0)] {
        let mut model = Model::new(errors);
        let mut controller = Controller::default();
        let tolerance = 0.02;
        for time in [STEP; 60].into_iter().chain([8.0 * STEP; 20]) {
            let before = model.now;
            controller.drive(&mut model, time, accuracy(tolerance));
            let added = (model.now - before).abs();
            // A probe measures both errors together, so its constants are slightly off.
            assert!(
                added <= 1.1 * tolerance * time,
                "{errors:?}: {added} in {time} s"
            );
        }
    }
}

#[test]
fn the_tolerance_is_kept_with_few_kicks() {
    for (errors, tolerance, most) in [
        ((1e-3, 1e-4), 1e-2, 1.5),
        ((1e-1, 1e-3), 1e-2, 5.5),
        ((1.0, 1e-2), 1e-3, 9.0),
        ((1.0, 1.0), 1e-4, 60.0),
    ] {
        let mut model = Model::new(errors);
        let mut controller = Controller::default();
        for _ in 0..240 {
            controller.drive(&mut model, STEP, accuracy(tolerance));
        }
        assert!(model.now.abs() <= tolerance, "{errors:?}: {}", model.now);
        let kicks = f64::from(model.kicks) / 240.0;
        assert!(kicks < most, "{errors:?} at {tolerance}: {kicks} kicks");
    }
}

#[test]
fn any_number_of_microsteps_keeps_below_the_cap() {
    for microsteps in [300, 1 << 30, u32::MAX] {
        let mut model = Model::new((1.0, 1.0));
        let accuracy = Accuracy::exactly(microsteps);
        let outcome = Controller::default().drive(&mut model, 1.0 / 60.0, accuracy);
        assert_eq!((model.kicks, outcome.microsteps), (256, 256));
        assert!(outcome.capped);
    }
}

/// Drives a motion that only plain micro-steps suit, with an error of `error(step)`/n² per second, for 240 steps. Returns its
/// error as a multiple of what the tolerance allows in that time, and the kicks per step.
fn driven(error: impl Fn(u32) -> f64) -> (f64, f64) {
    let mut model = Model::new((0.0, 0.0));
    model.resolved = false;
    let (mut controller, tolerance) = (Controller::default(), 1e-2);
    for step in 0..240 {
        model.errors.0 = error(step);
        controller.drive(&mut model, STEP, accuracy(tolerance));
    }
    let allowed = 240.0 * STEP * tolerance;
    (model.now.abs() / allowed, f64::from(model.kicks) / 240.0)
}

#[test]
fn a_motion_that_becomes_wild_is_probed_sooner() {
    // Growth of the error in each of twenty steps out of eighty.
    for (times, most_error, most_kicks) in [(1.0, 1.0001, 11.3), (1.1, 1.1, 28.0), (1.2, 1.3, 63.0)]
    {
        let (error, kicks) = driven(|step| f64::powi(times, (step % 80).min(20) as i32));
        assert!(error < most_error, "grows by {times}: {error}");
        assert!(kicks < most_kicks, "grows by {times}: {kicks} kicks");
    }
    // Ten times the error from one step to the next, until the next probe.
    let (error, kicks) = driven(|step| if step % 60 < 30 { 1.0 } else { 10.0 });
    assert!(error < 2.0 && kicks < 24.0, "{error}, {kicks} kicks");
}
