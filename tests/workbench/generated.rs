// Written by the workbench; compared and compiled by its tests.
use bevy::prelude::*;
use crate::prelude::*;

/// spawn plain.
pub fn spawn_plain(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            SpringDamper::new(body_a, body_b).with_stiffness(29430.0).with_damping(1783.5).with_rest_length(0.3),
        ))
        .id()
}

/// spawn rope.
pub fn spawn_rope(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            Spring::new(body_a, body_b).with_stiffness(100000.0),
            Anchors::new(Vec3::ZERO, Vec3::new(0.1, -0.25, 1e-7)),
            SpringAction::Pull,
            Breakable { force: 900.0, length: f32::INFINITY, then: WhenBroken::Disable },
        ))
        .id()
}

/// spawn progressive.
pub fn spawn_progressive(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            SpringDamper::new(body_a, body_b).with_stiffness(29430.0).with_damping(1783.5).with_rest_length(0.3),
            SpringLaw::sided(Polynomial::new(10.0, 0.0, 3.0), Polynomial::new(1.0, 2.0, 0.5)),
            DampingLaw::sided(500.0, 1500.0),
            SpringTravel::new(0.1, f32::INFINITY, 1000000.0).with_progression(2.0).with_stop_damping(30.0),
            SpringAxis::BodyA(Vec3::Y),
            Preload(-120.0),
            MaxForce(5000.0),
            Breakable { force: f32::INFINITY, length: 2.0, then: WhenBroken::Despawn },
        ))
        .id()
}

/// spawn measured.
pub fn spawn_measured(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            SpringDamper::new(body_a, body_b).with_stiffness(29430.0).with_damping(1783.5).with_rest_length(0.3),
            SpringLaw::table([(-0.1, -5.0), (0.0, 0.0), (0.2, 30.0)]),
            DampingLaw::BlowOff { damping: 100.0, knee: 0.2, beyond: 10.0 },
            SpringAxis::World(Vec3::new(1.0, 1.0, 0.0)),
        ))
        .id()
}

/// spawn orifice.
pub fn spawn_orifice(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            Damper::new(body_a, body_b).with_damping(3.0),
            DampingLaw::Quadratic { linear: 1.0, quadratic: 20.0 },
        ))
        .id()
}

/// spawn bar.
pub fn spawn_bar(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            TorsionSpringDamper::new(body_a, body_b, Vec3::Z).with_stiffness(40.0).with_damping(0.5).with_rest_angle(-1.0),
        ))
        .id()
}

/// spawn clock.
pub fn spawn_clock(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            TorsionSpring::new(body_a, body_b, Vec3::new(0.0, 0.6, 0.8)).with_stiffness(0.02),
        ))
        .id()
}

/// spawn brake.
pub fn spawn_brake(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {
    commands
        .spawn((
            TorsionDamper::new(body_a, body_b, Vec3::X).with_damping(1.0),
            DampingLaw::table([(-1.0, -2.0), (0.0, 0.0), (1.0, 3.0)]),
        ))
        .id()
}
