//! Continuous collision detection and other Rapier settings of bodies whose element the ground holds.

use super::scenes::*;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Gives both bodies the components of a kind of continuous collision detection.
fn order(scene: &mut Stand, placed: Placed, ccd: &str) {
    for body in [placed.above, placed.below] {
        let world = scene.lab.app.world_mut();
        let mut body = world.entity_mut(body);
        match ccd {
            "hard" => body.insert(Ccd::enabled()),
            "soft" => body.insert(SoftCcd { prediction: 0.3 }),
            "both" => body.insert((Ccd::enabled(), SoftCcd { prediction: 0.05 })),
            _ => &mut body,
        };
    }
}

#[test]
fn with_continuous_collision_detection_nothing_is_won_either() {
    for ccd in ["none", "hard", "soft", "both"] {
        for (name, setup) in [
            ("quarter car on the ground", Footed::quarter_car()),
            (
                "quarter car from 2 m",
                Footed {
                    drop: 2.0,
                    ..Footed::quarter_car()
                },
            ),
            (
                "foot on the ground",
                Footed {
                    drop: 0.0,
                    ..Footed::foot()
                },
            ),
            ("foot from half a metre", Footed::foot()),
            (
                "foot from 5 m",
                Footed {
                    drop: 5.0,
                    rest: 1.5,
                    ..Footed::foot()
                },
            ),
        ] {
            let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
            scene.ground();
            let placed = setup.put(&mut scene);
            order(&mut scene, placed, ccd);
            scene.lab.tick();
            let first = scene.energy() - setup.floor();
            let most = (scene.most(40.0) - setup.floor()) / first;
            let sag = setup.sag_now(&scene) / setup.sag();
            let awake = scene.awake();
            println!("{name}, CCD {ccd}: E × {most:.4}, sag × {sag:.5}, {awake} awake");
            assert!(most < 1.02, "{name} {ccd}: E × {most}");
            assert!((sag - 1.0).abs() < 0.01, "{name} {ccd}: {sag}");
            assert_eq!(awake, 0, "{name} {ccd}: it sleeps");
        }
    }
}

/// State of a body in Rapier: soft CCD prediction in m, additional solver iterations, and the user's force in N.
fn ordered(scene: &mut Stand, body: Entity) -> (f32, usize, Vec3) {
    let world = scene.lab.app.world_mut();
    let mut sets = world.query::<&RapierRigidBodySet>();
    let set = sets.single(world).expect("one context");
    let body = set.bodies.get(set.entity2body()[&body]).expect("the body");
    (
        body.soft_ccd_prediction(),
        body.additional_solver_iterations(),
        body.user_force(),
    )
}

#[test]
fn what_a_user_ordered_of_a_body_is_there_again_afterwards() {
    for seconds in [0.1, 0.4, 1.0, 10.0] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        scene.ground();
        let placed = Footed::foot().put(&mut scene);
        let push = Vec3::new(0.0, -200.0, 0.0);
        for (i, body) in [placed.above, placed.below].into_iter().enumerate() {
            let world = scene.lab.app.world_mut();
            world.entity_mut(body).insert((
                SoftCcd {
                    prediction: 0.01 * (i + 1) as f32,
                },
                AdditionalSolverIterations(3 + i),
                ExternalForce {
                    force: push,
                    ..default()
                },
            ));
        }
        scene.lab.run(seconds);
        let during = ordered(&mut scene, placed.below);
        // The user changes a setting while the element is there.
        scene.lab.get_mut::<SoftCcd>(placed.below).prediction = 0.04;
        scene.lab.run(0.1);
        scene.lab.app.world_mut().despawn(placed.element);
        scene.coils.clear();
        scene.lab.tick();
        scene.lab.tick();
        for (i, body) in [placed.above, placed.below].into_iter().enumerate() {
            let wanted = ([0.01, 0.04][i], 3 + i, push);
            let now = ordered(&mut scene, body);
            println!("after {seconds} s: while it acts {during:?}, afterwards {now:?}");
            assert_eq!(now, wanted, "Rapier's, after {seconds} s");
            assert_eq!(scene.lab.get::<SoftCcd>(body).prediction, wanted.0);
            assert_eq!(
                scene.lab.get::<AdditionalSolverIterations>(body).0,
                wanted.1
            );
            assert_eq!(scene.lab.get::<ExternalForce>(body).force, push);
        }
        assert_eq!(joints(&mut scene), 1, "the guide alone");
    }
}
