//! What a tyre does on the road.
//!
//! Rapier's rolling contacts do not hold at the speed of this car. It turns no body by more than an eighth of a turn in a
//! step, which is 15 m/s for these wheels: beyond that they slide. And a contact point stays on the wheel for a whole step
//! and rises with it, by which a wheel sinks 27 mm at 12 m/s. So the wheel of this example is a ball without friction that
//! does not turn, and holds the load as Rapier's contacts do; what is along the road is a tyre of slip.
//!
//! The tread is a spring along the road and across. It is carried away by what the road slides below the wheel, laid down
//! anew as the wheel rolls, and lets go where friction ends. Rolling, its force is a stiffness times the slip; standing, it
//! is a spring, and so a car with its brakes on does not creep.

use super::car::{Chassis, RADIUS, WHEEL};
use super::driver::Pedals;
use crate::stage::{self, DT};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// Of the tread against the road, N/m and N s/m.
const STIFFNESS: f32 = 150e3;
const DAMPING: f32 = 4e3;
/// On which half of the tread is laid down anew, m. With the stiffness: 60 kN for each unit of slip.
const RELAXATION: f32 = 0.4;
/// Of rubber on asphalt.
const FRICTION: f32 = 1.1;
/// Of a wheel with its tyre about its axle, kg m².
const INERTIA: f32 = 1.3;
/// The wheel's spin is lighter than the car, and so is followed in finer steps.
const STEPS: u32 = 16;
/// All of the engine, W, and of a wheel's share at most, N m: it drives all four.
const POWER: f32 = 220e3;
const TORQUE: f32 = 700.0;
/// Of a wheel's brake in front and behind, N m.
const BRAKES: [f32; 2] = [1_500.0, 1_000.0];
/// A contact that presses less than this, N, is about to part.
const TOUCH: f32 = 1.0;

/// On a wheel.
#[derive(Component)]
pub struct Tyre {
    /// On the chassis.
    pub corner: Vec3,
    /// To the left, rad.
    pub steer: f32,
    /// Forwards, rad/s, and how far it has turned, rad.
    pub spin: f32,
    pub angle: f32,
    /// How far the tread is pushed forwards and to the right, m.
    tread: Vec2,
    /// What presses it onto the road, N; 0 in the air.
    pub load: f32,
}

impl Tyre {
    pub fn new(corner: Vec3) -> Self {
        Self {
            corner,
            steer: 0.0,
            spin: 0.0,
            angle: 0.0,
            tread: Vec2::ZERO,
            load: 0.0,
        }
    }

    /// Goes one tick on, the hub going over the road with this speed. Gives the force on the wheel, N, forwards and to the
    /// right.
    fn roll(&mut self, speed: Vec2, [engine, brake]: [f32; 2]) -> Vec2 {
        let step = DT / STEPS as f32;
        let mut sum = Vec2::ZERO;
        for _ in 0..STEPS {
            let slides = speed - Vec2::X * self.spin * RADIUS;
            let laid = (self.spin * RADIUS).abs() / RELAXATION;
            let before = self.tread;
            self.tread = (self.tread + slides * step) / (1.0 + laid * step);
            let most = FRICTION * self.load;
            let rate = (self.tread - before) / step;
            let force = (-STIFFNESS * self.tread - DAMPING * rate).clamp_length_max(most);
            self.tread = self.tread.clamp_length_max(most / STIFFNESS);
            let free = self.spin + step / INERTIA * (engine - force.x * RADIUS);
            let held = brake * step / INERTIA;
            self.spin = free - free.clamp(-held, held);
            self.angle += self.spin * step;
            sum += force / STEPS as f32;
        }
        sum
    }
}

/// Where a wheel touches the road: the load, N, the mean normal, and the point.
fn contact(context: &RapierContext, wheel: Entity, hub: Vec3) -> (f32, Vec3) {
    let (mut load, mut sum) = (0.0, Vec3::ZERO);
    for pair in context.contact_pairs_with(wheel) {
        for manifold in pair.manifolds() {
            // The wheel is a ball, so what touches it is on the line to its centre.
            let own = pair.collider1() == Some(wheel);
            let normal = if own {
                -manifold.normal()
            } else {
                manifold.normal()
            };
            let impulse: f32 = manifold.points().map(|p| p.impulse()).sum();
            load += impulse / DT;
            sum += impulse * normal;
        }
    }
    let normal = sum.try_normalize().unwrap_or(Vec3::Y);
    (load, hub - RADIUS * normal)
}

/// Reads what the last step pressed, and pushes wheels and chassis.
pub fn push(
    pedals: Res<Pedals>,
    context: ReadRapierContext,
    mut chassis: Query<(&Transform, &mut ExternalForce, &Velocity), (With<Chassis>, Without<Tyre>)>,
    mut wheels: Query<(Entity, &Transform, &Velocity, &mut ExternalForce, &mut Tyre)>,
) {
    let (Ok(context), Ok((car, mut on_chassis, moves))) = (context.single(), chassis.single_mut())
    else {
        return;
    };
    *on_chassis = ExternalForce::default();
    if stage::given("--rolling") {
        return;
    }
    for (wheel, at, velocity, mut on_wheel, mut tyre) in &mut wheels {
        let hub = at.translation;
        let (load, point) = contact(&context, wheel, hub);
        tyre.load = if load > TOUCH { load } else { 0.0 };
        let front = tyre.corner.x > 0.0;
        tyre.steer = if front { pedals.steer } else { 0.0 };
        let normal = (hub - point) / RADIUS;
        let heading = car.rotation * Quat::from_rotation_y(tyre.steer) * Vec3::X;
        let forward = heading.reject_from(normal).normalize_or_zero();
        let right = forward.cross(normal);
        // The hub with the roll of the car; its turning with the arm is not the tyre's.
        let roll = car.rotation * Vec3::X;
        let patch = velocity.linear + (moves.angular.dot(roll) * roll).cross(point - hub);
        let speed = Vec2::new(patch.dot(forward), patch.dot(right));
        let strongest = TORQUE.min(0.25 * POWER * RADIUS / speed.x.abs().max(1.0));
        let brakes = BRAKES[usize::from(!front)];
        let force = tyre.roll(speed, [pedals.throttle * strongest, pedals.brake * brakes]);
        // Engine and brakes are at the chassis, as are a 2CV's: they turn the car, not the arm.
        on_chassis.torque += (point - hub).cross(force.x * forward);
        *on_wheel = ExternalForce::at_point(force.y * right, point, hub);
        on_wheel.force += force.x * forward;
    }
}

/// What the ground carries of one wheel at rest, N.
pub fn load_at_rest(chassis: f32, gravity: f32) -> f32 {
    (0.25 * chassis + WHEEL) * gravity
}
