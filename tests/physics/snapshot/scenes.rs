//! Scenes that cover every state which springs keep between ticks.

use super::film::*;
use super::held::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Function that makes a scene.
pub type Play = fn(CoiloverPlugin) -> Film;

/// The scene of a name that [`all`] gives, after so many ticks.
pub fn after(name: &str, ticks: usize) -> Film {
    let (_, plugin, scene) = all()
        .into_iter()
        .find(|(known, ..)| known == name)
        .expect("the scene is there");
    let mut film = scene(plugin);
    film.run(ticks);
    film
}

/// Every scene with each plugin setting under test: name, plugin and function.
pub fn all() -> Vec<(String, CoiloverPlugin, Play)> {
    let plain = CoiloverPlugin::default;
    let ways = [
        ("plain", plain()),
        ("tolerance", plain().with_tolerance(1e-4)),
        ("extrapolation", plain().with_extrapolation()),
    ];
    let scenes: [(&str, Play); 17] = [
        ("lone", lone),
        ("laws", laws),
        ("torsion", torsion),
        ("chain", chain),
        ("rods", rods),
        ("lattice", lattice),
        ("moved ends", moved_ends),
        ("pushed", pushed),
        ("feet", feet),
        ("cloth", cloth),
        ("ropes", ropes),
        ("hinges", hinges),
        ("multibody", multibody),
        ("car", car),
        ("actuator", actuator),
        ("breaking", breaking),
        ("disabled", disabled),
    ];
    let named = |(name, scene): (&str, Play)| {
        ways.map(|(way, plugin)| (format!("{name}, {way}"), plugin, scene))
    };
    scenes.into_iter().flat_map(named).collect()
}

/// Scenes whose bodies fall asleep, and are woken by the game.
pub fn sleepers() -> Vec<(String, CoiloverPlugin, Play)> {
    let ways = [
        ("plain", CoiloverPlugin::default()),
        ("tolerance", CoiloverPlugin::default().with_tolerance(1e-4)),
    ];
    ways.map(|(way, plugin)| (format!("sleepers, {way}"), plugin, resting as Play))
        .into()
}

impl Film {
    /// Number of sleeping bodies.
    pub fn asleep(&self) -> usize {
        let sleeps = |entity: &&Entity| {
            let sleeping = self.lab.app.world().get::<Sleeping>(**entity);
            sleeping.is_some_and(|sleeping| sleeping.sleeping)
        };
        self.cast.iter().filter(sleeps).count()
    }

    pub fn point(&mut self, at: Vec3) -> Entity {
        self.spawn(Transform::from_translation(at))
    }

    pub fn brick(&mut self, mass: f32, at: Vec3) -> Entity {
        self.spawn(brick(mass, mass * Vec3::new(0.02, 0.03, 0.04), at))
    }

    pub fn solid(&mut self, at: Vec3, collider: Collider, mass: f32) -> Entity {
        self.spawn((
            RigidBody::Dynamic,
            Transform::from_translation(at),
            collider,
            ColliderMassProperties::Mass(mass),
            Velocity::default(),
            Sleeping::default(),
            Friction::new(0.8),
        ))
    }

    pub fn ground(&mut self) -> Entity {
        let shape = Collider::halfspace(Vec3::Y).expect("up");
        self.spawn((shape, Friction::new(0.8), Transform::default()))
    }

    pub fn insert(&mut self, entity: Entity, bundle: impl Bundle) {
        self.lab.app.world_mut().entity_mut(entity).insert(bundle);
    }

    /// Restores what the game itself drives: calls the deed of the previous tick again.
    pub fn rewind(&mut self) {
        let tick = self.tick;
        let deed = self.deed;
        if tick > 0 {
            // Most deeds set a state for their tick, whatever was before.
            self.tick = tick - 1;
            deed(self);
            self.tick = tick;
        }
    }
}

pub fn coil(a: Entity, b: Entity, stiffness: f32, damping: f32) -> SpringDamper {
    SpringDamper::new(a, b)
        .with_stiffness(stiffness)
        .with_damping(damping)
}

/// Pendulums with one spring each, and two falling bodies with a spring between them.
fn lone(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    for (i, stiffness) in [30.0, 400.0, 9e4].into_iter().enumerate() {
        let x = 3.0 * i as f32;
        let hook = film.point(Vec3::new(x, 2.0, 0.0));
        let weight = film.brick(1.0, Vec3::new(x + 1.0, 2.0, 0.3));
        film.spawn(coil(hook, weight, stiffness, 0.1));
    }
    let a = film.brick(1.0, Vec3::new(0.0, 0.0, 9.0));
    let b = film.brick(2.0, Vec3::new(1.0, 0.3, 9.0));
    film.spawn(
        Spring::new(a, b)
            .with_stiffness(200.0)
            .with_rest_length(0.5),
    );
    film.insert(a, Velocity::linear(Vec3::new(0.0, 3.0, 1.0)));
    film
}

/// Companions of every kind on lone elements, one of which turns its body.
fn laws(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    let mut hang = |i: usize, companion: fn(&mut EntityCommands)| {
        let x = 3.0 * i as f32;
        let hook = film.point(Vec3::new(x, 2.0, 0.0));
        let weight = film.brick(1.0, Vec3::new(x + 0.4, 1.2, 0.3));
        let element = film.spawn(coil(hook, weight, 60.0, 0.5).with_rest_length(1.0));
        let world = film.lab.app.world_mut();
        companion(&mut world.commands().entity(element));
        world.flush();
    };
    // Discards the commands that each insertion returns.
    fn add(_: &mut EntityCommands) {}
    hang(0, |e| add(e.insert(SpringLaw::Cubic)));
    hang(1, |e| add(e.insert(SpringAction::Pull)));
    hang(2, |e| add(e.insert(SpringTravel::new(0.8, 1.1, 2e3))));
    hang(3, |e| add(e.insert((Preload(4.0), MaxForce(12.0)))));
    hang(4, |e| {
        e.insert(DampingLaw::Sided {
            bump: 0.3,
            rebound: 1.2,
        });
    });
    hang(5, |e| add(e.insert(SpringAxis::World(Vec3::Y))));
    hang(6, |e| {
        e.insert((
            Anchors::new(Vec3::ZERO, Vec3::new(0.1, 0.2, 0.0)),
            SpringAction::Pull,
        ));
    });
    hang(7, |e| add(e.insert(SpringTuning::frequency(1.5, 0.05))));
    hang(8, |e| add(e.insert(HoldPose::new())));
    film
}

/// Flywheels on a torsion spring that they wind up by many turns, free and on a hinge, and a tumbling pair.
fn torsion(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    for hinged in [false, true] {
        let z = if hinged { 4.0 } else { 0.0 };
        let frame = film.spawn((RigidBody::Fixed, Transform::from_xyz(0.0, 0.0, z)));
        let wheel = film.brick(2.0, Vec3::new(0.0, 0.0, z));
        film.insert(
            wheel,
            (Velocity::angular(Vec3::X * 25.0), GravityScale(0.0)),
        );
        if hinged {
            film.insert(
                wheel,
                ImpulseJoint::new(frame, RevoluteJointBuilder::new(Vec3::X)),
            );
        }
        film.spawn(
            TorsionSpringDamper::new(frame, wheel, Vec3::X)
                .with_stiffness(0.05)
                .with_damping(1e-3),
        );
    }
    let a = film.brick(1.0, Vec3::new(0.0, 0.0, 8.0));
    let b = film.brick(1.0, Vec3::new(1.0, 0.0, 8.0));
    film.insert(b, Velocity::angular(Vec3::new(9.0, 1.0, -2.0)));
    film.spawn(TorsionSpring::new(a, b, Vec3::X).with_stiffness(0.4));
    film.spawn(coil(a, b, 90.0, 0.3));
    film
}

/// A network of few bodies, with springs off their centres: the direct solver.
fn chain(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    let mut last = film.point(Vec3::Y * 3.0);
    for i in 1..=6 {
        let next = film.brick(0.4, Vec3::new(0.5 * i as f32, 3.0, 0.1 * (i % 2) as f32));
        film.spawn((
            coil(last, next, 250.0, 0.1),
            Anchors::new(Vec3::ZERO, Vec3::new(0.0, 0.1, 0.0)),
        ));
        last = next;
    }
    // Two springs between the same pair of bodies, which differ in their numbers only.
    film.spawn(coil(last, film.cast[1], 40.0, 0.0).with_rest_length(2.0));
    film.spawn(coil(last, film.cast[1], 30.0, 0.0).with_rest_length(2.5));
    film
}

/// A network of many rotating bodies: the iterative solver.
fn rods(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    let mut last = film.point(Vec3::Y * 3.0);
    for i in 1..=40 {
        let i = i as f32;
        let next = film.brick(0.1, Vec3::new(0.2 * i, 3.0 + 0.1 * i.sin(), 0.1 * i.cos()));
        film.spawn((
            coil(last, next, 900.0, 0.05),
            Anchors::new(Vec3::X * 0.05, Vec3::NEG_X * 0.05),
        ));
        last = next;
    }
    film
}

/// A network of many points, whose state goes on from step to step without being read anew.
fn lattice(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    const SIDE: usize = 9;
    let mut points = Vec::new();
    for i in 0..SIDE * SIDE {
        let at = 0.2 * Vec3::new((i % SIDE) as f32, 0.0, (i / SIDE) as f32);
        let corner = i == 0 || i == SIDE - 1;
        points.push(if corner {
            film.point(at)
        } else {
            film.brick(0.05, at)
        });
    }
    for i in 0..SIDE * SIDE {
        for (fits, j) in [
            (i % SIDE + 1 < SIDE, i + 1),
            (i / SIDE + 1 < SIDE, i + SIDE),
        ] {
            if fits {
                film.spawn(coil(points[i], points[j], 80.0, 0.02).with_rest_length(0.2));
            }
        }
    }
    film
}

/// A hook, a kinematic body and a child of a body as ends. The game moves the first two.
fn moved_ends(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    let hook = film.point(Vec3::Y * 2.0);
    let lift = film.spawn((
        RigidBody::KinematicPositionBased,
        Transform::from_xyz(3.0, 2.0, 0.0),
    ));
    for end in [hook, lift] {
        let at = film.lab.get::<Transform>(end).translation;
        let weight = film.brick(1.0, at - Vec3::Y);
        film.spawn(coil(end, weight, 120.0, 0.2));
        let second = film.brick(0.5, at - 2.0 * Vec3::Y);
        let ear = film.spawn((Transform::from_xyz(0.1, 0.0, 0.0), ChildOf(second)));
        film.spawn(coil(weight, ear, 60.0, 0.1));
    }
    film.spawn(coil(hook, lift, 10.0, 1.0));
    film.deed = |film| {
        let t = film.tick as f32 * DT;
        let (hook, lift) = (film.cast[0], film.cast[1]);
        film.lab.get_mut::<Transform>(hook).translation =
            Vec3::new(0.3 * (2.0 * t).sin(), 2.0, 0.0);
        film.lab.get_mut::<Transform>(lift).translation =
            Vec3::new(3.0, 2.0 + 0.2 * (3.0 * t).sin(), 0.0);
    };
    film
}

/// Weights, one of which the game pushes in every other 70 ticks.
fn pushed(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    film.ground();
    for i in 0..3 {
        let at = Vec3::new(3.0 * i as f32, 2.0, 0.0);
        let hook = film.point(at);
        let weight = film.solid(at - Vec3::Y, Collider::ball(0.1), 1.0);
        film.insert(weight, ExternalForce::default());
        film.spawn(coil(hook, weight, 50.0, 4.0));
    }
    film.deed = |film| {
        let push = if film.tick / 70 % 2 == 1 { 5.0 } else { 0.0 };
        let weight = film.cast[2];
        let mut force = film.lab.get_mut::<ExternalForce>(weight);
        if film.tick % 70 == 0 {
            force.force = Vec3::X * push;
        }
    };
    film
}
