use crate::dynamics::dice::Dice;
use crate::dynamics::kick::Memo;
use crate::dynamics::moving::Moving;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::tests::DT;
use crate::dynamics::tolerance::{Accuracy, Controller};
use crate::settings::RESOLVE;
use bevy::math::DVec3;

/// A random power of ten between two exponents.
fn power(dice: &mut Dice, [from, to]: [f64; 2]) -> f64 {
    10_f64.powf(from + (to - from) * dice.number())
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
        controller.drive(&mut moving, DT, accuracy);
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
                power(&mut dice, [0.0, 1.0]);
            }
            let omega = power(&mut dice, omega) / DT;
            let rest_length = power(&mut dice, [-1.0, 1.0]);
            let pair = Pair {
                stiffness: omega * omega,
                damping: damping.map_or(0.0, |exponents| power(&mut dice, exponents) / DT),
                rest_length,
                inverse_mass: 1.0,
                outside: DVec3::ZERO,
                rounding: 1e-9,
            };
            // The line may turn by up to ten radians in the first step.
            let length = rest_length * power(&mut dice, [-0.7, 0.5]);
            let speed = length / DT * power(&mut dice, [-2.0, 1.0]);
            let angle = power(&mut dice, [-1.0, 0.8]);
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
