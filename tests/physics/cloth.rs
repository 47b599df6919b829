//! Balls on a cloth of springs: contacts between bodies that all move.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const SIDE: usize = 16;
const PITCH: f32 = 0.2;
const POINT: f32 = 0.05;

struct Cloth {
    lab: Lab,
    points: Vec<Entity>,
    balls: Vec<(Entity, f32)>,
    springs: Vec<Entity>,
}

/// `off` is how far the balls are moved aside: a little changes everything that comes after.
fn cloth(stiffness: f32, damping: f32, friction: f32, off: f32) -> Cloth {
    let mut lab = Lab::new();
    let middle = 0.5 * (SIDE - 1) as f32;
    let rim = |i: usize| {
        let (x, z) = (i % SIDE, i / SIDE);
        x == 0 || z == 0 || x == SIDE - 1 || z == SIDE - 1
    };
    let mut places = Vec::new();
    let mut points = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, z) = ((i % SIDE) as f32 - middle, (i / SIDE) as f32 - middle);
        let at = Transform::from_xyz(PITCH * x, 0.0, PITCH * z);
        places.push(if rim(i) {
            lab.spawn(at)
        } else {
            let point = lab.spawn((
                RigidBody::Dynamic,
                at,
                Collider::ball(0.05),
                ColliderMassProperties::Mass(POINT),
                CollisionGroups::new(Group::GROUP_1, Group::GROUP_2),
                LockedAxes::ROTATION_LOCKED,
                Velocity::default(),
            ));
            points.push(point);
            point
        });
    }
    let mut springs = Vec::new();
    for i in 0..places.len() {
        for (fits, j) in [
            (i % SIDE + 1 < SIDE, i + 1),
            (i / SIDE + 1 < SIDE, i + SIDE),
        ] {
            if fits && !(rim(i) && rim(j)) {
                springs.push(
                    lab.spawn(
                        SpringDamper::new(places[i], places[j])
                            .with_stiffness(stiffness)
                            .with_damping(damping)
                            .with_rest_length(0.1),
                    ),
                );
            }
        }
    }
    let mut balls = Vec::new();
    for (radius, mass, x, z, height) in [
        (0.36, 3.0, -0.65, -0.2, 1.2),
        (0.28, 1.5, 0.55, -0.55, 1.6),
        (0.32, 2.0, 0.45, 0.55, 0.9),
    ] {
        let ball = lab.spawn((
            RigidBody::Dynamic,
            Transform::from_xyz(x + off, height + radius, z),
            Collider::ball(radius),
            ColliderMassProperties::Mass(mass),
            CollisionGroups::new(Group::GROUP_2, Group::ALL),
            Friction {
                coefficient: friction,
                combine_rule: CoefficientCombineRule::Min,
            },
            Velocity::default(),
        ));
        balls.push((ball, mass));
    }
    Cloth {
        lab,
        points,
        balls,
        springs,
    }
}

impl Cloth {
    fn energy(&self) -> f64 {
        let points = self.points.iter().map(|point| (*point, POINT));
        let mut sum = 0.0;
        for (body, mass) in points.chain(self.balls.iter().copied()) {
            let v = f64::from(self.lab.velocity(body).length());
            let y = f64::from(self.lab.position(body).y);
            sum += f64::from(mass) * (0.5 * v * v + GRAVITY * y);
        }
        for spring in &self.springs {
            sum += f64::from(self.lab.readout(*spring).stored_energy);
        }
        sum
    }
}

/// Energy that the balls have to lose by falling, J.
const FALLS: f64 = GRAVITY * (3.0 * 1.2 + 1.5 * 1.6 + 2.0 * 0.9);

/// Lets the balls fall and watches for so long: the most energy above the first, as a share of the falls',
/// and the speed of the fastest point in the end.
fn watch(mut cloth: Cloth, seconds: f64) -> (f64, f32) {
    cloth.lab.tick();
    let first = cloth.energy();
    let mut most = f64::MIN;
    for _ in 0..cloth.lab.ticks(seconds) {
        cloth.lab.tick();
        most = most.max((cloth.energy() - first) / FALLS);
    }
    let speeds = cloth.points.iter().map(|p| cloth.lab.velocity(*p).length());
    (most, speeds.fold(0.0, f32::max))
}

#[test]
fn balls_that_fall_on_a_cloth_win_no_energy() {
    for (stiffness, damping, friction) in [
        (100.0, 0.0, 0.0),
        (100.0, 0.0, 0.5),
        (300.0, 0.3, 0.0),
        (300.0, 0.3, 0.5),
        (300.0, 2.0, 0.5),
    ] {
        for off in [0.0, 1e-3, 3e-3] {
            let (most, fastest) = watch(cloth(stiffness, damping, friction, off), 6.0);
            println!(
                "cloth of {stiffness} N/m, {damping} N s/m, friction {friction}, {off} m aside: energy at \
                 most {most:+.3} of the falls' above the first, in the end no point faster than {fastest:.2} m/s"
            );
            assert!(most < 0.1, "gained {most}");
            assert!(fastest < 10.0, "{fastest} m/s");
        }
    }
}

/// Stiffness beyond what a step resolves (ω·dt of a point 6.7 and 15), under balls that weigh sixty times
/// as much as what they fall on. Pressed together so hard, Rapier's contacts give energy too; it is taken back.
#[test]
fn a_cloth_too_stiff_for_its_step_calms_down_under_balls() {
    for (stiffness, damping, friction) in [
        (1000.0, 0.0, 0.5),
        (1000.0, 1.0, 0.0),
        (5000.0, 0.0, 0.0),
        (5000.0, 1.0, 0.5),
    ] {
        let (most, fastest) = watch(cloth(stiffness, damping, friction, 0.0), 6.0);
        println!(
            "cloth of {stiffness} N/m, {damping} N s/m, friction {friction}: energy at most {most:+.2} of the \
             falls' above the first, in the end no point faster than {fastest:.2} m/s"
        );
        assert!(most < 100.0, "gained {most}");
        assert!(fastest < 5.0, "{fastest} m/s");
    }
}
