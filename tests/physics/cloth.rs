//! Do balls on a cloth of springs gain energy? All bodies in contact can move.

use crate::dice::some;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const SIDE: usize = 16;
const PITCH: f32 = 0.2;
const POINT: f32 = 0.05;
const REST_LENGTH: f32 = 0.1;

/// What connects the points of the cloth.
#[derive(Clone, Copy, Debug)]
enum Link {
    Ours,
    /// Rapier's own spring joint.
    Joint,
}

struct Cloth {
    lab: Lab,
    stiffness: f32,
    points: Vec<Entity>,
    balls: Vec<(Entity, f32)>,
    springs: Vec<[Entity; 2]>,
}

/// `off` is how far the balls are moved aside, m. A small change here changes all the motion that follows.
fn cloth(link: Link, stiffness: f32, damping: f32, friction: f32, off: f32) -> Cloth {
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
            lab.spawn((RigidBody::Fixed, at))
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
            if !fits || (rim(i) && rim(j)) {
                continue;
            }
            let ends = [places[i], places[j]];
            match link {
                Link::Ours => lab.spawn(
                    SpringDamper::new(ends[0], ends[1])
                        .with_stiffness(stiffness)
                        .with_damping(damping)
                        .with_rest_length(REST_LENGTH),
                ),
                Link::Joint => {
                    let joint = SpringJointBuilder::new(REST_LENGTH, stiffness, damping);
                    // A body may carry several joints as children.
                    lab.spawn((ImpulseJoint::new(ends[0], joint), ChildOf(ends[1])))
                }
            };
            springs.push(ends);
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
        stiffness,
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
        for [a, b] in &self.springs {
            let stretch = self.lab.position(*a).distance(self.lab.position(*b)) - REST_LENGTH;
            sum += 0.5 * f64::from(self.stiffness) * f64::from(stretch).powi(2);
        }
        sum
    }
}

/// Energy that the balls lose in the fall to the cloth, J.
const FALLS: f64 = GRAVITY * (3.0 * 1.2 + 1.5 * 1.6 + 2.0 * 0.9);

/// Permitted apparent energy gain, as a fraction of `FALLS`. `RISE` is how high that gain would lift the lightest
/// ball, m. One ball may take over energy that another one brought: in one of these fifteen cases it rises by a
/// millimetre.
const GAIN: f64 = 1e-3;
const RISE: f32 = (GAIN * FALLS / (GRAVITY * 1.5)) as f32;

/// Observations while the balls fall.
struct Seen {
    /// Largest energy above the initial energy, as a fraction of `FALLS`.
    gain: f64,
    /// Largest height of any ball, less the height at which the highest ball started, m.
    rise: f32,
    /// Speed of the fastest point at the end, m/s.
    fastest: f32,
}

/// Lets the balls fall and observes them for six seconds.
fn watch(mut cloth: Cloth) -> Seen {
    let height = |cloth: &Cloth| {
        let heights = cloth
            .balls
            .iter()
            .map(|(ball, _)| cloth.lab.position(*ball).y);
        heights.fold(f32::MIN, f32::max)
    };
    let from = height(&cloth);
    cloth.lab.tick();
    let first = cloth.energy();
    let (mut gain, mut highest) = (f64::MIN, f32::MIN);
    for _ in 0..cloth.lab.ticks(6.0) {
        cloth.lab.tick();
        gain = gain.max((cloth.energy() - first) / FALLS);
        highest = highest.max(height(&cloth));
    }
    let speeds = cloth.points.iter().map(|p| cloth.lab.velocity(*p).length());
    Seen {
        gain,
        rise: highest - from,
        fastest: speeds.fold(0.0, f32::max),
    }
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
        for off in some([0.0, 1e-3, 3e-3]) {
            let seen = watch(cloth(Link::Ours, stiffness, damping, friction, off));
            println!(
                "cloth of {stiffness} N/m, {damping} N s/m, friction {friction}, {off} m aside: energy at \
                 most {:+.3} of the falls' above the first, no ball higher than {:+.4} m, in the end no point \
                 faster than {:.2} m/s",
                seen.gain, seen.rise, seen.fastest
            );
            assert!(seen.gain < GAIN, "gained {}", seen.gain);
            assert!(seen.rise < RISE, "rose by {} m", seen.rise);
            assert!(seen.fastest < 5.0, "{} m/s", seen.fastest);
        }
    }
}

/// The cloth is stiffer than a step resolves: ω·dt of a point is 6.7 and 15. The balls weigh up to sixty times as
/// much as a point.
#[test]
fn a_cloth_too_stiff_for_its_step_wins_nothing_under_balls() {
    for (stiffness, damping, friction) in [
        (1000.0, 0.0, 0.5),
        (1000.0, 1.0, 0.0),
        (5000.0, 0.0, 0.0),
        (5000.0, 1.0, 0.5),
    ] {
        let [ours, joints] = [Link::Ours, Link::Joint]
            .map(|link| watch(cloth(link, stiffness, damping, friction, 0.0)));
        println!(
            "cloth of {stiffness} N/m, {damping} N s/m, friction {friction}: energy at most {:+.2} of the \
             falls' above the first, the highest ball at {:+.2} m from where it began, in the end no point \
             faster than {:.2} m/s; with SpringJoints {:+.0}, {:+.2} m, {:.0} m/s",
            ours.gain, ours.rise, ours.fastest, joints.gain, joints.rise, joints.fastest
        );
        assert!(ours.gain < 1e-3, "gained {}", ours.gain);
        assert!(ours.rise <= 0.0, "rose by {} m", ours.rise);
        assert!(ours.fastest < 5.0, "{} m/s", ours.fastest);
    }
}
