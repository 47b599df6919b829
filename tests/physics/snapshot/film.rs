//! A scene whose complete state is recorded bit by bit after each tick.

use crate::harness::*;
use bevy::ecs::entity::{EntityHashMap, EntityMapper};
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::plugin::systems;
use bevy_rapier3d::prelude::*;

/// A lab that lists its entities in the order in which they were spawned. This order is equal in every app.
pub struct Film {
    pub lab: Lab,
    pub cast: Vec<Entity>,
    pub tick: usize,
    /// The game's code, called before each tick.
    pub deed: fn(&mut Film),
}

thread_local! {
    /// Whether new scenes get the plugin that draws springs.
    pub static DRAWN: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
    /// Whether Rapier gets each body, collider and joint as it is spawned. Otherwise it gets them in the order of Bevy's
    /// archetypes, which depends on what else an app has.
    pub static IN_ORDER: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
    /// Number of entities that an app gets before its scene, so that the scene's entities have other ids.
    pub static STRANGERS: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

impl Film {
    pub fn new(plugin: CoiloverPlugin) -> Self {
        let mut lab = Lab::without_plugin(Engine::default());
        lab.app.add_plugins(plugin);
        #[cfg(feature = "visual")]
        if DRAWN.get() {
            lab.app
                .add_plugins((AssetPlugin::default(), CoiloverVisualPlugin))
                .init_asset::<Mesh>()
                .init_asset::<StandardMaterial>();
        }
        lab.prime();
        STRANGERS.with(|count| {
            for _ in 0..count.get() {
                lab.spawn(());
            }
        });
        Self {
            lab,
            cast: Vec::new(),
            tick: 0,
            deed: |_| {},
        }
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        let entity = self.lab.spawn(bundle);
        self.cast.push(entity);
        if IN_ORDER.get() {
            introduce(self.lab.app.world_mut(), entity);
        }
        entity
    }

    pub fn run(&mut self, ticks: usize) {
        for _ in 0..ticks {
            (self.deed)(self);
            self.lab.tick();
            self.tick += 1;
        }
    }

    /// Runs and records the bits after each tick.
    pub fn watch(&mut self, ticks: usize) -> Vec<Vec<u32>> {
        let mut seen = Vec::new();
        for _ in 0..ticks {
            self.run(1);
            seen.push(self.bits());
        }
        seen
    }

    /// Bits of every component value of the listed entities that a game can see.
    pub fn bits(&self) -> Vec<u32> {
        let mut bits = Vec::new();
        for entity in &self.cast {
            let before = bits.len();
            self.bits_of(*entity, &mut bits);
            bits.resize(before + WORDS, 0);
        }
        bits
    }

    fn bits_of(&self, entity: Entity, bits: &mut Vec<u32>) {
        let Ok(entity) = self.lab.app.world().get_entity(entity) else {
            return;
        };
        let mut add = |numbers: &[f32]| {
            bits.resize(bits.len().next_multiple_of(16), 0);
            bits.extend(numbers.iter().map(|x| x.to_bits()));
        };
        // The transform of an element only says where its coil is drawn.
        let place = entity.get::<Transform>();
        if let Some(place) = place.filter(|_| !entity.contains::<SpringReadout>()) {
            add(&place.translation.to_array());
            add(&place.rotation.to_array());
        }
        if let Some(velocity) = entity.get::<Velocity>() {
            add(&velocity.linear.to_array());
            add(&velocity.angular.to_array());
        }
        if let Some(sleeping) = entity.get::<Sleeping>() {
            add(&[f32::from(u8::from(sleeping.sleeping))]);
        }
        if let Some(load) = entity.get::<SpringLoad>() {
            for force in [load.elements, load.user] {
                add(&force.force.to_array());
                add(&force.torque.to_array());
            }
        }
        if let Some(force) = entity.get::<ExternalForce>() {
            add(&force.force.to_array());
            add(&force.torque.to_array());
        }
        if let Some(seen) = entity.get::<SpringReadout>() {
            add(&[
                seen.length,
                seen.rate,
                seen.spring_force,
                seen.damper_force,
                seen.stored_energy,
                seen.dissipated_power,
                seen.dissipated_energy,
                seen.work,
                seen.omega_dt,
                seen.effective_mass,
                seen.method as u8 as f32,
                seen.microsteps as f32,
                seen.error,
                f32::from(u8::from(seen.capped)),
            ]);
        }
    }

    /// Whether every position is finite.
    pub fn is_sound(&self) -> bool {
        let places = self.cast.iter().filter_map(|e| {
            let entity = self.lab.app.world().get_entity(*e).ok()?;
            entity.get::<Transform>().map(|at| at.translation)
        });
        places.into_iter().all(|at| at.is_finite())
    }
}

/// Words reserved for an entity.
const WORDS: usize = 16 * 16;

/// Snapshots of Rapier and of the springs.
#[derive(Clone)]
pub struct Both {
    pub engine: RapierSnapshot,
    pub springs: CoiloverSnapshot,
}

impl Both {
    pub fn take(film: &Film) -> Self {
        let world = film.lab.app.world();
        Self {
            engine: RapierSnapshot::take(world),
            springs: CoiloverSnapshot::take(world),
        }
    }

    pub fn restore(&self, film: &mut Film) {
        let world = film.lab.app.world_mut();
        self.engine.restore(world).expect("Rapier's side fits");
        self.springs.restore(world).expect("the springs' side fits");
    }
}

/// Panics with the first tick and entity at which two runs differ.
pub fn assert_same(name: &str, first: &[Vec<u32>], second: &[Vec<u32>]) {
    for (tick, (a, b)) in first.iter().zip(second).enumerate() {
        if a != b {
            let word = a.iter().zip(b).position(|(a, b)| a != b).unwrap_or(0);
            let (entity, word) = (word / WORDS, word % WORDS);
            panic!(
                "{name}: tick {} after the snapshot, entity {entity}, field {}.{}: {} is not {}",
                tick + 1,
                word / 16,
                word % 16,
                f32::from_bits(b[entity * WORDS + word]),
                f32::from_bits(a[entity * WORDS + word]),
            );
        }
    }
}

/// Components that the game itself has to restore: elements, and transforms of ends without a body.
pub struct Props(Vec<Option<Prop>>);

type Elements = (
    Option<SpringDamper>,
    Option<Spring>,
    Option<Damper>,
    Option<TorsionSpringDamper>,
    Option<TorsionSpring>,
);

#[derive(Clone)]
struct Prop {
    element: Elements,
    beside: (Option<Preload>, Option<SpringTuning>, Option<HoldPose>),
    place: Option<Transform>,
}

impl Props {
    pub fn take(film: &Film) -> Self {
        let of = |entity: &Entity| {
            let entity = film.lab.app.world().get_entity(*entity).ok()?;
            Some(Prop {
                element: (
                    entity.get().copied(),
                    entity.get().copied(),
                    entity.get().copied(),
                    entity.get().copied(),
                    entity.get().copied(),
                ),
                beside: (
                    entity.get().copied(),
                    entity.get().copied(),
                    entity.get().copied(),
                ),
                place: entity
                    .get()
                    .copied()
                    .filter(|_| !entity.contains::<RigidBody>()),
            })
        };
        Self(film.cast.iter().map(of).collect())
    }

    /// Restores all components, with entities mapped by `names`.
    pub fn restore(&self, film: &mut Film, names: &EntityHashMap<Entity>) {
        let mut names = names.clone();
        for (entity, prop) in film.cast.clone().into_iter().zip(&self.0) {
            let world = film.lab.app.world_mut();
            let Some(prop) = prop else {
                world.despawn(entity);
                continue;
            };
            let mut entity = world.entity_mut(entity);
            macro_rules! put {
                ($($field:tt),*) => {$(
                    if let Some(mut element) = prop.element.$field {
                        element.body_a = names.get_mapped(element.body_a);
                        element.body_b = names.get_mapped(element.body_b);
                        entity.insert(element);
                    }
                )*};
            }
            put!(0, 1, 2, 3, 4);
            let (preload, tuning, pose) = prop.beside;
            if let Some(preload) = preload {
                entity.insert(preload);
            }
            if tuning.is_none() {
                entity.remove::<SpringTuning>();
            }
            if pose.is_none() {
                entity.remove::<HoldPose>();
            }
            if let Some(place) = prop.place {
                entity.insert(place);
            }
        }
    }
}

/// Runs Rapier's systems that create the body, collider or joint of a new entity.
fn introduce(world: &mut World, entity: Entity) {
    let find = move |transforms: TransformHelper| transforms.compute_global_transform(entity).ok();
    if let Ok(Some(at)) = world.run_system_once(find) {
        world.entity_mut(entity).insert(at);
    }
    let heard = [
        world.run_system_cached(systems::init_rigid_bodies),
        world.run_system_cached(systems::init_colliders),
        world.run_system_cached(systems::init_joints),
    ];
    assert!(heard.iter().all(Result::is_ok), "{heard:?}");
}
