//! Preloaded and breakable springs under the shock of a landing.

use super::scenes::*;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[derive(Resource, Default)]
struct Broken(Vec<SpringBroke>);

/// A scene with ground that records every break in [`Broken`].
fn stand() -> Stand {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene
        .lab
        .app
        .init_resource::<Broken>()
        .add_observer(|broke: On<SpringBroke>, mut all: ResMut<Broken>| all.0.push(*broke));
    scene.ground();
    scene
}

/// Peak force of an undamped spring that stops the load after a fall of `setup.drop`, N.
fn peak(setup: &Footed) -> f64 {
    let (m, k) = (f64::from(setup.load), f64::from(setup.law[0]));
    let weight = m * GRAVITY;
    let fall = 2.0 * weight * f64::from(setup.drop);
    weight + (weight * weight + k * fall).sqrt()
}

#[test]
fn a_landing_breaks_a_weak_spring_once_and_a_strong_one_never() {
    for drop in [0.2, 0.5, 1.0] {
        for (share, breaks) in [(0.3, 1), (0.7, 1), (1.1, 0)] {
            for disabling in [false, true] {
                let setup = Footed {
                    drop,
                    rest: 1.0,
                    ..Footed::foot()
                };
                let mut scene = stand();
                let placed = setup.put(&mut scene);
                let most_force = share * peak(&setup) as f32;
                let mut limit = Breakable::at_force(most_force);
                if disabling {
                    limit = limit.disabling();
                }
                let world = scene.lab.app.world_mut();
                world.entity_mut(placed.element).insert(limit);
                // After a break nothing holds the load, so it needs a collider to land on the foot.
                world.entity_mut(placed.above).insert((
                    Collider::cuboid(0.1, 0.1, 0.1),
                    ColliderMassProperties::Mass(0.0),
                ));
                scene.lab.tick();
                let first = scene.energy() - setup.floor();
                let mut most = 0.0_f64;
                let count = |scene: &Stand| scene.lab.app.world().resource::<Broken>().0.len();
                for _ in 0..scene.lab.ticks(15.0) {
                    scene.lab.tick();
                    if count(&scene) > 0 {
                        scene.coils.clear();
                    }
                    most = most.max((scene.energy() - setup.floor()) / first);
                }
                let told = &scene.lab.app.world().resource::<Broken>().0;
                let force = told.first().map_or(0.0, |broke| broke.force);
                println!(
                    "drop of {drop} m, breaks at {most_force:.0} N ({share} of the peak), disabling {disabling}: {} breaks at {force:.0} N, E × {most:.4}",
                    told.len()
                );
                assert_eq!(told.len(), breaks, "{drop} {share}: {told:?}");
                assert!(breaks == 0 || force.abs() > most_force);
                assert!(most < 1.02, "{drop} {share}: E × {most}");
                if breaks == 1 {
                    assert_eq!(joints(&mut scene), 1, "the guide alone");
                } else {
                    let sag = setup.sag_now(&scene) / setup.sag();
                    assert!((sag - 1.0).abs() < 0.01, "{drop} {share}: {sag}");
                }
            }
        }
    }
}

#[test]
fn a_preload_lifts_what_stands_on_it_and_wins_nothing() {
    for (name, plain) in [
        ("quarter car", Footed::quarter_car()),
        ("foot", Footed::foot()),
    ] {
        for share in [0.3_f32, 1.0, 1.5] {
            for drop in [0.0, 0.3] {
                let setup = Footed {
                    drop,
                    ..plain.clone()
                };
                let preload = -share * setup.load * GRAVITY as f32;
                let mut scene = stand();
                let placed = setup.put(&mut scene);
                let world = scene.lab.app.world_mut();
                world.entity_mut(placed.element).insert(Preload(preload));
                let sag = setup.sag() * f64::from(1.0 - share);
                let preload = f64::from(preload);
                let energy = |scene: &Stand| scene.energy() - preload * setup.sag_now(scene);
                // Energy at rest.
                let lift = setup.sag() - sag;
                let k = f64::from(setup.law[0]);
                let floor = setup.floor() - 0.5 * k * setup.sag().powi(2)
                    + f64::from(setup.load) * GRAVITY * lift
                    + 0.5 * k * sag * sag
                    - preload * sag;
                scene.lab.tick();
                // With a preload equal to the weight the scene starts at rest. Its energy is then
                // compared with that of the plain sag.
                let least = 0.5 * k * setup.sag().powi(2);
                let first = (energy(&scene) - floor).max(least);
                let mut most = f64::NEG_INFINITY;
                for _ in 0..scene.lab.ticks(15.0) {
                    scene.lab.tick();
                    most = most.max((energy(&scene) - floor) / first);
                }
                let off = (setup.sag_now(&scene) - sag) / setup.sag();
                let (force, awake) = (scene.lab.readout(placed.element).force(), scene.awake());
                println!(
                    "{name} from {drop} m, preload {share} of the weight: {off:.1e} of the sag off, E × {most:.4}, {force:.0} N, {awake} awake"
                );
                assert!(off.abs() < 0.01, "{name} {share} {drop}: {off}");
                assert!(most < 1.02, "{name} {share} {drop}: E × {most}");
                assert_eq!(awake, 0, "{name} {share} {drop}: it sleeps");
            }
        }
    }
}
