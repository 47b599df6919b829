//! With the feature `enhanced-determinism`, each scene ends in the bits that are noted here, on every machine. A change
//! of the physics changes them: the failing test prints the new ones.

use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::Duration;

const DT: f32 = 1.0 / 60.0;
const TICKS: u32 = 300;

/// A scene, and its bodies in the order in which they were spawned.
struct Scene {
    app: App,
    bodies: Vec<Entity>,
}

impl Scene {
    fn new(plugin: CoiloverPlugin) -> Self {
        let mut app = App::new();
        let tick = Duration::from_secs_f32(DT);
        app.add_plugins((MinimalPlugins, TransformPlugin))
            .insert_resource(TimestepMode::Fixed {
                dt: DT,
                substeps: 1,
            })
            .insert_resource(Time::<Fixed>::from_duration(tick))
            .insert_resource(TimeUpdateStrategy::ManualDuration(tick))
            .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule())
            .add_plugins(plugin);
        app.finish();
        app.cleanup();
        let mut schedules = app.world_mut().resource_mut::<Schedules>();
        for (_, schedule) in schedules.iter_mut() {
            schedule.set_executor(SingleThreadedExecutor::new());
        }
        app.update();
        let bodies = Vec::new();
        Self { app, bodies }
    }

    fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    fn fixed(&mut self, at: Vec3) -> Entity {
        self.spawn((RigidBody::Fixed, Transform::from_translation(at)))
    }

    fn body(&mut self, mass: f32, at: Vec3, spin: Vec3) -> Entity {
        let properties = MassProperties {
            mass,
            principal_inertia: mass * Vec3::new(0.02, 0.03, 0.04),
            ..default()
        };
        let body = self.spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::MassProperties(properties),
            Transform::from_translation(at),
            Velocity::angular(spin),
        ));
        self.bodies.push(body);
        body
    }

    fn cube(&mut self, size: f32, at: Vec3) -> Entity {
        let body = self.spawn((
            RigidBody::Dynamic,
            Collider::cuboid(size / 2.0, size / 2.0, size / 2.0),
            Transform::from_translation(at),
            Velocity::default(),
        ));
        self.bodies.push(body);
        body
    }

    /// FNV-1a hash of all poses and velocities after [`TICKS`] ticks.
    fn hash(mut self) -> u64 {
        for _ in 0..TICKS {
            self.app.update();
        }
        let world = self.app.world();
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut take = |number: f32| {
            assert!(number.is_finite());
            for byte in number.to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        };
        for body in &self.bodies {
            let at = world.get::<Transform>(*body).expect("a body");
            let velocity = world.get::<Velocity>(*body).expect("a body");
            at.translation.to_array().into_iter().for_each(&mut take);
            at.rotation.to_array().into_iter().for_each(&mut take);
            velocity.linear.to_array().into_iter().for_each(&mut take);
            velocity.angular.to_array().into_iter().for_each(&mut take);
        }
        hash
    }
}

fn pendulum(plugin: CoiloverPlugin) -> Scene {
    let mut scene = Scene::new(plugin);
    let hook = scene.fixed(Vec3::ZERO);
    let bob = scene.body(1.0, Vec3::new(1.0, 0.2, 0.3), Vec3::ZERO);
    scene.spawn(
        SpringDamper::new(hook, bob)
            .with_stiffness(500.0)
            .with_damping(0.5)
            .with_rest_length(1.0),
    );
    scene
}

fn tumbling_pair(plugin: CoiloverPlugin) -> Scene {
    let mut scene = Scene::new(plugin);
    let a = scene.body(1.0, Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5));
    let b = scene.body(2.0, Vec3::X, Vec3::new(-0.5, 1.0, 2.0));
    scene.spawn((
        Spring::new(a, b).with_stiffness(200.0),
        Anchors::new(Vec3::new(0.2, 0.1, 0.0), Vec3::new(-0.1, 0.2, 0.1)),
    ));
    scene
}

fn boxes_on_springs(plugin: CoiloverPlugin) -> Scene {
    let mut scene = Scene::new(plugin);
    let world = scene.fixed(Vec3::ZERO);
    for layer in 1..=3 {
        let at = Vec3::NEG_Y * layer as f32;
        let body = scene.body(3.0, at, Vec3::new(0.3, 0.2, 0.1));
        for (x, z) in [(-0.5, -0.3), (-0.5, 0.3), (0.5, -0.3), (0.5, 0.3)] {
            let spring = SpringDamper::new(world, body).with_stiffness(400.0);
            let corner = Vec3::new(x, 0.1, z);
            let hook = Vec3::new(x, 0.0, z);
            scene.spawn((
                spring.with_rest_length(0.9 * layer as f32),
                Anchors::new(hook, corner),
            ));
        }
    }
    scene
}

fn cloth(plugin: CoiloverPlugin) -> Scene {
    const SIDE: usize = 10;
    let mut scene = Scene::new(plugin);
    let mut points = Vec::new();
    for i in 0..SIDE * SIDE {
        let at = Vec3::new(0.2 * (i % SIDE) as f32, 0.0, 0.2 * (i / SIDE) as f32);
        let point = if i < SIDE {
            scene.fixed(at)
        } else {
            scene.body(0.05, at, Vec3::ZERO)
        };
        points.push(point);
    }
    for i in 0..SIDE * SIDE {
        for (fits, j) in [
            (i % SIDE + 1 < SIDE, i + 1),
            (i / SIDE + 1 < SIDE, i + SIDE),
        ] {
            if fits {
                scene.spawn(
                    SpringDamper::new(points[i], points[j])
                        .with_stiffness(300.0)
                        .with_damping(0.1),
                );
            }
        }
    }
    scene
}

fn laws(plugin: CoiloverPlugin) -> Scene {
    let mut scene = Scene::new(plugin);
    let hook = scene.fixed(Vec3::ZERO);
    for (i, law) in [
        SpringLaw::Cubic,
        SpringLaw::polynomial(50.0, 20.0, 80.0),
        SpringLaw::table([(-1.0, -300.0), (0.0, 0.0), (0.5, 30.0), (1.0, 200.0)]),
    ]
    .into_iter()
    .enumerate()
    {
        let bob = scene.body(1.0, Vec3::new(i as f32, -1.0, 0.4), Vec3::ZERO);
        let spring = SpringDamper::new(hook, bob).with_stiffness(100.0);
        let spring = spring.with_damping(0.5).with_rest_length(1.0);
        scene.spawn((spring, law));
    }
    // A damper whose valve opens, and a rope that goes slack.
    let bob = scene.body(1.0, Vec3::new(4.0, -1.0, 0.0), Vec3::ZERO);
    let valve = SpringDamper::new(hook, bob).with_stiffness(60.0);
    let opens = DampingLaw::BlowOff {
        damping: 3.0,
        knee: 0.2,
        beyond: 0.5,
    };
    scene.spawn((valve, opens));
    let bob = scene.body(1.0, Vec3::new(6.0, 1.0, 0.0), Vec3::ZERO);
    let rope = Spring::new(hook, bob)
        .with_stiffness(800.0)
        .with_rest_length(5.0);
    scene.spawn((rope, SpringAction::Pull));
    scene
}

fn wound_up(plugin: CoiloverPlugin) -> Scene {
    let mut scene = Scene::new(plugin);
    let frame = scene.fixed(Vec3::ZERO);
    let wheel = scene.body(2.0, Vec3::ZERO, Vec3::X * 30.0);
    let hinge = RevoluteJointBuilder::new(Vec3::X);
    let world = scene.app.world_mut();
    world
        .entity_mut(wheel)
        .insert(ImpulseJoint::new(frame, hinge));
    scene.spawn(TorsionSpringDamper::new(frame, wheel, Vec3::X).with_stiffness(0.3));
    scene
}

fn on_the_ground(plugin: CoiloverPlugin) -> Scene {
    let mut scene = Scene::new(plugin);
    let ground = Collider::cuboid(20.0, 1.0, 20.0);
    let at = Transform::from_xyz(0.0, -1.0, 0.0);
    scene.spawn((RigidBody::Fixed, ground, at));
    let mut below = scene.cube(0.6, Vec3::new(0.0, 0.4, 0.0));
    for i in 1..5 {
        let above = scene.cube(0.4, Vec3::new(0.1 * i as f32, 0.4 + 0.8 * i as f32, 0.05));
        scene.spawn(
            SpringDamper::new(below, above)
                .with_stiffness(3e3)
                .with_damping(30.0),
        );
        below = above;
    }
    scene
}

type Make = fn(CoiloverPlugin) -> Scene;

#[test]
fn each_scene_ends_in_the_bits_that_are_noted() {
    let default = CoiloverPlugin::default;
    let scenes: [(&str, Make, CoiloverPlugin, u64); 9] = [
        ("pendulum", pendulum, default(), 0x3d7c_082b_8490_8eb1),
        (
            "pendulum, extrapolated",
            pendulum,
            default().with_extrapolation(),
            0x1b52_5538_9829_3f4f,
        ),
        (
            "tumbling pair",
            tumbling_pair,
            default().with_tolerance(1e-4),
            0xf577_55f4_18b8_ce19,
        ),
        (
            "boxes on springs",
            boxes_on_springs,
            default(),
            0x06e0_bdb2_fa99_1309,
        ),
        ("cloth", cloth, default(), 0xa9bb_5f48_d1a3_70c4),
        ("laws", laws, default(), 0x0dfa_79b2_6dc6_be7f),
        ("wound up", wound_up, default(), 0x82da_e584_1524_338c),
        (
            "on the ground",
            on_the_ground,
            default(),
            0x5ff5_6dc3_5835_b9dd,
        ),
        (
            "cloth, by a tolerance",
            cloth,
            default().with_tolerance(1e-3),
            0x93d4_dd95_5bd1_509a,
        ),
    ];
    let mut others = Vec::new();
    for (title, make, plugin, noted) in scenes {
        let hash = make(plugin).hash();
        if hash != noted {
            others.push(format!("{title}: {hash:#018x}"));
        }
    }
    assert!(others.is_empty(), "{others:#?}");
}
