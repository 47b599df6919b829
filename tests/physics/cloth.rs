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

fn cloth(friction: f32, damping: f32) -> Cloth {
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
                            .with_stiffness(300.0)
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
            Transform::from_xyz(x, height + radius, z),
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

#[test]
fn balls_that_fall_on_a_cloth_win_no_energy() {
    for (friction, damping) in [(0.0, 0.3), (0.5, 0.3), (0.5, 2.0)] {
        let mut cloth = cloth(friction, damping);
        cloth.lab.tick();
        let first = cloth.energy();
        let falls = GRAVITY * (3.0 * 1.2 + 1.5 * 1.6 + 2.0 * 0.9);
        let mut most = f64::MIN;
        for _ in 0..cloth.lab.ticks(10.0) {
            cloth.lab.tick();
            most = most.max((cloth.energy() - first) / falls);
        }
        let fastest = cloth
            .points
            .iter()
            .map(|p| cloth.lab.velocity(*p).length())
            .fold(0.0, f32::max);
        println!(
            "cloth, friction {friction}, damping {damping}: energy at most {most:+.3} of the falls' above the first, \
             after 10 s no point faster than {fastest:.3} m/s"
        );
        assert!(most < 0.05, "gained {most}");
        assert!(fastest < 4.0, "{fastest} m/s");
    }
}
