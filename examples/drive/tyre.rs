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

use super::car::*;
use super::driver::Pedals;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::DT;

/// Of the tread against the road, N/m and N s/m.
const TREAD: f32 = 150e3;
const TREAD_DAMPING: f32 = 4e3;
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
/// A contact that is wider open than this, m, is none: so far ahead Rapier looks. Whether it presses, the load says.
const NEAR: f32 = 2e-2;

/// The number of a corner: front left, front right, rear left, rear right.
pub fn place(corner: Vec3) -> usize {
    usize::from(corner.x < 0.0) * 2 + usize::from(corner.z > 0.0)
}

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
    /// Of its coilover, m, and how fast the hub goes up, m/s, a tick ago.
    length: f32,
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

/// Where a wheel touches the road: the normal there; `None` in the air.
fn touches(context: &RapierContext, wheel: Entity) -> Option<Vec3> {
    let mut sum = Vec3::ZERO;
    for pair in context.contact_pairs_with(wheel) {
        let own = pair.collider1() == Some(wheel);
        for manifold in pair.manifolds() {
            // What is deeper counts for more.
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

/// What presses each wheel down, N: coilover, bar, weight, and that the hub goes up and down.
pub fn weigh(
    chassis: Query<&Transform, With<Chassis>>,
    coilovers: Query<(&SpringReadout, &StandsOn)>,
    mut wheels: Query<(Entity, &Transform, &Velocity, &mut Tyre)>,
) {
    let Ok(car) = chassis.single() else {
        return;
    };
    // How high the hubs are on the chassis, in the order of `place`.
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
            // As Rapier's was made.
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

/// Pushes wheels and chassis.
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
