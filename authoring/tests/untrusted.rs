//! Fuzz test with components as serde, scenes and remote calls may deliver them: numbers, lists and names can be anything.
//! Each must end as a fault or as a moving element, never as a panic, a hang or a NaN.
//!
//! `COILOVER_FUZZ_SECONDS=60 cargo test --workspace --test authoring untrusted` runs for a minute. Without the variable it
//! runs for a few seconds.

use crate::data::all;
use crate::harness::*;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::prelude::*;
use bevy::reflect::{ReflectMut, TypeRegistry};
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::{Duration, Instant};

/// Number of elements that exist at the same time.
const AT_ONCE: usize = 20;

const NUMBERS: [f32; 16] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-45,
    0.0,
    -0.0,
    -1.0,
    1e9,
    -1e9,
    1e20,
    1e-20,
    0.5,
];

/// Pseudorandom numbers, reproducible from a seed (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    fn one_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    fn number(&mut self) -> f32 {
        match self.below(4) {
            0 => f32::from_bits(self.next() as u32),
            1 => (self.below(2001) as f32 - 1000.0) / 100.0,
            _ => NUMBERS[self.below(NUMBERS.len())],
        }
    }

    fn name(&mut self) -> String {
        match self.below(4) {
            0 => String::new(),
            1 => "\u{202e}\0\n\u{1f300}".into(),
            2 if self.one_in(50) => "a".repeat(1 << 20),
            _ => "Hook".into(),
        }
    }
}

/// Randomly changes numbers, names, flags and lists at any depth of a value.
fn spoil(value: &mut dyn PartialReflect, random: &mut Random) {
    match value.reflect_mut() {
        ReflectMut::Struct(fields) => {
            for i in 0..fields.field_len() {
                fields
                    .field_at_mut(i)
                    .into_iter()
                    .for_each(|f| spoil(f, random));
            }
        }
        ReflectMut::TupleStruct(fields) => {
            for i in 0..fields.field_len() {
                fields
                    .field_mut(i)
                    .into_iter()
                    .for_each(|f| spoil(f, random));
            }
        }
        ReflectMut::Tuple(fields) => {
            for i in 0..fields.field_len() {
                fields
                    .field_mut(i)
                    .into_iter()
                    .for_each(|f| spoil(f, random));
            }
        }
        ReflectMut::Enum(fields) => {
            for i in 0..fields.field_len() {
                fields
                    .field_at_mut(i)
                    .into_iter()
                    .for_each(|f| spoil(f, random));
            }
        }
        ReflectMut::List(list) => {
            match random.below(8) {
                0 => drop(list.drain()),
                1 => {
                    // A valid table with rising points, of which the loop below spoils some.
                    let count = if random.one_in(20) { 1_000_000 } else { 1000 };
                    for i in 0..count {
                        let i = i as f32 + 10.0;
                        list.push(Box::new(Vec2::new(i, i)));
                    }
                }
                _ => {}
            }
            for _ in 0..random.below(4) {
                if !list.is_empty() {
                    let place = random.below(list.len());
                    list.get_mut(place)
                        .into_iter()
                        .for_each(|f| spoil(f, random));
                }
            }
        }
        _ => {
            if !random.one_in(3) {
                return;
            }
            if let Some(number) = value.try_downcast_mut::<f32>() {
                *number = random.number();
            } else if let Some(number) = value.try_downcast_mut::<u32>() {
                *number = [0, 1, 1_000_000_000, u32::MAX][random.below(4)];
            } else if let Some(name) = value.try_downcast_mut::<String>() {
                *name = random.name();
            } else if let Some(flag) = value.try_downcast_mut::<bool>() {
                *flag = random.one_in(2);
            }
        }
    }
}

/// Sets the ends of an element. Returns false if the value is not an element.
fn tie(value: &mut dyn PartialReflect, ends: [Entity; 2]) -> bool {
    let ReflectMut::Struct(fields) = value.reflect_mut() else {
        return false;
    };
    for (name, end) in ["body_a", "body_b"].into_iter().zip(ends) {
        let Some(field) = fields.field_mut(name) else {
            return false;
        };
        field.apply(&end);
    }
    true
}

/// Prints the seed if the test panics.
struct Seed(u64);

impl Drop for Seed {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("with seed {}", self.0);
        }
    }
}

fn spawn(app: &mut App, registry: &TypeRegistry, random: &mut Random) -> Vec<Entity> {
    let x = random.below(100) as f32;
    let weight = (
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(1.0),
        Transform::from_xyz(x, -1.0, 0.2),
        Velocity::default(),
        Name::new("Weight"),
    );
    let hook = (Transform::from_xyz(x, 0.0, 0.0), Name::new("Hook"));
    let world = app.world_mut();
    let ends = [world.spawn(hook).id(), world.spawn(weight).id()];
    let (elements, others): (Vec<_>, Vec<_>) = all()
        .into_iter()
        .map(|mut value| (tie(&mut *value, ends), value))
        .partition(|(element, _)| *element);
    // One of the six elements, and a random choice of its companions.
    let element = elements.into_iter().nth(random.below(6));
    let mut chosen: Vec<_> = element.into_iter().collect();
    chosen.extend(others.into_iter().filter(|_| random.one_in(5)));
    let mut entity = world.spawn(Transform::default());
    for (_, mut value) in chosen {
        spoil(&mut *value, random);
        let name = value.reflect_type_path();
        let found = registry.get_with_type_path(name).expect("registered");
        let component = found.data::<ReflectComponent>().expect("a component");
        component.insert(&mut entity, &*value, registry);
    }
    let entity = entity.id();
    vec![ends[0], ends[1], entity]
}

/// Checks that the transforms and velocities of all bodies, and all readouts, are finite.
fn are_finite(world: &mut World) -> Result<(), String> {
    let mut bodies =
        world.query_filtered::<(Entity, &GlobalTransform, &Velocity), With<RigidBody>>();
    for (entity, at, velocity) in bodies.iter(world) {
        let moves = velocity.linear.is_finite() && velocity.angular.is_finite();
        if !(at.affine().is_finite() && moves) {
            return Err(format!("{entity}: {at:?}, {velocity:?}"));
        }
    }
    let mut readouts = world.query::<(Entity, &SpringReadout)>();
    for (entity, readout) in readouts.iter(world) {
        if !(readout.length.is_finite() && readout.force().is_finite()) {
            return Err(format!("{entity}: {readout:?}"));
        }
    }
    Ok(())
}

#[test]
fn whatever_a_file_says_it_ends_as_a_fault_or_moves() {
    let seconds = std::env::var("COILOVER_FUZZ_SECONDS")
        .ok()
        .and_then(|text| text.parse::<u64>().ok());
    let until = Instant::now() + Duration::from_secs(seconds.unwrap_or(5));
    let mut app = app();
    app.add_plugins((AssetPlugin::default(), CoiloverPlugins));
    app.init_asset::<Mesh>().init_asset::<StandardMaterial>();
    prime(&mut app);
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let mut faults = app.world_mut().query::<&SpringFault>();
    let (mut tried, mut faulty) = (0_u64, 0);
    while Instant::now() < until || tried < 400 {
        let seed = Seed(tried);
        let registry = registry.read();
        let mut random = Random(tried);
        let mut spawned = Vec::new();
        for _ in 0..AT_ONCE {
            spawned.extend(spawn(&mut app, &registry, &mut random));
            tried += 1;
        }
        drop(registry);
        for _ in 0..4 {
            app.update();
            if let Err(wrong) = are_finite(app.world_mut()) {
                panic!("{wrong}");
            }
        }
        faulty += faults.iter(app.world()).count();
        for entity in spawned {
            app.world_mut().despawn(entity);
        }
        app.update();
        drop(seed);
    }
    println!("{tried} elements, {faulty} with a fault");
    assert!(faulty > 0 && (faulty as u64) < tried);
}
