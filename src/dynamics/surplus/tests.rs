use crate::dynamics::kick::Memo;
use crate::dynamics::moving::Moving;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::tolerance::{Accuracy, Controller};
use crate::settings::RESOLVE;
use bevy::math::DVec3;

const STEP: f64 = 1.0 / 60.0;

/// Random number generator, so that a scene is the same on every machine.
struct Dice(u64);

impl Dice {
    /// A power of ten between two exponents.
    fn power(&mut self, [from, to]: [f64; 2]) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        10_f64.powf(from + (to - from) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

/// Takes a pair through `steps` steps with the default settings. Returns the greatest energy on the way as a share of the first.
fn greatest_energy(pair: &Pair, mut state: Separation, steps: u32) -> f64 {
    let mut memo = Memo::default();
    let mut controller = Controller::default();
    let accuracy = Accuracy {
        resolve: RESOLVE,
        ..Accuracy::exactly(1)
    };
    let [_, first] = pair.energies(&state);
    let mut greatest = first;
    for _ in 0..steps {
        let mut moving = Moving::new(pair, state, &mut memo);
        controller.drive(&mut moving, STEP, accuracy);
        state = moving.state;
        greatest = greatest.max(pair.energies(&state)[1]);
    }
    greatest / first
}

#[test]
fn ends_that_fly_past_each_other_win_nothing() {
    // Exponents of ω·dt and of c·dt/m.
    for (what, omega, damping) in [
        ("resolved, without damping", [-1.0, 0.3], None),
        ("stiff, without damping", [0.3, 1.75], None),
        ("damped", [-1.0, 3.0], Some([-2.0, 1.0])),
        ("strongly damped", [-1.0, 3.0], Some([0.0, 5.0])),
    ] {
        let mut worst = 0.0_f64;
        for seed in 0..250 {
            let mut dice = Dice(seed * 77 + 5);
            for _ in 0..3 {
                dice.power([0.0, 1.0]);
            }
            let omega = dice.power(omega) / STEP;
            let rest_length = dice.power([-1.0, 1.0]);
            let pair = Pair {
                stiffness: omega * omega,
                damping: damping.map_or(0.0, |exponents| dice.power(exponents) / STEP),
                rest_length,
                inverse_mass: 1.0,
                outside: DVec3::ZERO,
                rounding: 1e-9,
            };
            // The line may turn by up to ten radians in the first step.
            let length = rest_length * dice.power([-0.7, 0.5]);
            let speed = length / STEP * dice.power([-2.0, 1.0]);
            let angle = dice.power([-1.0, 0.8]);
            let start = Separation::new(
                length * DVec3::X,
                speed * DVec3::new(angle.cos(), angle.sin(), 0.0),
                Some(DVec3::X),
            );
            worst = worst.max(greatest_energy(&pair, start, 200));
        }
        println!("{what}: at most {worst:.4} of the energy");
        assert!(worst < 1.1, "{what}: {worst}");
    }
}
