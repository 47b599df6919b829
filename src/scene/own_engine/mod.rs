//! Tests of scene and solver with a small engine in place of Rapier. They show that the crate needs
//! no more of an engine than that.
//!
//! The engine moves bodies ("bricks") in equal substeps, in single precision, with the velocity and the force that they are
//! given. It turns them by the exponential of the spin, with constant angular momentum.

mod engine;

use super::free::Spare;
use super::show::{Readouts, Springs};
use super::state::Scene;
use super::step::Step;
use crate::backend::{Allowance, BodyId, Finder, Found, Movable, Place, Stance, Wrench};
use crate::dynamics::guide::Guide;
use crate::element::{Anchors, HoldPose, Spring, SpringDamper, SpringTuning};
use crate::input::check::{Fault, Parameters};
use crate::input::companions::Companions;
use crate::input::parts::{Acts, IsElement, Parts};
use crate::readout::SpringReadout;
use crate::settings::{CoiloverSettings, MAX_ITERATIONS, MAX_MICROSTEPS, MAX_SUBSTEPS};
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::ecs::system::SystemParam;
use bevy::math::{DVec3, Quat};
use bevy::prelude::*;
use engine::{Brick, Only, Own};

/// Finds ends, which are bricks or points of the world.
#[derive(SystemParam)]
struct Ends<'w, 's> {
    bricks: Query<'w, 's, &'static Brick>,
    points: Query<'w, 's, &'static Transform>,
}

impl Finder for Ends<'_, '_> {
    fn place(
        &self,
        entity: Entity,
        anchor: Vec3,
        _: &'static str,
        _: &mut Option<Vec3>,
    ) -> Result<Place, Fault> {
        Ok(match self.bricks.get(entity) {
            Ok(brick) => Place::OnBody {
                entity,
                body: BodyId {
                    index: brick.index,
                    generation: 0,
                },
                context: Entity::PLACEHOLDER,
                local: anchor.as_dvec3(),
            },
            Err(_) => {
                let point = self.points.get(entity);
                Place::Point(point.map_or(DVec3::ZERO, |at| at.translation.as_dvec3()))
            }
        })
    }

    fn find(
        &mut self,
        p: &Parameters,
        _: Guide,
        scales: &mut [Option<Vec3>; 2],
        _: &EntityHashSet,
    ) -> Result<Found, Fault> {
        let Parameters { ties, .. } = p;
        let [a, b] = scales;
        let places = [
            self.place(ties.ends[0], ties.anchors[0], "", a)?,
            self.place(ties.ends[1], ties.anchors[1], "", b)?,
        ];
        let movable = places.map(|place| match place {
            Place::OnBody { body, local, .. } => Some(Movable {
                turns: local != DVec3::ZERO,
                center: Vec3::ZERO,
                rank: u64::from(body.index),
            }),
            Place::Point(_) => None,
        });
        Ok(Found { places, movable })
    }

    fn tune(
        &self,
        _: SpringTuning,
        _: &Stance,
        _: Allowance,
        _: &mut Parameters,
    ) -> Result<bool, Fault> {
        Err(Fault::new("SpringTuning", "is not known here"))
    }

    fn pose(&self, _: HoldPose, _: &Stance) -> Result<[f64; 2], Fault> {
        Err(Fault::new("HoldPose", "is not known here"))
    }
}

/// A world with the test engine.
struct Lab {
    world: World,
    engine: Own,
    settings: CoiloverSettings,
    spare: Spare,
}

impl Lab {
    fn new(gravity: Vec3, substeps: usize, microsteps: u32) -> Self {
        let mut world = World::new();
        world.init_resource::<Scene>();
        Self {
            world,
            engine: Own {
                bricks: Vec::new(),
                gravity,
                substeps,
            },
            settings: CoiloverSettings {
                microsteps,
                resolve: 1,
                extrapolation: false,
                tolerance: None,
                max_microsteps: MAX_MICROSTEPS,
                max_iterations: MAX_ITERATIONS,
                max_substeps: MAX_SUBSTEPS,
                schedule: FixedUpdate.intern(),
            },
            spare: Spare::default(),
        }
    }

    fn brick(&mut self, mass: f32, inertia: Vec3, at: Vec3) -> Entity {
        let brick = Brick {
            index: self.engine.bricks.len() as u32,
            mass,
            inertia,
            at,
            rotation: Quat::IDENTITY,
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            wrench: Wrench::default(),
        };
        self.engine.bricks.push(brick);
        self.world.spawn(brick).id()
    }

    /// Makes all rows. It runs only before the first tick, because nothing appears or disappears in these tests.
    fn find(&mut self) {
        let find = |mut scene: ResMut<Scene>,
                    elements: Query<Parts, Acts>,
                    companions: Companions,
                    mut ends: Ends,
                    mut commands: Commands| {
            let none = EntityHashSet::default();
            scene.renew(&elements, &companions, &mut ends, &none, &mut commands);
        };
        self.world.run_system_cached(find).expect("a system");
    }

    /// One step: read, solve, write, step the engine, observe, show.
    fn tick(&mut self) {
        let Self {
            world,
            engine,
            settings,
            spare,
        } = self;
        world.resource_scope(|_, mut scene: Mut<Scene>| {
            scene.begin();
            let plan = engine.plan();
            scene.time = plan.time;
            let step = Step::new(plan, settings, false, scene.tick);
            scene.step_free(Entity::PLACEHOLDER, &step, engine, spare);
            engine.step();
            scene.observe(&Only(engine));
        });
        let show = |mut scene: ResMut<Scene>,
                    mut readouts: Readouts,
                    mut springs: Query<Springs, IsElement>,
                    mut commands: Commands| {
            scene.show(&mut readouts, &mut springs, &mut commands);
        };
        world.run_system_cached(show).expect("a system");
    }

    /// Steps `ticks` times and compares bricks with a reference that has four rows per tick. `at` has the index of each brick,
    /// and the columns of its coordinates. Returns the greatest distance of a brick from the reference, m.
    fn follow(&mut self, rows: &str, ticks: usize, at: &[(usize, [Option<usize>; 3])]) -> f64 {
        self.find();
        let mut worst = 0.0_f64;
        for line in rows.lines().skip(2).step_by(4).skip(1).take(ticks) {
            let row: Vec<f64> = line
                .split(',')
                .map(|x| x.parse().expect("a number"))
                .collect();
            self.tick();
            for (index, columns) in at {
                let wanted = columns.map(|column| column.map_or(0.0, |column| row[column]));
                let is = self.engine.bricks[*index].at.as_dvec3();
                worst = worst.max(is.distance(DVec3::from(wanted)));
            }
        }
        worst
    }
}

#[test]
fn an_elastic_pendulum_swings_in_any_engine_as_in_rapier() {
    let text = include_str!("../../../tests/data/pendulum_k50.csv");
    for substeps in [2, 4, 7] {
        let mut lab = Lab::new(Vec3::NEG_Y * 9.81, substeps, 16);
        let hook = lab.world.spawn(Transform::IDENTITY).id();
        let ball = lab.brick(1.0, Vec3::ONE, Vec3::X);
        let spring = Spring::new(hook, ball)
            .with_stiffness(50.0)
            .with_rest_length(1.0);
        let spring = lab.world.spawn(spring).id();
        let worst = lab.follow(text, 600, &[(0, [Some(1), Some(2), None])]);
        // `elastic_pendulum` has the same limit for Rapier.
        assert!(worst < 5e-5, "{substeps} substeps: {worst} m");
        let readout = lab.world.get::<SpringReadout>(spring).expect("it is shown");
        let length = lab.engine.bricks[0].at.length();
        assert!((readout.length - length).abs() < 1e-6, "{readout:?}");
    }
}

#[test]
fn a_chain_swings_in_any_engine_as_in_rapier() {
    let text = include_str!("../../../tests/data/chain10_k100_c0.5.csv");
    let mut lab = Lab::new(Vec3::NEG_Y * 9.81, 4, 1);
    let mut last = lab.world.spawn(Transform::IDENTITY).id();
    for i in 1..=10 {
        let next = lab.brick(0.1, Vec3::ONE, Vec3::X * 0.2 * i as f32);
        let spring = SpringDamper::new(last, next)
            .with_stiffness(100.0)
            .with_damping(0.5);
        lab.world.spawn(spring.with_rest_length(0.2));
        last = next;
    }
    let at = [(4, [Some(1), Some(2), None]), (9, [Some(3), Some(4), None])];
    let worst = lab.follow(text, 60, &at);
    assert!(worst < 3.5e-3, "{worst} m");
}

#[test]
fn a_dumbbell_tumbles_in_any_engine_as_in_rapier() {
    let text = include_str!("../../../compare/data/dumbbell.csv");
    for (microsteps, bar) in [(1, 1.5e-3), (4, 1e-4), (16, 1e-5)] {
        let mut lab = Lab::new(Vec3::ZERO, 4, microsteps);
        let a = lab.brick(2.0, Vec3::new(0.2, 0.3, 0.45), Vec3::ZERO);
        let b = lab.brick(0.5, Vec3::new(0.02, 0.05, 0.06), Vec3::new(2.0, 0.3, -0.1));
        let [first, second] = &mut lab.engine.bricks[..] else {
            panic!("two bricks")
        };
        (first.velocity, first.spin) = (Vec3::new(0.0, -0.25, -0.125), Vec3::new(1.0, -2.0, 0.5));
        (second.velocity, second.spin) = (Vec3::new(0.0, 1.0, 0.5), Vec3::new(-1.0, 0.5, 3.0));
        lab.world.spawn((
            Spring::new(a, b).with_stiffness(20.0).with_rest_length(1.0),
            Anchors::new(Vec3::new(0.4, 0.2, 0.1), Vec3::new(-0.3, 0.1, 0.2)),
        ));
        let at = [
            (0, [Some(1), Some(2), Some(3)]),
            (1, [Some(4), Some(5), Some(6)]),
        ];
        let worst = lab.follow(text, 180, &at);
        // With one micro-step, the error is the same as with Rapier: see the report.
        assert!(worst < bar, "{microsteps} micro-steps: {worst} m");
    }
}
