//! Scenes of many springs, and a clock around our own systems.

mod bridge;
mod road;

use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::{Duration, Instant};

/// What joins two bodies.
#[derive(Clone, Copy, Debug)]
pub enum Link {
    /// Nothing: each body flies freely at its own velocity.
    Nothing,
    /// A spring of this crate.
    Ours,
    /// A spring of this crate, with force laws.
    Laws,
    /// A spring of this crate, anchored off the centres of the bodies, so that it turns them.
    Turning,
    /// Rapier's `SpringJoint`.
    Joint,
    /// Only Hooke's law as a force: reads two bodies and writes two bodies, directly in the engine.
    Bare,
}

/// Pairs of bodies that [`Link::Bare`] joins.
#[derive(Resource, Default)]
struct Bare(Vec<[Entity; 2]>);

/// Does the least that any spring has to do.
fn pull(
    pairs: Res<Bare>,
    handles: Query<&RapierRigidBodyHandle>,
    mut sets: Query<&mut RapierRigidBodySet>,
) {
    let Ok(mut set) = sets.single_mut() else {
        return;
    };
    if pairs.0.is_empty() {
        // Does not access the engine's bodies without need.
        return;
    }
    let set = &mut set.bodies;
    for pair in &pairs.0 {
        let [Ok(a), Ok(b)] = pair.map(|body| handles.get(body).map(|handle| handle.0)) else {
            continue;
        };
        let (Some(from), Some(to)) = (set.get(a), set.get(b)) else {
            continue;
        };
        let d = to.translation() - from.translation();
        let along = d.normalize_or_zero();
        let rate = (to.linvel() - from.linvel()).dot(along);
        let force = (40.0 * (d.length() - 1.0) + 0.1 * rate) * along;
        for (handle, force) in [(a, force), (b, -force)] {
            if let Some(body) = set.get_mut(handle) {
                body.reset_forces(false);
                body.add_force(force, true);
            }
        }
    }
}

/// The arrangement of springs.
#[derive(Clone, Copy, Debug)]
pub enum Scene {
    /// Separate pairs, oscillating along their line and across it.
    Isolated,
    /// Separate pairs at rest, asleep.
    Asleep,
    /// Separate pairs asleep, and one body that keeps flying.
    AllButOne,
    /// One long chain, hung at both ends.
    Chain,
    /// A cubic lattice with springs along its edges.
    Lattice,
    /// A flat square lattice, with fewer springs for each body.
    Cloth,
    /// A rope bridge of planks that turn, two springs in each gap.
    Bridge,
    /// Many chassis, each on four springs at its corners, with a wheel below each spring.
    Cars,
    /// Cars of five bodies that roll on a road, `count` of them.
    Rolling,
    /// Cars of five bodies that stand on a road, asleep, `count` of them.
    Parked,
}

/// The entity spawned last, which is the next to be despawned.
#[derive(Resource)]
struct Last(Entity);

fn replace(world: &mut World, new: Entity) {
    if let Some(last) = world.remove_resource::<Last>() {
        world.despawn(last.0);
    }
    world.insert_resource(Last(new));
}

/// Spawns a body, and despawns the one of the last call.
pub fn shoot(world: &mut World) {
    let new = body(world, Vec3::NEG_Y * 10.0, Vec3::NEG_Y);
    replace(world, new);
}

/// Spawns a spring between two points of the world, and despawns the one of the last call.
pub fn respring(world: &mut World) {
    let [a, b] = [Vec3::NEG_Y, Vec3::NEG_Z].map(|at| {
        let place = Transform::from_translation(at);
        world.spawn(place).id()
    });
    let new = world.spawn(Spring::new(a, b)).id();
    replace(world, new);
}

/// Time spent in our systems since it was last set to zero.
#[derive(Resource, Default)]
pub struct Own(pub Duration);

#[derive(Resource)]
struct Since(Instant);

fn start(mut since: ResMut<Since>) {
    since.0 = Instant::now();
}

fn stop(since: Res<Since>, mut own: ResMut<Own>) {
    own.0 += since.0.elapsed();
}

impl Scene {
    /// Returns the number of springs that [`Self::app`] makes for about `count`.
    pub fn springs(self, count: u32) -> u32 {
        match self {
            Self::Lattice | Self::Cloth => {
                let [n, deep] = self.bodies_along(count);
                2 * n * (n - 1) * deep + n * n * (deep - 1)
            }
            Self::Bridge => 2 * (count / 2 + 1),
            Self::Rolling | Self::Parked => 4 * count,
            _ => count,
        }
    }

    /// Returns the number of bodies along the two long edges of a lattice, and along the third, for about `count`
    /// springs.
    fn bodies_along(self, count: u32) -> [u32; 2] {
        let count = f64::from(count);
        let along = |edge: f64| (edge.round() as u32 + 1).max(2);
        match self {
            Self::Cloth => [along((count / 2.0).sqrt()), 1],
            _ => [along((count / 3.0).cbrt()); 2],
        }
    }

    /// Returns an app with about `count` springs, without gravity, on bodies without colliders. The simulation has
    /// already run for a while, as in a game.
    pub fn app(self, count: u32, link: Link) -> App {
        self.made(count, link, CoiloverPlugin::default(), false)
    }

    /// Returns the app of [`Self::app`] with a clock around our own systems. Systems run one after the other:
    /// otherwise the clock would count the waking of threads for each system, 0.15 ms on two cores. The
    /// springs themselves use all threads.
    pub fn clocked(self, count: u32, link: Link, plugin: CoiloverPlugin) -> App {
        self.made(count, link, plugin, true)
    }

    fn made(self, count: u32, link: Link, plugin: CoiloverPlugin, clocked: bool) -> App {
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            TransformPlugin,
            RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
            plugin,
        ))
        .insert_resource(TimestepMode::Fixed {
            dt: 1.0 / 60.0,
            substeps: 1,
        })
        .insert_resource(Time::<Fixed>::from_hz(60.0))
        .insert_resource(Since(Instant::now()))
        .init_resource::<Own>()
        .init_resource::<Bare>();
        let before = (
            start
                .after(PhysicsSet::SyncBackend)
                .before(CoiloverSystems::Prepare),
            start
                .after(PhysicsSet::Writeback)
                .before(CoiloverSystems::Readout),
        );
        let after = (
            stop.after(CoiloverSystems::Solve)
                .before(PhysicsSet::StepSimulation),
            stop.after(CoiloverSystems::Readout),
        );
        app.add_systems(FixedUpdate, (before, after));
        if let Link::Bare = link {
            // Elsewhere it would count as ours.
            app.add_systems(FixedUpdate, pull.in_set(CoiloverSystems::Solve));
        }
        if clocked {
            app.edit_schedule(FixedUpdate, |schedule| {
                schedule.set_executor(SingleThreadedExecutor::new());
            });
        }
        let tick = app.world().resource::<Time<Fixed>>().timestep();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(tick));
        app.finish();
        app.cleanup();
        app.update();
        match self {
            Self::Isolated => pairs(app.world_mut(), count, link, true),
            Self::Asleep => pairs(app.world_mut(), count, link, false),
            Self::AllButOne => {
                pairs(app.world_mut(), count, link, false);
                body(app.world_mut(), Vec3::NEG_Y * 10.0, Vec3::NEG_Y);
            }
            Self::Chain => chain(app.world_mut(), count, link),
            Self::Bridge => bridge::bridge(app.world_mut(), count / 2),
            Self::Cars => cars(app.world_mut(), count, link),
            Self::Rolling => road::cars(app.world_mut(), count, link, 3.0),
            Self::Parked => road::cars(app.world_mut(), count, link, 0.0),
            Self::Lattice | Self::Cloth => lattice(app.world_mut(), self.bodies_along(count), link),
        }
        let settle = match self {
            Self::Asleep | Self::AllButOne => 200,
            Self::Parked => 600,
            _ => 20,
        };
        for _ in 0..settle {
            app.update();
        }
        app
    }
}

fn body(world: &mut World, at: Vec3, velocity: Vec3) -> Entity {
    world
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(1.0),
            GravityScale(0.0),
            Velocity::linear(velocity),
            Transform::from_translation(at),
        ))
        .id()
}

/// Gives a body mass and inertia.
fn weigh(world: &mut World, body: Entity, mass: f32, principal_inertia: Vec3) {
    let properties = AdditionalMassProperties::MassProperties(MassProperties {
        mass,
        principal_inertia,
        ..default()
    });
    world.entity_mut(body).insert(properties);
}

fn join(world: &mut World, a: Entity, b: Entity, link: Link) {
    match link {
        Link::Nothing => {}
        Link::Ours => {
            world.spawn(
                SpringDamper::new(a, b)
                    .with_stiffness(40.0)
                    .with_damping(0.1)
                    .with_rest_length(1.0),
            );
        }
        Link::Laws => {
            world.spawn((
                SpringDamper::new(a, b)
                    .with_stiffness(40.0)
                    .with_rest_length(1.0),
                SpringLaw::polynomial(40.0, 0.0, 20.0),
                DampingLaw::sided(0.1, 0.3),
                SpringTravel::new(0.5, 1.5, 4000.0),
            ));
        }
        Link::Turning => {
            world.spawn((
                SpringDamper::new(a, b)
                    .with_stiffness(40.0)
                    .with_damping(0.1)
                    .with_rest_length(0.8),
                Anchors::new(Vec3::new(0.1, 0.05, 0.0), Vec3::new(-0.1, 0.0, 0.05)),
            ));
        }
        Link::Joint => {
            let joint = SpringJointBuilder::new(1.0, 40.0, 0.1);
            world.entity_mut(b).insert(ImpulseJoint::new(a, joint));
        }
        Link::Bare => world.resource_mut::<Bare>().0.push([a, b]),
    }
}

fn pairs(world: &mut World, count: u32, link: Link, moving: bool) {
    for i in 0..count {
        let at = Vec3::new((i % 100) as f32 * 4.0, (i / 100) as f32 * 4.0, 0.0);
        let (stretch, across) = if moving {
            (1.2, Vec3::new(0.0, 0.3, 0.1))
        } else {
            (1.0, Vec3::ZERO)
        };
        let a = body(world, at, across);
        let b = body(world, at + Vec3::X * stretch, -across);
        if let Link::Turning = link {
            for body in [a, b] {
                weigh(world, body, 1.0, Vec3::new(0.02, 0.03, 0.04));
            }
        }
        join(world, a, b, link);
    }
}

fn chain(world: &mut World, count: u32, link: Link) {
    let mut last = world.spawn(Transform::default()).id();
    for i in 1..=count {
        let at = Vec3::X * 1.05 * i as f32;
        let next = if i < count {
            body(world, at, Vec3::Y * (i % 2) as f32 * 0.2)
        } else {
            world.spawn(Transform::from_translation(at)).id()
        };
        join(world, last, next, link);
        last = next;
    }
}

fn cars(world: &mut World, count: u32, link: Link) {
    for i in 0..count / 4 {
        let at = Vec3::new((i % 30) as f32 * 5.0, 0.0, (i / 30) as f32 * 5.0);
        let chassis = body(world, at, Vec3::Y * 0.3);
        weigh(world, chassis, 10.0, Vec3::new(5.0, 8.0, 4.0));
        for corner in [(1.0, 1.5), (1.0, -1.5), (-1.0, 1.5), (-1.0, -1.5)] {
            let corner = Vec3::new(corner.0, 0.0, corner.1);
            let wheel = body(world, at + corner - Vec3::Y * 0.9, Vec3::ZERO);
            if let Link::Joint = link {
                let joint = SpringJointBuilder::new(1.0, 400.0, 2.0).local_anchor1(corner);
                world
                    .entity_mut(wheel)
                    .insert(ImpulseJoint::new(chassis, joint));
            } else if let Link::Ours = link {
                world.spawn((
                    SpringDamper::new(chassis, wheel)
                        .with_stiffness(400.0)
                        .with_damping(2.0)
                        .with_rest_length(1.0),
                    Anchors::new(corner, Vec3::ZERO),
                ));
            }
        }
    }
}

/// Spawns a lattice of `n` × `n` × `deep` bodies.
fn lattice(world: &mut World, [n, deep]: [u32; 2], link: Link) {
    let at = |x: u32, y: u32, z: u32| Vec3::new(x as f32, y as f32, z as f32) * 1.05;
    let all = || (0..n * n * deep).map(|i| (i / deep / n, i / deep % n, i % deep));
    let mut bodies = Vec::new();
    for (x, y, z) in all() {
        let kick = Vec3::Y * ((x + z) % 2) as f32 * 0.2;
        bodies.push(body(world, at(x, y, z), kick));
    }
    let index = |x: u32, y: u32, z: u32| ((x * n + y) * deep + z) as usize;
    for (x, y, z) in all() {
        let here = bodies[index(x, y, z)];
        for (nx, ny, nz) in [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)] {
            if nx < n && ny < n && nz < deep {
                join(world, here, bodies[index(nx, ny, nz)], link);
            }
        }
    }
}
