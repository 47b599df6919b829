//! Does the motion of a damped spring follow y″ + 2ζω y′ + ω² y = 0?

use crate::fit::exact;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

struct Case {
    phase: f64,
    zeta: f64,
    /// Initial displacement from the rest length, m.
    release: f64,
    /// Initial velocity, m/s.
    kick: f64,
    microsteps: u32,
}

/// Largest error over ten seconds, and the lowest point. Both as a fraction of the amplitude, which is the initial
/// displacement or v/ω.
fn error(case: &Case) -> (f64, f64) {
    let mass = 2.0_f32;
    let k = (f64::from(mass) * (case.phase / f64::from(DT)).powi(2)) as f32;
    let omega = (f64::from(k) / f64::from(mass)).sqrt();
    let c = (2.0 * case.zeta * omega * f64::from(mass)) as f32;
    let zeta = f64::from(c) / (2.0 * omega * f64::from(mass));
    let plugin = CoiloverPlugin::default().with_microsteps(case.microsteps);
    let mut lab = Lab::with(plugin, Engine::weightless());
    let hook = lab.point(Vec3::ZERO);
    let weight = lab.body(mass, Vec3::X * (1.0 + case.release as f32));
    lab.get_mut::<Velocity>(weight).linear = Vec3::X * case.kick as f32;
    lab.spawn(
        SpringDamper::new(hook, weight)
            .with_stiffness(k)
            .with_damping(c)
            .with_rest_length(1.0),
    );
    let amplitude = if case.kick == 0.0 {
        case.release
    } else {
        case.kick / omega
    };
    let (mut worst, mut lowest) = (0.0_f64, f64::MAX);
    for i in 1..=600 {
        lab.tick();
        let y = f64::from(lab.position(weight).x) - 1.0;
        let t = f64::from(i) * f64::from(DT);
        worst = worst.max((y - exact(omega, zeta, case.release, case.kick, t)).abs());
        lowest = lowest.min(y);
    }
    (worst / amplitude, lowest / amplitude)
}

const ZETAS: [f64; 8] = [0.05, 0.2, 0.5, 0.9, 1.0, 2.0, 5.0, 20.0];
const PHASES: [f64; 4] = [0.02, 0.05, 0.1, 0.3];

#[test]
fn released_at_rest_it_decays_as_theory_says() {
    for (microsteps, bar) in [(1, 8e-3), (4, 6e-4)] {
        let mut worst = 0.0_f64;
        for zeta in ZETAS {
            for phase in PHASES {
                let (error, lowest) = error(&Case {
                    phase,
                    zeta,
                    release: 0.5,
                    kick: 0.0,
                    microsteps,
                });
                worst = worst.max(error);
                assert!(
                    error <= bar,
                    "ζ {zeta} ω·dt {phase} ×{microsteps}: {error:e}"
                );
                if zeta >= 1.0 {
                    assert!(
                        lowest > -2e-5,
                        "ζ {zeta} ω·dt {phase} overshoots to {lowest:e}"
                    );
                }
            }
        }
        println!(
            "decay, released at rest, ×{microsteps}: {worst:.1e} of the amplitude (bar {bar})"
        );
    }
}

#[test]
fn started_with_a_velocity_it_is_as_exact() {
    // The step is the exact axial solution for any initial state. The remaining error is rounding, and what is
    // left where the body falls asleep. The tolerance of a second-order step would be (ω·dt)²/12 = 7.5e-3 of v/ω
    // here.
    let mut worst = 0.0_f64;
    for zeta in ZETAS {
        for phase in PHASES {
            let kick = 0.5 * phase / f64::from(DT);
            let (error, _) = error(&Case {
                phase,
                zeta,
                release: 0.0,
                kick,
                microsteps: 1,
            });
            worst = worst.max(error);
            assert!(error <= 6e-4, "ζ {zeta} ω·dt {phase}: {error:e}");
        }
    }
    println!("decay, started with a velocity, ×1: {worst:.1e} of v/ω");
}
