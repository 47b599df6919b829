//! Tests that an element has the same result in a lane beside others as alone.

use super::Way;
use super::by_itself::Alone;
use super::solve::{Pace, plain};
use crate::backend::StepPlan;
use crate::dynamics::dice::Dice;
use crate::dynamics::kick::Memo;
use crate::dynamics::lanes::{LANES, Lanes, widest};
use crate::dynamics::points::FreePoint;
use crate::dynamics::tolerance::Accuracy;
use crate::input::check::Numbers;
use crate::scene::push::Given;
use crate::scene::rows::ElementRow;
use crate::scene::step::Step;
use bevy::math::{DVec3, Vec3};
use bevy::prelude::Entity;
use pulp::{Simd, WithSimd};

/// A step with the given number of micro-steps, and perhaps twice as many to extrapolate from.
fn step(microsteps: u32, extrapolate: bool) -> Step {
    let plan = StepPlan {
        time: 1.0 / 60.0,
        calls: 1,
        substeps: 4,
        fastest: 400.0,
        farthest_turn: 0.8,
        turn: |spinning, spin, _| (spinning.body.rotation, spin),
        length_unit: 1.0,
    };
    Step {
        plan,
        schedule: plan.schedule(plan.substeps),
        accuracy: Accuracy {
            extrapolate,
            ..Accuracy::exactly(microsteps)
        },
        most_substeps: 64,
        alike: None,
        quiet: false,
        tick: 1,
        delivered: false.into(),
    }
}

impl Dice {
    /// A random vector in the engine's single precision.
    fn rounded(&mut self, size: f64) -> DVec3 {
        self.vector(size).as_vec3().as_dvec3()
    }

    /// A random element, its two ends, and whether each end moves. In every fourth lane the first end does not move.
    fn element(&mut self, lane: usize) -> (ElementRow, [FreePoint; 2], [bool; 2]) {
        let mut row = ElementRow::new(Entity::PLACEHOLDER);
        row.numbers = Numbers {
            stiffness: (900.0 * self.number()) as f32,
            damping: (4.0 * (self.number() - 0.3).max(0.0)) as f32,
            rest_length: Some((0.1 + self.number()) as f32),
        };
        let moves = [lane % 4 != 1, true];
        // Some ends are faster than the engine allows.
        let speed = if self.number() < 0.02 { 900.0 } else { 20.0 };
        let place = self.rounded(100.0);
        let apart = self.rounded(if lane % 4 == 3 { 0.2 } else { 2.0 });
        let points = [0.0, 1.0].map(|end| FreePoint {
            position: place + end * apart,
            velocity: self.rounded(speed),
            acceleration: self.vector(20.0) * f64::from(lane as u32 % 2),
            inverse_mass: if moves[end as usize] {
                0.1 + 4.0 * self.number()
            } else {
                0.0
            },
        });
        (row, points, moves)
    }
}

struct Run<'a>(&'a mut Lanes, &'a Pace);

impl WithSimd for Run<'_> {
    type Output = ();

    fn with_simd<S: Simd>(self, simd: S) {
        self.0.run(simd, &self.1.stride);
    }
}

fn bits(given: &Given) -> [[u32; 3]; 2] {
    [given.velocity, given.force].map(|v: Vec3| v.to_array().map(f32::to_bits))
}

#[test]
fn what_more_microsteps_would_resolve_is_not_for_a_lane_where_it_may_take_them() {
    for (resolve, omega_dt, fits) in [(0, 2.2, true), (64, 2.2, false), (64, 1.9, true)] {
        let mut step = step(1, false);
        step.accuracy.resolve = resolve;
        let pace: Pace = step.pace().expect("a plain step");
        let (mut row, ..) = Dice(1).element(0);
        row.numbers = Numbers {
            stiffness: (60.0_f32 * omega_dt).powi(2),
            damping: 0.0,
            rest_length: Some(1.0),
        };
        let taken = plain(&mut row, 1.0, &pace, &mut Memo::default()).is_some();
        assert_eq!(taken, fits, "ω·dt {omega_dt}, up to {resolve} micro-steps");
    }
}

#[test]
fn each_goes_as_it_would_alone_bit_for_bit() {
    let mut dice = Dice(1);
    let (mut odd, mut compared) = (0, 0);
    let mut half = Memo::default();
    for (round, microsteps) in [1, 2, 4, 16].repeat(800).into_iter().enumerate() {
        let step = step(microsteps, round % 8 < 4);
        let pace: Pace = step.pace().expect("a plain step");
        let mut some: [_; LANES] = std::array::from_fn(|lane| dice.element(lane));
        let mut lanes = Lanes::default();
        for (lane, (row, points, _)) in some.iter_mut().enumerate() {
            let inverse_mass = points[0].inverse_mass + points[1].inverse_mass;
            let (numbers, poles) =
                plain(row, inverse_mass, &pace, &mut half).expect("nothing special");
            lanes.take_in(lane, points, numbers, &poles);
        }
        widest(Run(&mut lanes, &pace));
        for (lane, (mut row, points, moves)) in some.into_iter().enumerate() {
            assert_eq!(
                lanes.points(lane).map(|p| p.position),
                points.map(|p| p.position)
            );
            let more = moves.map(|moves| moves.then_some(0));
            let mut way = Way::default();
            let before = row.ledger;
            let solved = Alone { points, more }.solve(&step, &mut row, &mut way);
            let Some(reached) = lanes.way(lane) else {
                odd += 1;
                continue;
            };
            assert!(solved, "lane {lane}");
            compared += 1;
            assert_eq!(row.direction(), Some(reached.direction), "lane {lane}");
            for (end, moves) in moves.into_iter().enumerate() {
                let push = lanes.push(lane, end);
                if moves {
                    let given = Given {
                        velocity: push.velocity,
                        force: push.force,
                    };
                    assert_eq!(bits(&way.given[end]), bits(&given), "lane {lane}");
                } else {
                    assert_eq!(
                        row.ledger.work.to_bits(),
                        (before.work - push.work).to_bits()
                    );
                }
            }
            if row.is_damped() {
                assert_eq!(row.ledger.dissipated.to_bits(), reached.heat.to_bits());
            }
        }
    }
    assert!(
        (20..compared / 4).contains(&odd),
        "{odd} odd ones among {compared}"
    );
}
