//! The force of a tyre on the road.
//!
//! Rapier's rolling contacts do not hold at the speed of this car. Rapier turns no body by more than an eighth of a
//! turn in a step, which is 15 m/s for these wheels: above that they slide. And a contact point stays on the wheel
//! for a whole step and rises with it, so a wheel sinks by 27 mm at 12 m/s. The wheel of this example is therefore a
//! ball without friction that does not turn. Rapier's contacts carry its load, and a slip model of the tyre gives the
//! forces along the road.
//!
//! The tread is a spring along the road and across it. The sliding of the road below the wheel stretches it, rolling
//! lays it down anew, and friction limits its force. While the wheel rolls, the force is a stiffness times the slip.
//! At rest the tread is a spring, so a car with its brakes on does not creep.

use super::car::*;
use super::driver::Pedals;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::DT;

/// Stiffness of the tread against the road, N/m.
const TREAD: f32 = 150e3;
/// Damping of the tread against the road, N s/m.
const TREAD_DAMPING: f32 = 4e3;
/// Relaxation length of the tread, m. With the stiffness: 60 kN for each unit of slip.
const RELAXATION: f32 = 0.4;
/// Coefficient of friction of rubber on asphalt.
const FRICTION: f32 = 1.1;
/// Moment of inertia of a wheel with its tyre about its axle, kg m².
const INERTIA: f32 = 1.3;
/// Substeps per tick for the wheel's spin: its small inertia needs a finer step than the car.
const STEPS: u32 = 16;
/// Power of the engine, W. It drives all four wheels.
const POWER: f32 = 220e3;
/// Greatest torque of the engine at one wheel, N m.
const TORQUE: f32 = 700.0;
/// Greatest brake torque of a front and of a rear wheel, N m.
const BRAKES: [f32; 2] = [1_500.0, 1_000.0];
/// Gap from which a contact point counts as open, m: Rapier's contact prediction distance. Whether the wheel presses
/// on the road follows from `Tyre::load`.
const NEAR: f32 = 2e-2;

/// Returns the index of a corner: front left, front right, rear left, rear right.
pub fn place(corner: Vec3) -> usize {
    usize::from(corner.x < 0.0) * 2 + usize::from(corner.z > 0.0)
}

/// State of the tyre of a wheel.
#[derive(Component)]
pub struct Tyre {
    /// Position of the wheel on the chassis, m.
    pub corner: Vec3,
    /// Steering angle, positive to the left, rad.
    pub steer: f32,
    /// Rate of rotation, positive forwards, rad/s.
    pub spin: f32,
    /// Angle turned, rad.
    pub angle: f32,
    /// Deflection of the tread forwards and to the right, m.
    tread: Vec2,
    /// Load on the road, N; 0 in the air.
    pub load: f32,
    /// Length of the coilover in the last tick, m.
    length: f32,
    /// Vertical velocity of the hub in the last tick, m/s.
    rises: f32,
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
            length: LENGTH,
            rises: 0.0,
        }
    }

    /// Advances the tyre by one tick. `speed` is the hub's velocity over the road, forwards and to the right. Returns
    /// the force on the wheel in the same directions, N.
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
            let force = (-TREAD * self.tread - TREAD_DAMPING * rate).clamp_length_max(most);
            self.tread = self.tread.clamp_length_max(most / TREAD);
            let free = self.spin + step / INERTIA * (engine - force.x * RADIUS);
            let held = brake * step / INERTIA;
            self.spin = free - free.clamp(-held, held);
            self.angle += self.spin * step;
            sum += force / STEPS as f32;
        }
        sum
    }
}

/// Returns the normal of the road where a wheel touches it, or `None` in the air.
fn touches(context: &RapierContext, wheel: Entity) -> Option<Vec3> {
    let mut sum = Vec3::ZERO;
    for pair in context.contact_pairs_with(wheel) {
        let own = pair.collider1() == Some(wheel);
        for manifold in pair.manifolds() {
            // A deeper contact counts for more.
            let nearest = manifold.find_deepest_contact().map_or(NEAR, |p| p.dist());
            let normal = if own {
                -manifold.normal()
            } else {
                manifold.normal()
            };
            sum += (NEAR - nearest).max(0.0) * normal;
        }
    }
    sum.try_normalize()
}

/// Computes the load of each wheel, N, from coilover, bar, weight and vertical acceleration of the hub.
pub fn weigh(
    chassis: Query<&Transform, With<Chassis>>,
    coilovers: Query<(&SpringReadout, &StandsOn)>,
    mut wheels: Query<(Entity, &Transform, &Velocity, &mut Tyre)>,
) {
    let Ok(car) = chassis.single() else {
        return;
    };
    // Heights of the hubs in the chassis' frame, in the order of `place`.
    let mut heights = [0.0; 4];
    for (_, at, _, tyre) in &wheels {
        let on_car = car.rotation.inverse() * (at.translation - car.translation);
        heights[place(tyre.corner)] = on_car.y;
    }
    for (wheel, at, velocity, mut tyre) in &mut wheels {
        let [a, b] = ends(tyre.corner);
        let length = car.transform_point(a).distance(at.transform_point(b));
        let rate = (length - tyre.length) / DT;
        tyre.length = length;
        let ours = coilovers.iter().find(|(_, on)| on.0 == wheel);
        let pushes = match ours {
            Some((readout, _)) => -readout.force(),
            // The force of Rapier's spring joint, from the values that `rapier_spring` gave it.
            None => {
                let sag = 0.25 * CHASSIS * GRAVITY;
                sag + STIFFNESS * (LENGTH - length) - 0.5 * (BUMP + REBOUND) * rate
            }
        };
        let own = place(tyre.corner);
        let bar = BARS[own / 2] * (heights[own] - heights[own ^ 1]) / ARM.powi(2);
        let rises = (velocity.linear.y - tyre.rises) / DT;
        tyre.rises = velocity.linear.y;
        tyre.load = (pushes + bar + WHEEL * (GRAVITY + rises)).max(0.0);
    }
}

/// Applies the forces of the tyres to wheels and chassis.
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
    for (wheel, at, velocity, mut on_wheel, mut tyre) in &mut wheels {
        let hub = at.translation;
        let touched = touches(&context, wheel);
        if touched.is_none() {
            tyre.load = 0.0;
        }
        let normal = touched.unwrap_or(Vec3::Y);
        let point = hub - RADIUS * normal;
        let front = tyre.corner.x > 0.0;
        tyre.steer = if front { pedals.steer } else { 0.0 };
        let heading = car.rotation * Quat::from_rotation_y(tyre.steer) * Vec3::X;
        let forward = heading.reject_from(normal).normalize_or_zero();
        let right = forward.cross(normal);
        // The velocity of the hub, plus that from the roll of the car. The rotation of the wheel body is that of the
        // arm, not of the tyre.
        let roll = car.rotation * Vec3::X;
        let patch = velocity.linear + (moves.angular.dot(roll) * roll).cross(point - hub);
        let speed = Vec2::new(patch.dot(forward), patch.dot(right));
        let strongest = TORQUE.min(0.25 * POWER * RADIUS / speed.x.abs().max(1.0));
        let brakes = BRAKES[usize::from(!front)];
        let force = tyre.roll(speed, [pedals.throttle * strongest, pedals.brake * brakes]);
        // Engine and brakes are mounted on the chassis, as in a Citroën 2CV: their torque turns the car, not the arm.
        on_chassis.torque += (point - hub).cross(force.x * forward);
        *on_wheel = ExternalForce::at_point(force.y * right, point, hub);
        on_wheel.force += force.x * forward;
    }
}

/// Returns the load of one wheel at rest, N.
pub fn load_at_rest(chassis: f32, gravity: f32) -> f32 {
    (0.25 * chassis + WHEEL) * gravity
}
