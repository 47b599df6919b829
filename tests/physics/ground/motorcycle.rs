//! A motorcycle with a raked telescopic fork and a swing arm, whose coilover acts on a lever.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const RADIUS: f32 = 0.3;
/// Masses of the frame with rider, the swing arm, the lower fork and each wheel, kg.
const MASSES: [f32; 4] = [200.0, 6.0, 8.0, 12.0];
/// Pivot of the arm, in the frame from its centre of mass, m.
const PIVOT: Vec2 = Vec2::new(-0.25, -0.15);
/// Upper end of the rear coilover, in the frame from its centre of mass, m.
const LUG: Vec2 = Vec2::new(-0.35, 0.15);
const ARM: f32 = 0.5;
/// Distance from the pivot to the coilover's end on the arm, m.
const HOLD: f32 = 0.25;
const HEAD: Vec2 = Vec2::new(0.55, 0.1);
const RAKE: f32 = 0.45;
/// Angle of the arm below the horizontal in rad, and length of the fork in m, with both springs at rest length.
const BUILT: [f32; 2] = [0.3, 0.45];
const REAR: [f32; 2] = [60e3, 3.5e3];
const FRONT: [f32; 2] = [16e3, 900.0];

fn along_arm(angle: f32) -> Vec2 {
    Vec2::new(-angle.cos(), -angle.sin())
}

fn along_fork() -> Vec2 {
    Vec2::new(RAKE.sin(), -RAKE.cos())
}

/// Lengths of both coilovers at an angle of the arm and a length of the fork, m.
fn lengths([angle, fork]: [f32; 2]) -> [f32; 2] {
    [LUG.distance(PIVOT + HOLD * along_arm(angle)), fork]
}

/// Energy of height and springs with both wheels on the ground, J.
fn potential(shape: [f64; 2]) -> f64 {
    let [angle, fork] = shape;
    let vec = |v: Vec2| [f64::from(v.x), f64::from(v.y)];
    let (pivot, lug, head) = (vec(PIVOT), vec(LUG), vec(HEAD));
    let on_arm = |reach: f32| {
        let reach = f64::from(reach);
        [
            pivot[0] - reach * angle.cos(),
            pivot[1] - reach * angle.sin(),
        ]
    };
    let rake = f64::from(RAKE);
    let front = [head[0] + fork * rake.sin(), head[1] - fork * rake.cos()];
    let rear = on_arm(ARM);
    let pitch = -(front[1] - rear[1]).atan2(front[0] - rear[0]);
    // Height of a point of the frame above the axles.
    let height = |p: [f64; 2]| {
        let [x, y] = [p[0] - rear[0], p[1] - rear[1]];
        x * pitch.sin() + y * pitch.cos()
    };
    let hold = on_arm(HOLD);
    let coil = (lug[0] - hold[0]).hypot(lug[1] - hold[1]);
    let rest = lengths(BUILT).map(f64::from);
    let spring = |law: [f32; 2], stretch: f64| 0.5 * f64::from(law[0]) * stretch * stretch;
    let masses = MASSES.map(f64::from);
    let weights = masses[0] * height([0.0; 2]) + masses[1] * height(on_arm(0.5 * ARM));
    let all = masses[0] + masses[1] + masses[2] + 2.0 * masses[3];
    GRAVITY * (weights + all * f64::from(RADIUS))
        + spring(REAR, coil - rest[0])
        + spring(FRONT, fork - rest[1])
}

/// Angle of the arm and length of the fork at rest: the minimum of the energy, by Newton's method.
fn statics() -> [f64; 2] {
    let mut shape = BUILT.map(f64::from);
    let h = 1e-4;
    for _ in 0..50 {
        let at = |i: f64, j: f64| potential([shape[0] + i * h, shape[1] + j * h]);
        let slope = [
            (at(1.0, 0.0) - at(-1.0, 0.0)) / (2.0 * h),
            (at(0.0, 1.0) - at(0.0, -1.0)) / (2.0 * h),
        ];
        let square = h * h;
        let a = (at(1.0, 0.0) - 2.0 * at(0.0, 0.0) + at(-1.0, 0.0)) / square;
        let b = (at(0.0, 1.0) - 2.0 * at(0.0, 0.0) + at(0.0, -1.0)) / square;
        let c = (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / (4.0 * square);
        let det = a * b - c * c;
        shape[0] -= (b * slope[0] - c * slope[1]) / det;
        shape[1] -= (a * slope[1] - c * slope[0]) / det;
    }
    shape
}

/// A motorcycle on its wheels with both springs at rest length. Returns the scene and the wheels.
fn motorcycle(speed: f32) -> (Stand, [Entity; 2]) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let ground = scene.ground();
    let road = CollisionGroups::new(Group::GROUP_1, Group::GROUP_2);
    scene.lab.app.world_mut().entity_mut(ground).insert(road);
    let [angle, fork] = BUILT;
    let (arm, slide) = (along_arm(angle), along_fork());
    let [rear, front] = [PIVOT + ARM * arm, HEAD + fork * slide];
    let up = Vec2::Y * (RADIUS - rear.y.min(front.y));
    let place = |p: Vec2| Transform::from_translation((p + up).extend(0.0));
    let part = |mass: f32, long: f32| {
        (
            AdditionalMassProperties::MassProperties(MassProperties {
                mass,
                principal_inertia: Vec3::splat(mass * long * long / 12.0),
                ..default()
            }),
            Velocity::linear(Vec3::X * speed),
        )
    };
    let frame = scene.body(
        place(Vec2::ZERO),
        (
            part(MASSES[0], 1.2),
            LockedAxes::TRANSLATION_LOCKED_Z
                | LockedAxes::ROTATION_LOCKED_X
                | LockedAxes::ROTATION_LOCKED_Y,
        ),
    );
    let turns = |on: Vec2, at: Vec2| {
        RevoluteJointBuilder::new(Vec3::Z)
            .local_anchor1(on.extend(0.0))
            .local_anchor2(at.extend(0.0))
    };
    let swing = scene.body(
        place(PIVOT + 0.5 * ARM * arm).with_rotation(Quat::from_rotation_z(angle)),
        (
            part(MASSES[1], ARM),
            ImpulseJoint::new(frame, turns(PIVOT, Vec2::X * 0.5 * ARM)),
        ),
    );
    let slider = PrismaticJointBuilder::new(slide.extend(0.0)).local_anchor1(HEAD.extend(0.0));
    let lower = scene.body(
        place(front),
        (part(MASSES[2], 0.4), ImpulseJoint::new(frame, slider)),
    );
    let ends = [
        (swing, Vec2::NEG_X * 0.5 * ARM, rear),
        (lower, Vec2::ZERO, front),
    ];
    let wheels = ends.map(|(on, anchor, at)| {
        let shape = Collider::compound(vec![(
            Vec3::ZERO,
            Quat::from_rotation_x(std::f32::consts::FRAC_PI_2),
            Collider::cylinder(0.06, RADIUS),
        )]);
        scene.body(
            place(at),
            (
                shape,
                ColliderMassProperties::Mass(MASSES[3]),
                CollisionGroups::new(Group::GROUP_2, Group::GROUP_1),
                Friction::new(0.8),
                Velocity {
                    linear: Vec3::X * speed,
                    angular: Vec3::NEG_Z * speed / RADIUS,
                },
                ImpulseJoint::new(on, turns(anchor, Vec2::ZERO)),
            ),
        )
    });
    let [rear, front] = lengths(BUILT);
    let hold = Vec3::X * (0.5 * ARM - HOLD);
    scene.coil([frame, swing], [LUG.extend(0.0), hold], REAR, Some(rear));
    scene.coil(
        [frame, lower],
        [HEAD.extend(0.0), Vec3::ZERO],
        FRONT,
        Some(front),
    );
    (scene, wheels)
}

#[test]
fn a_motorcycle_sags_by_its_levers_and_sleeps_when_it_has_stopped() {
    let shape = statics();
    let wanted = lengths(shape.map(|x| x as f32));
    let sags = [0, 1].map(|i| f64::from(lengths(BUILT)[i] - wanted[i]));
    let floor = potential(shape);
    println!(
        "statics: coilovers sag by {:.4} and {:.4} m",
        sags[0], sags[1]
    );
    let mut wrong = Vec::new();
    for speed in [0.0_f32, 10.0, 20.0] {
        let (mut scene, wheels) = motorcycle(speed);
        scene.lab.tick();
        let first = scene.energy() - floor;
        let most = (scene.most(5.0) - floor) / first;
        let mut means = [0.0; 2];
        for _ in 0..300 {
            scene.lab.tick();
            for (mean, (coil, sag)) in means.iter_mut().zip(scene.coils.iter().zip(sags)) {
                *mean += (f64::from(coil.rest_length) - scene.length(coil)) / sag / 300.0;
            }
        }
        let now = scene.lab.velocity(scene.bodies[0]).x;
        for wheel in wheels {
            scene.lab.get_mut::<Velocity>(wheel).angular = Vec3::ZERO;
            let world = scene.lab.app.world_mut();
            world
                .entity_mut(wheel)
                .insert(LockedAxes::ROTATION_LOCKED_Z);
        }
        let braked = (scene.most(15.0) - floor) / first;
        let (speed_then, awake) = (scene.speed(), scene.awake());
        println!(
            "motorcycle at {speed} m/s: sags × {means:.4?}, E × {most:.4}, {now:.2} m/s after 10 s; braked E × {braked:.4}, {speed_then:.1e} m/s, {awake} awake"
        );
        if means.iter().any(|sag| (sag - 1.0).abs() > 0.03)
            || most > 1.02
            || braked > 1.02
            || awake > 0
            // The engine turns no body by more than an eighth of a turn in a step, which limits these wheels to 14.1 m/s.
            || now < 0.95 * speed.min(14.1)
        {
            wrong.push(speed);
        }
    }
    assert!(wrong.is_empty(), "at {wrong:?} m/s");
}
