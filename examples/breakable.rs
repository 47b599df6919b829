//! Five weights on springs that break at 50 to 250 N. Every second, one more disc is laid on each weight. One spring
//! after another breaks at its own limit, the weakest first, and its weight falls.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, PictureAt, Shape, Stage};

/// Force limits of the springs from left to right, N; deliberately unsorted.
const LIMITS: [f32; 5] = [150.0, 50.0, 250.0, 100.0, 200.0];
const STIFFNESS: f32 = 900.0;
const REST: f32 = 0.7;
/// Mass of a disc, kg.
const DISC: f32 = 2.0;
/// Radius of a disc, m.
const RADIUS: f32 = 0.2;
/// Thickness of a disc, m.
const THICK: f32 = 0.045;
const GRAVITY: f32 = 9.81;
/// Length of the rod that the discs are laid on, m.
const ROD: f32 = 0.66;
/// Height of the beam's underside, m.
const BEAM: f32 = 2.3;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "breakable",
        setup: |app| {
            app.insert_resource(PictureAt(8.35))
                .add_systems(Begin, (stage::fresh::<Breaks>, setup))
                .add_systems(FixedUpdate, load.before(PhysicsSet::SyncBackend))
                .add_observer(snap);
        },
        seconds: 14.0,
        again: 18.0,
        check,
        eye: Vec3::new(0.6, 1.9, 5.4),
        target: Vec3::new(0.0, 1.2, 0.0),
    })
}

/// Breaks: index of the spring, number of discs, and force (N).
#[derive(Resource, Default)]
struct Breaks(Vec<(usize, u32, f32)>);

/// A weight, with its number of discs.
#[derive(Component)]
struct Weight(u32);

/// On a spring: its index in the row.
#[derive(Component)]
struct Place(usize);

fn disc(height: f32) -> impl Bundle {
    (
        Transform::from_xyz(0.0, height, 0.0),
        Shape::Cylinder(RADIUS, 0.9 * THICK, Paint::Blue),
    )
}

fn setup(mut commands: Commands) {
    commands
        .spawn(stage::floor())
        .insert(Collider::cuboid(20.0, 0.05, 20.0));
    let beam = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(0.0, BEAM + 0.06, 0.0),
            Shape::Cuboid(Vec3::new(3.4, 0.12, 0.4), Paint::Iron),
        ))
        .id();
    for (i, limit) in LIMITS.into_iter().enumerate() {
        let x = 0.65 * (i as f32 - 2.0);
        let body = commands
            .spawn((
                RigidBody::Dynamic,
                Collider::cylinder(0.5 * THICK, RADIUS),
                ColliderMassProperties::Mass(DISC),
                Friction::coefficient(0.8),
                // In equilibrium from the start.
                Transform::from_xyz(x, BEAM - REST - DISC * GRAVITY / STIFFNESS - ROD, 0.0),
                Visibility::default(),
                Weight(1),
                children![
                    disc(0.0),
                    (
                        Transform::from_xyz(0.0, 0.5 * ROD, 0.0),
                        Shape::Cylinder(0.018, ROD, Paint::Ivory),
                    ),
                ],
            ))
            .id();
        let wire = 0.009 * (limit / LIMITS[1]).powf(0.4);
        // Critically damped, so that one more disc causes no overshoot.
        commands.spawn((
            SpringDamper::new(beam, body)
                .with_stiffness(STIFFNESS)
                .with_damping(2.0 * (STIFFNESS * 10.0 * DISC).sqrt())
                .with_rest_length(REST),
            SpringAction::Pull,
            Breakable::at_force(limit),
            Anchors::new(Vec3::new(x, -0.06, 0.0), Vec3::Y * ROD),
            Coil::new(0.08, wire, 10.0),
            Place(i),
        ));
    }
}

/// Adds a disc to each weight, once a second.
fn load(
    time: Res<Time>,
    mut weights: Query<(Entity, &mut Weight, &mut ColliderMassProperties)>,
    springs: Query<&SpringDamper>,
    mut commands: Commands,
) {
    if !stage::tick(&time).is_multiple_of(60) {
        return;
    }
    for (entity, mut weight, mut mass) in &mut weights {
        // Skips weights on the ground.
        if springs.iter().any(|s| s.body_b == entity) {
            *mass = ColliderMassProperties::Mass(DISC * (weight.0 + 1) as f32);
            commands
                .entity(entity)
                .with_child(disc(THICK * weight.0 as f32));
            weight.0 += 1;
        }
    }
}

fn snap(
    broke: On<SpringBroke>,
    springs: Query<(&Place, &SpringDamper)>,
    weights: Query<&Weight>,
    mut breaks: ResMut<Breaks>,
) {
    let Ok((place, spring)) = springs.get(broke.entity) else {
        return;
    };
    let discs = weights.get(spring.body_b).map_or(0, |w| w.0);
    println!(
        "  the spring for {} N broke at {:.1} N, {:.3} m long, with {discs} discs",
        LIMITS[place.0], broke.force, broke.length
    );
    breaks.0.push((place.0, discs, broke.force));
}

fn check(world: &mut World) -> Vec<Finding> {
    let held = world.query::<&SpringDamper>().iter(world).count();
    let mut out = vec![Finding::small("springs that held", held as f32, 0.5, "")];
    let breaks = &world.resource::<Breaks>().0;
    let (broken, all) = (breaks.len() as f32, LIMITS.len() as f32);
    out.push(Finding::close("springs that broke", broken, all, "", 1e-3));
    let mut last = 0.0;
    for (i, discs, force) in breaks {
        let limit = LIMITS[*i];
        // The smallest number of discs that weighs more than the limit.
        let wanted = (limit / (DISC * GRAVITY)).ceil();
        let name = format!("the spring for {limit} N: discs");
        out.push(Finding::close(&name, *discs as f32, wanted, "", 1e-3));
        // The force is read once a tick, so it is a little above the limit.
        let most = limit + 0.5 * DISC * GRAVITY;
        out.push(Finding::between("  broke at", *force, limit, most, "N"));
        out.push(Finding::between(
            "  after the one for",
            last,
            0.0,
            limit,
            "N",
        ));
        last = limit;
    }
    out
}
