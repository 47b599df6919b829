//! A scene that is played and watched, tick by tick, to the last bit.

use crate::harness::*;
use bevy::ecs::entity::{EntityHashMap, EntityMapper};
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::plugin::systems;
use bevy_rapier3d::prelude::*;

/// A lab whose entities are known by the order in which they were spawned: the key that is the same in every app.
pub struct Film {
    pub lab: Lab,
    pub cast: Vec<Entity>,
    pub tick: usize,
    /// What the game does before each tick.
    pub deed: fn(&mut Film),
}

thread_local! {
    /// The plugin that draws springs is there.
    pub static DRAWN: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
    /// Rapier hears of each body, collider and joint as it is spawned. Else it hears of them in the order of Bevy's archetypes, and
    /// that depends on what else an app has.
    pub static IN_ORDER: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
    /// Entities that an app has before its scene is made, so that those of the scene have other ids.
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

    /// Runs and notes everything after each tick.
    pub fn watch(&mut self, ticks: usize) -> Vec<Vec<u32>> {
        let mut seen = Vec::new();
        for _ in 0..ticks {
            self.run(1);
            seen.push(self.bits());
        }
        seen
    }

    /// Everything that a game sees of every entity.
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
        // That of an element is where its coil is drawn.
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

    /// Whether every place is a number.
    pub fn is_sound(&self) -> bool {
        let places = self.cast.iter().filter_map(|e| {
            let entity = self.lab.app.world().get_entity(*e).ok()?;
            entity.get::<Transform>().map(|at| at.translation)
        });
        places.into_iter().all(|at| at.is_finite())
    }
}

/// Room for the words of an entity.
const WORDS: usize = 16 * 16;

/// Rapier's state and that of springs.
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

/// Fails with the first tick and entity where two runs differ.
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

/// What the game itself has to put back of elements, and of ends that are no bodies.
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

    /// Puts all of it back, under these names.
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

/// Lets Rapier hear of an entity at once.
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
