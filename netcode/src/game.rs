//! A small game in which each player moves a lift up and down. It has every state that springs keep between ticks.

use crate::rollback::{RollbackPhysicsPlugin, Tick};
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_ggrs::ggrs::{Config, SyncTestSession};
use bevy_ggrs::{
    ChecksumPart, GgrsConfig, GgrsPlugin, GgrsSchedule, LocalInputs, LocalPlayers, PlayerInputs,
    ReadInputs, Rollback, RollbackApp, RollbackFrameCount, RollbackFrameRate, SaveWorld,
    SaveWorldSystems, Session, SyncTestMismatch, checksum_hasher,
};
use bevy_rapier3d::prelude::*;
use std::collections::BTreeMap;
use std::f32::consts::TAU;
use std::hash::{Hash, Hasher};
use std::time::Duration;

/// GGRS configuration, with the inputs that peers send.
pub type Net = GgrsConfig<Pressed>;

/// Buttons of a player: [`UP`], [`DOWN`], both or none.
pub type Pressed = u8;

/// The lift goes up.
pub const UP: Pressed = 1;
/// The lift goes down.
pub const DOWN: Pressed = 2;

/// Frames per second.
pub const RATE: u16 = 60;

/// Speed of a lift, m/s.
const SPEED: f32 = 0.5;

/// The actuator of a lift, and its player.
#[derive(Component, Clone, Copy, Debug)]
pub struct Lift {
    /// Handle of the player.
    pub player: usize,
}

/// An entity that peers compare, in the order of this number, which is the same for all.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Compared(pub u32);

/// Latest checksum of each frame.
#[derive(Resource, Clone, Debug, Default)]
pub struct Seen(pub BTreeMap<i32, u64>);

/// Frames that differed when they were run again.
#[derive(Resource, Clone, Debug, Default)]
pub struct Mismatches(pub Vec<SyncTestMismatch>);

/// Entity with the checksum of all compared entities.
#[derive(Resource)]
struct Sum(Entity);

/// Makes an app of the game that runs one frame per update.
pub fn app(session: Session<Net>, physics: RollbackPhysicsPlugin) -> App {
    let mut app = App::new();
    let frame = Duration::from_secs(1) / u32::from(RATE);
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(frame))
        .add_plugins((GgrsPlugin::<Net>::default(), physics))
        .insert_resource(RollbackFrameRate(usize::from(RATE)))
        .insert_resource(session)
        .init_resource::<Seen>()
        .init_resource::<Mismatches>()
        // Inputs write this component.
        .rollback_component_with_clone::<SpringDamper>()
        .add_systems(Startup, spawn)
        .add_systems(ReadInputs, read_inputs)
        .add_systems(GgrsSchedule, drive.before(Tick))
        .add_systems(SaveWorld, compare.in_set(SaveWorldSystems::Checksum))
        .add_observer(
            |mismatch: On<SyncTestMismatch>, mut all: ResMut<Mismatches>| {
                all.0.push(mismatch.event().clone());
            },
        );
    let sum = app.world_mut().spawn(ChecksumPart::default()).id();
    app.insert_resource(Sum(sum));
    app.finish();
    app.cleanup();
    // Waking worker threads costs more than these systems take.
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    app
}

/// Buttons of a player in a frame. They change now and then, and depend on nothing else, so that runs repeat.
pub fn press(frame: i32, player: usize) -> Pressed {
    let mut hasher = checksum_hasher();
    (frame / 9, player).hash(&mut hasher);
    (hasher.finish() >> 17) as Pressed & (UP | DOWN)
}

fn read_inputs(mut commands: Commands, players: Res<LocalPlayers>, frame: Res<RollbackFrameCount>) {
    let inputs: HashMap<_, _> = players
        .0
        .iter()
        .map(|player| (*player, press(frame.0, *player)))
        .collect();
    commands.insert_resource(LocalInputs::<Net>(inputs));
}

fn drive(inputs: Res<PlayerInputs<Net>>, mut lifts: Query<(&Lift, &mut SpringDamper)>) {
    for (lift, mut actuator) in &mut lifts {
        let Some((pressed, _)) = inputs.get(lift.player) else {
            continue;
        };
        let step = SPEED / f32::from(RATE);
        let step = match *pressed {
            UP => step,
            DOWN => -step,
            _ => continue,
        };
        let next = actuator.rest_length.map(|now| (now + step).clamp(0.6, 1.4));
        if actuator.rest_length != next {
            actuator.rest_length = next;
        }
    }
}

fn compare(world: &mut World) {
    let mut all = world.query::<(
        &Compared,
        Option<&Transform>,
        Option<&Velocity>,
        Option<&SpringReadout>,
    )>();
    let mut all: Vec<_> = all.iter(world).collect();
    all.sort_by_key(|(number, ..)| **number);
    let mut hasher = checksum_hasher();
    for (number, place, velocity, seen) in all {
        number.0.hash(&mut hasher);
        let mut numbers = Vec::new();
        if let Some(place) = place {
            numbers.extend(place.translation.to_array());
            numbers.extend(place.rotation.to_array());
        }
        if let Some(velocity) = velocity {
            numbers.extend(velocity.linear.to_array());
            numbers.extend(velocity.angular.to_array());
        }
        if let Some(seen) = seen {
            numbers.extend([seen.length, seen.rate, seen.spring_force]);
            numbers.push(seen.dissipated_energy);
        }
        numbers
            .iter()
            .for_each(|number| number.to_bits().hash(&mut hasher));
    }
    let sum = hasher.finish();
    let frame = world.resource::<RollbackFrameCount>().0;
    world.resource_mut::<Seen>().0.insert(frame, sum);
    let part = world.resource::<Sum>().0;
    if let Some(mut part) = world.get_mut::<ChecksumPart>(part) {
        part.0 = u128::from(sum);
    }
}

/// A dynamic box.
fn cube(size: f32, mass: f32, at: Vec3) -> impl Bundle {
    (
        RigidBody::Dynamic,
        Transform::from_translation(at),
        Collider::cuboid(size / 2.0, size / 2.0, size / 2.0),
        ColliderMassProperties::Mass(mass),
        Velocity::default(),
        Sleeping::default(),
        Friction::new(0.8),
    )
}

fn spawn(mut commands: Commands) {
    let mut numbers = (0..).map(Compared);
    let mut compared = move || numbers.next().unwrap_or(Compared(u32::MAX));
    if let Some(ground) = Collider::halfspace(Vec3::Y) {
        commands.spawn((ground, Friction::new(0.8), Transform::default()));
    }
    let mut lifts = Vec::new();
    for player in 0..2 {
        let x = 4.0 * player as f32;
        let base = (RigidBody::Fixed, Transform::from_xyz(x, 0.2, 0.0));
        let base = commands.spawn(base).id();
        let at = Vec3::new(x, 1.2, 0.0);
        let lift = (cube(0.6, 20.0, at), LockedAxes::ROTATION_LOCKED, compared());
        let lift = commands.spawn(lift).id();
        let actuator = SpringDamper::new(base, lift)
            .with_stiffness(8e3)
            .with_damping(300.0)
            .with_rest_length(1.0);
        commands.spawn((
            actuator,
            MaxForce(2e3),
            Lift { player },
            Rollback,
            compared(),
        ));
        // A box that the lift tosses.
        commands.spawn((cube(0.3, 2.0, at + Vec3::new(0.05, 0.6, 0.02)), compared()));
        lifts.push(lift);
    }
    // A chain from lift to lift.
    let mut last = lifts[0];
    for i in 1..=5 {
        let link = match i {
            5 => lifts[1],
            _ => {
                let at = Vec3::new(0.8 * i as f32, 1.2, 0.0);
                commands.spawn((cube(0.1, 0.5, at), compared())).id()
            }
        };
        let rope = SpringDamper::new(last, link)
            .with_stiffness(2e3)
            .with_damping(2.0)
            .with_rest_length(0.7);
        commands.spawn((rope, SpringAction::Pull, compared()));
        last = link;
    }
    // A flywheel on a hinge that winds up a torsion spring by more than full turns.
    let frame = (RigidBody::Fixed, Transform::from_xyz(2.0, 3.0, 3.0));
    let frame = commands.spawn(frame).id();
    let hinge = ImpulseJoint::new(frame, RevoluteJointBuilder::new(Vec3::X));
    let wheel = (cube(0.4, 2.0, Vec3::new(2.0, 3.0, 3.0)), hinge, compared());
    let mut wheel = commands.spawn(wheel);
    // Replaces the velocity of the cube.
    wheel.insert(Velocity::angular(Vec3::X * 3.0 * TAU));
    let wheel = wheel.id();
    let torsion = TorsionSpringDamper::new(frame, wheel, Vec3::X)
        .with_stiffness(0.05)
        .with_damping(1e-5);
    commands.spawn((torsion, compared()));
    // A weight that swings freely, and one that falls asleep.
    for (x, damping) in [(-2.0, 0.01), (-4.0, 20.0)] {
        let hook = commands.spawn(Transform::from_xyz(x, 3.0, 0.0)).id();
        let weight = (cube(0.2, 1.0, Vec3::new(x, 2.0, 0.3)), compared());
        let weight = commands.spawn(weight).id();
        let spring = SpringDamper::new(hook, weight)
            .with_stiffness(60.0)
            .with_damping(damping);
        commands.spawn((spring, compared()));
    }
}

/// A session that goes back by `distance` frames in every frame, and compares.
pub fn sync_test(
    distance: usize,
) -> std::result::Result<SyncTestSession<Net>, bevy_ggrs::ggrs::GgrsError> {
    let mut builder = bevy_ggrs::ggrs::SessionBuilder::<Net>::new()
        .with_num_players(2)?
        .with_max_prediction_window(distance + 1)
        .with_check_distance(distance)
        .with_input_delay(2);
    for player in 0..2 {
        builder = builder.add_player(bevy_ggrs::ggrs::PlayerType::Local, player)?;
    }
    builder.start_synctest_session()
}

/// The address of a peer.
pub type Address = <Net as Config>::Address;
