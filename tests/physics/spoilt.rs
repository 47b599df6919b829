//! Does whatever reflection can write into any component of this crate end in a message, and in no panic, hang or NaN?
//!
//! Scenes, serde and remote calls write the same values. A component that is new in the crate must be added to [`Stage`].

use crate::dice::{Dice, seeds};
use crate::harness::*;
use bevy::asset::AssetPlugin;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::gizmos::GizmoAsset;
use bevy::gizmos::config::GizmoConfigStore;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy::reflect::{PartialReflect, ReflectMut, TypeInfo};
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::collections::BTreeSet;

/// Number of components from which one is picked; a few more than there are.
const COMPONENTS: u32 = 34;

/// Most vertices of all meshes of a scene together.
const MOST_VERTICES: usize = 40_000_000;

fn number(dice: &mut Dice) -> f32 {
    const NUMBERS: [f32; 18] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        0.0,
        -0.0,
        -1.0,
        0.01,
        1.0,
        99.0,
        1e-40,
        1e-12,
        1e9,
        1e12,
        -1e12,
        1e20,
        1e38,
        -1e38,
        f32::MAX,
    ];
    NUMBERS[dice.pick(NUMBERS.len() as u32) as usize]
}

fn table(dice: &mut Dice) -> Vec<Vec2> {
    let count = [0, 1, 2, 50, 1_000_000][dice.pick(5) as usize];
    let step = number(dice);
    let point = |i| Vec2::new(step * (i as f32 - 1.0), i as f32 - 1.0);
    (0..count).map(point).collect()
}

/// Changes one of the numbers, texts and lists inside a value.
fn spoil(value: &mut dyn PartialReflect, dice: &mut Dice) {
    if let Some(x) = value.try_downcast_mut::<f32>() {
        *x = number(dice);
    } else if let Some(x) = value.try_downcast_mut::<Option<f32>>() {
        *x = (dice.next() < 0.8).then(|| number(dice));
    } else if let Some(x) = value.try_downcast_mut::<u32>() {
        *x = u32::MAX;
    } else if let Some(x) = value.try_downcast_mut::<bool>() {
        *x = !*x;
    } else if let Some(text) = value.try_downcast_mut::<String>() {
        *text = "x".repeat(dice.pick(2) as usize * 1_000_000);
    } else if let Some(points) = value.try_downcast_mut::<Vec<Vec2>>() {
        *points = table(dice);
    } else {
        let mut at = |count: usize| dice.pick(count.max(1) as u32) as usize;
        let inner = match value.reflect_mut() {
            ReflectMut::Struct(all) => all.field_at_mut(at(all.field_len())),
            ReflectMut::TupleStruct(all) => all.field_mut(at(all.field_len())),
            ReflectMut::Tuple(all) => all.field_mut(at(all.field_len())),
            ReflectMut::Array(all) => all.get_mut(at(all.len())),
            ReflectMut::Enum(all) => all.field_at_mut(at(all.field_len())),
            _ => None,
        };
        if let Some(inner) = inner {
            spoil(inner, dice);
        }
    }
}

/// A scene with at least one of each component.
struct Stage {
    lab: Lab,
    bodies: Vec<Entity>,
    /// All entities that have components of this crate.
    all: Vec<Entity>,
}

impl Stage {
    fn new() -> Self {
        let mut lab = Lab::without_plugin(Engine::default());
        lab.app
            .add_plugins(AssetPlugin::default())
            .init_asset::<GizmoAsset>()
            .init_resource::<GizmoConfigStore>()
            .add_plugins(CoiloverPlugins)
            .init_asset::<Mesh>()
            .init_asset::<StandardMaterial>();
        lab.prime();
        let mut stage = Self {
            lab,
            bodies: Vec::new(),
            all: Vec::new(),
        };
        stage.fill();
        stage
    }

    /// A point above a body, side by side with the others.
    fn ends(&mut self) -> [Entity; 2] {
        let x = 3.0 * self.bodies.len() as f32;
        let hook = self.lab.point(Vec3::new(x, 2.0, 0.0));
        let body = self.lab.body(1.0, Vec3::new(x, 1.0, 0.2));
        self.bodies.push(body);
        self.all.push(body);
        [hook, body]
    }

    fn add(&mut self, of: impl FnOnce(Entity, Entity) -> Dress) {
        let [a, b] = self.ends();
        let element = self.lab.spawn(());
        of(a, b)(&mut self.lab.app.world_mut().entity_mut(element));
        self.all.push(element);
    }

    fn fill(&mut self) {
        let pair = |a, b| {
            SpringDamper::new(a, b)
                .with_stiffness(50.0)
                .with_damping(2.0)
        };
        let looks = || (Coil::default(), Telescope::default().with_fittings());
        let travel = SpringTravel::new(0.2, 2.0, 500.0);
        self.add(|a, b| with((pair(a, b), looks(), Preload(1.0), travel, MaxForce(90.0))));
        let table = || SpringLaw::table([(-1.0, -50.0), (1.0, 50.0)]);
        let blow_off = DampingLaw::BlowOff {
            damping: 5.0,
            knee: 0.3,
            beyond: 1.0,
        };
        self.add(move |a, b| with((pair(a, b), table(), blow_off, Coil::fitted())));
        let polynomial = SpringLaw::polynomial(50.0, 1.0, 1.0);
        let quadratic = DampingLaw::Quadratic {
            linear: 1.0,
            quadratic: 1.0,
        };
        let axis = SpringAxis::World(Vec3::Y);
        let shows = ShowSpringGizmos(true);
        self.add(move |a, b| with((pair(a, b), polynomial, quadratic, axis, shows)));
        let breaks = Breakable::at_force(1e5).disabling();
        let drag = DampingLaw::table([(-1.0, -5.0), (0.0, 0.0), (1.0, 5.0)]);
        self.add(move |a, b| with((pair(a, b), breaks, drag, SpringAction::Pull, shows)));
        let tuned = SpringTuning::frequency(2.0, 0.3);
        self.add(move |a, b| with((pair(a, b), tuned, HoldPose::new(), shows)));
        let spring = |a, b| Spring::new(a, b).with_stiffness(50.0);
        let points = WorldAnchors::new(Vec3::Y, Vec3::ZERO);
        self.add(move |a, b| {
            with((
                spring(a, b),
                Anchors::default(),
                points,
                Telescope::fitted(),
            ))
        });
        let names = EndNames::new("nobody", "");
        // It waits for its ends, so that what an element applies in its first step stays with it.
        self.add(move |a, b| with((pair(a, b), names, tuned, HoldPose::new(), points)));
        self.add(move |a, b| with(Damper::new(a, b).with_damping(3.0)));
        let axis = Vec3::Z;
        let twist = |a, b| {
            TorsionSpringDamper::new(a, b, axis)
                .with_stiffness(5.0)
                .with_rest_angle(0.3)
        };
        self.add(move |a, b| with((twist(a, b), TorsionCoil::default())));
        let spiral = TorsionCoil::new(0.2, 3.0);
        self.add(move |a, b| with((TorsionSpring::new(a, b, axis).with_stiffness(5.0), spiral)));
        self.add(move |a, b| with(TorsionDamper::new(a, b, axis).with_damping(1.0)));
        let faulty = |a, b| spring(a, b).with_rest_length(f32::NAN);
        self.add(move |a, b| with(faulty(a, b)));
        let [_, body] = self.ends();
        let mouse = self.lab.spawn(MouseSpring::new(body, Vec3::X, Vec3::Y));
        let [a, b] = self.ends();
        let element = self.lab.spawn(spring(a, b));
        let skin = (SpringSkin { length: 1.0 }, ChildOf(element));
        let skin = self.lab.spawn(skin);
        self.lab
            .spawn((Transform::from_xyz(0.1, 0.2, 0.3), ChildOf(skin)));
        self.all.extend([mouse, element, skin]);
        // So that bodies have their `SpringLoad`, and elements their readout.
        self.lab.tick();
    }

    /// Writes a random value into a random component of this crate. Returns the name of the component.
    fn spoil(&mut self, dice: &mut Dice) -> Option<&'static str> {
        let world = self.lab.app.world_mut();
        let registry = world.resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        let mut there = Vec::new();
        for registration in registry.iter() {
            let name = registration.type_info().type_path();
            if let Some(kind) = registration.data::<ReflectComponent>()
                && name.starts_with("bevy_coilover::")
            {
                let all = self.all.iter().filter_map(|e| world.get_entity(*e).ok());
                let with_it = all.filter(|entity| kind.contains(*entity));
                there.extend(with_it.map(|entity| (name, entity.id(), kind)));
            }
        }
        there.sort_by_key(|(name, entity, _)| (*name, *entity));
        // Each component as often as any other, however many entities have it.
        let names: BTreeSet<_> = there.iter().map(|(name, ..)| *name).collect();
        let name = names.into_iter().nth(dice.pick(COMPONENTS) as usize)?;
        there.retain(|(of, ..)| *of == name);
        let (_, entity, kind) = there[dice.pick(there.len() as u32) as usize];
        let mut entity = world.entity_mut(entity);
        let mut value = kind.reflect(entity.as_readonly())?.reflect_clone().ok()?;
        spoil(value.as_partial_reflect_mut(), dice);
        kind.insert(&mut entity, value.as_partial_reflect(), &registry);
        Some(name)
    }

    /// Checks that places, velocities and meshes are finite, and that all meshes together are not too large.
    fn check(&mut self) {
        let world = self.lab.app.world_mut();
        let mut moving = world.query::<(&Transform, &Velocity)>();
        for (at, velocity) in moving.iter(world) {
            let is_sound = velocity.linear.is_finite() && velocity.angular.is_finite();
            assert!(is_sound && at.is_finite(), "{at:?}, {velocity:?}");
        }
        let mut places = world.query::<(Entity, &GlobalTransform)>();
        for (entity, at) in places.iter(world) {
            assert!(at.affine().is_finite(), "{entity} is at {at:?}");
        }
        let mut sets = world.query::<&RapierRigidBodySet>();
        for (_, body) in sets.iter(world).flat_map(|set| set.bodies.iter()) {
            let [force, torque] = [body.user_force(), body.user_torque()];
            assert!(force.is_finite() && torque.is_finite(), "{force}, {torque}");
        }
        let mut vertices = 0;
        for (_, mesh) in world.resource::<Assets<Mesh>>().iter() {
            vertices += mesh.count_vertices();
            for what in [Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_NORMAL] {
                if let Some(VertexAttributeValues::Float32x3(all)) = mesh.attribute(what) {
                    let is_sound = all.as_flattened().iter().all(|x| x.is_finite());
                    assert!(is_sound, "a mesh has NaN");
                }
            }
        }
        assert!(vertices < MOST_VERTICES, "{vertices} vertices");
    }
}

/// What gives an entity its components.
type Dress = Box<dyn FnOnce(&mut EntityWorldMut)>;

fn with(bundle: impl Bundle) -> Dress {
    Box::new(move |entity: &mut EntityWorldMut| {
        entity.insert(bundle);
    })
}

#[test]
fn whatever_is_written_into_any_component_does_no_harm() {
    let mut met = BTreeSet::new();
    for seed in seeds(0..60) {
        let mut dice = Dice(seed);
        let mut stage = Stage::new();
        for round in 0..12 {
            for _ in 0..4 {
                let name = stage.spoil(&mut dice);
                // A failing test shows the last of these.
                println!("seed {seed}, round {round}: {name:?}");
                met.extend(name);
            }
            for _ in 0..3 {
                stage.lab.tick();
            }
            stage.check();
        }
    }
    let stage = Stage::new();
    let registry = stage.lab.app.world().resource::<AppTypeRegistry>().read();
    let components = registry.iter().filter(|registration| {
        let info = registration.type_info();
        // Reflection cannot write into what is opaque, such as the components that a glTF file leaves for a moment.
        info.type_path().starts_with("bevy_coilover::")
            && registration.data::<ReflectComponent>().is_some()
            && !matches!(info, TypeInfo::Opaque(_))
            // A mark has no field.
            && !matches!(info, TypeInfo::Struct(fields) if fields.field_len() == 0)
    });
    for registration in components {
        let name = registration.type_info().type_path();
        assert!(
            met.contains(name),
            "{name} is not in the scene of this test"
        );
    }
}
