//! Physics without rendering, stepped by hand, as a game's own CI could test its springs.
//!
//! A 2 kg body on 80 N/m must oscillate at √(k/m)/2π and keep its amplitude. Otherwise the program fails.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

const TICKS: u32 = 600;

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        CoiloverPlugin::at_hz(60.0),
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
    ));
    // One fixed tick per update, whatever the clock says.
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(tick));

    let hook = app.world_mut().spawn(Transform::default()).id();
    let body = app
        .world_mut()
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(2.0),
            Transform::from_xyz(0.0, -1.0, 0.0),
        ))
        .id();
    let spring = app
        .world_mut()
        .spawn(
            Spring::new(hook, body)
                .with_stiffness(80.0)
                .with_rest_length(1.0),
        )
        .id();

    app.update();
    let mut lengths = Vec::new();
    for _ in 0..TICKS {
        app.update();
        let readout = app.world().get::<SpringReadout>(spring);
        lengths.push(readout.map_or(f32::NAN, |r| r.length));
    }

    let middle = 1.0 + 2.0 * 9.81 / 80.0;
    let crossings: Vec<f32> = lengths
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0] < middle && w[1] >= middle)
        .map(|(i, w)| (i as f32 + (middle - w[0]) / (w[1] - w[0])) / 60.0)
        .collect();
    let periods = crossings.len().saturating_sub(1);
    let span = crossings
        .last()
        .zip(crossings.first())
        .map_or(0.0, |(b, a)| b - a);
    let measured = periods as f32 / span;
    let theory = (80.0_f32 / 2.0).sqrt() / TAU;
    let longest = lengths[TICKS as usize - 70..]
        .iter()
        .fold(0.0, |a: f32, b| a.max(*b));
    println!("frequency: measured {measured:.5} Hz, theory {theory:.5} Hz");
    println!(
        "longest in the last second: {longest:.5} m, theory {:.5} m",
        2.0 * middle - 1.0
    );
    let good =
        (measured / theory - 1.0).abs() < 1e-3 && (longest - 2.0 * middle + 1.0).abs() < 5e-3;
    println!(
        "{}",
        if good {
            "as theory says"
        } else {
            "NOT as theory says"
        }
    );
    if good {
        AppExit::Success
    } else {
        AppExit::error()
    }
}
