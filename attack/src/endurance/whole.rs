//! The motion of many bodies as one.

use bevy::math::{DMat3, DVec3};

/// Where a body is and how it moves.
pub(super) struct Moving {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub at: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Angular momentum about its own centre, kg m²/s.
    pub spin: DVec3,
}

/// Kinetic energy that bodies would have with the same momentum and angular momentum if they were one rigid body, J.
pub(super) fn rigid_energy(bodies: &[Moving]) -> f64 {
    let mass: f64 = bodies.iter().map(|body| body.mass).sum();
    let mean = |of: fn(&Moving) -> DVec3| {
        let sum: DVec3 = bodies.iter().map(|body| body.mass * of(body)).sum();
        sum / mass
    };
    let (center, velocity) = (mean(|body| body.at), mean(|body| body.velocity));
    let (mut momentum, mut inertia) = (DVec3::ZERO, DMat3::ZERO);
    for body in bodies {
        let arm = body.at - center;
        momentum += body.spin + body.mass * arm.cross(body.velocity - velocity);
        let square = DMat3::from_diagonal(DVec3::splat(arm.length_squared()));
        inertia += body.mass * (square - DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z));
    }
    0.5 * (mass * velocity.length_squared() + momentum.dot(inertia.inverse() * momentum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_of_points_that_turns_as_one_has_all_its_energy_as_one() {
        let (velocity, turning) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.3, 0.7, -0.2));
        let corner = |i: u32| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let mut bodies: Vec<Moving> = (0..8)
            .map(|i| Moving {
                mass: 1.0 + f64::from(i),
                at: corner(i),
                velocity: velocity + turning.cross(corner(i)),
                spin: DVec3::ZERO,
            })
            .collect();
        let kinetic = |body: &Moving| 0.5 * body.mass * body.velocity.length_squared();
        let all: f64 = bodies.iter().map(kinetic).sum();
        assert!((rigid_energy(&bodies) / all - 1.0).abs() < 1e-12);
        // Two bodies that push each other apart add nothing to it. They have 1 and 2 kg.
        let impulse = 3.0 * (bodies[1].at - bodies[0].at);
        bodies[0].velocity -= impulse;
        bodies[1].velocity += 0.5 * impulse;
        assert!(bodies.iter().map(kinetic).sum::<f64>() > 1.01 * all);
        assert!((rigid_energy(&bodies) / all - 1.0).abs() < 1e-12);
    }
}
