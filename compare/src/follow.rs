//! Runs a problem with a method and measures its error against the true motion.

use crate::method::Setting;
use crate::problem::{Kind, Problem};
use crate::rig::{Rig, State};
use bevy::math::{DMat3, DVec3};

/// Errors of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strayed {
    /// Largest distance of a watched body from its true position, m.
    pub error: f64,
    /// Largest change of energy, divided by the scene's `energy`. `None` where energy is not conserved.
    pub energy: Option<f64>,
    /// Largest change of linear or angular momentum, divided by the initial angular momentum. `None` where
    /// gravity or a fixed body acts.
    pub momentum: Option<f64>,
    /// Whether the error exceeded ten times the motion's size or was NaN.
    pub diverged: bool,
}

/// Runs a problem to its end, or until the method diverges.
pub fn follow(problem: &Problem, setting: Setting) -> Strayed {
    let mut rig = Rig::new(problem, setting);
    let mut strayed = Strayed {
        error: 0.0,
        energy: None,
        momentum: None,
        diverged: false,
    };
    let isolated = problem.gravity == bevy::math::Vec3::ZERO
        && problem.bodies.iter().all(|b| b.inverse_mass() > 0.0);
    let first = Balance::of(problem, |i| initial(problem, i));
    let steps = (problem.seconds / setting.dt()).round() as u64;
    for step in 1..=steps {
        rig.tick();
        let time = step as f64 * setting.dt();
        if let Some(places) = (problem.truth.at)(time) {
            for (body, place) in problem.truth.watched.iter().zip(places) {
                let off = rig.state(*body).position.distance(place);
                // Not `f64::max`, which would ignore a NaN.
                if off > strayed.error || off.is_nan() {
                    strayed.error = off;
                }
            }
        }
        if strayed.error > 10.0 * problem.size || strayed.error.is_nan() {
            strayed.diverged = true;
            break;
        }
        if problem.energy.is_none() && !isolated {
            continue;
        }
        let now = Balance::of(problem, |i| rig.state(i));
        if let Some(scale) = problem.energy {
            let drift = (now.energy - first.energy).abs() / scale;
            strayed.energy = Some(strayed.energy.map_or(drift, |e| e.max(drift)));
        }
        if isolated {
            let drift = (now.linear - first.linear)
                .length()
                .max((now.angular - first.angular).length())
                / first.angular.length();
            strayed.momentum = Some(strayed.momentum.map_or(drift, |m| m.max(drift)));
        }
    }
    strayed
}

fn initial(problem: &Problem, body: usize) -> State {
    let body = &problem.bodies[body];
    State {
        position: body.at.as_dvec3(),
        rotation: bevy::math::DQuat::IDENTITY,
        velocity: body.velocity.as_dvec3(),
        spin: body.spin.as_dvec3(),
    }
}

/// Conserved quantities: energy (J), linear momentum (kg m/s) and angular momentum (kg m²/s).
struct Balance {
    energy: f64,
    linear: DVec3,
    angular: DVec3,
}

impl Balance {
    fn of(problem: &Problem, state: impl Fn(usize) -> State) -> Self {
        let mut sum = Self {
            energy: 0.0,
            linear: DVec3::ZERO,
            angular: DVec3::ZERO,
        };
        for (i, body) in problem.bodies.iter().enumerate() {
            let Kind::Free { mass, inertia } = body.kind else {
                continue;
            };
            let (s, mass) = (state(i), f64::from(mass));
            let turn = DMat3::from_quat(s.rotation);
            let spin = turn * (inertia.as_dvec3() * (turn.transpose() * s.spin));
            let push = mass * s.velocity;
            sum.energy += 0.5 * (push.dot(s.velocity) + spin.dot(s.spin))
                - mass * problem.gravity.as_dvec3().dot(s.position);
            sum.linear += push;
            sum.angular += s.position.cross(push) + spin;
        }
        for link in &problem.links {
            let [a, b] = [0, 1].map(|end| {
                let s = state(link.ends[end]);
                s.position + s.rotation * link.anchors[end].as_dvec3()
            });
            let stretch = a.distance(b) - f64::from(link.rest);
            sum.energy += 0.5 * f64::from(link.stiffness) * stretch * stretch
                + 0.25 * f64::from(link.cubic) * stretch.powi(4);
        }
        sum
    }
}
