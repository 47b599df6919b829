//! Predicts how bevy_rapier will step in this tick, before it does.

use super::body::FARTHEST_TURN;
use super::rotation;
use crate::backend::StepPlan;
use bevy_rapier3d::prelude::TimestepMode;
use bevy_rapier3d::rapier::dynamics::IntegrationParameters;

/// Predicts the work of bevy_rapier's `step_simulation` with this mode. `delta` is the time since the last tick, `lag` the time
/// by which the simulation is behind the renderer, s.
pub(crate) fn plan(
    mode: TimestepMode,
    delta: f32,
    lag: f32,
    parameters: &IntegrationParameters,
) -> StepPlan {
    let (time, calls) = calls(mode, delta, lag);
    StepPlan {
        time,
        calls,
        substeps: parameters.num_solver_iterations,
        fastest: f64::from(parameters.max_linear_velocity()),
        farthest_turn: FARTHEST_TURN * f64::from(calls),
        turn: rotation::turn,
        length_unit: parameters.length_unit,
    }
}

/// Simulated time of a tick, s, and its number of pipeline steps.
fn calls(mode: TimestepMode, delta: f32, lag: f32) -> (f64, u32) {
    let plan = |time: f32, steps: usize| {
        let steps = u32::try_from(steps).unwrap_or(u32::MAX);
        let runs = time.is_finite() && time > 0.0 && steps > 0;
        (if runs { f64::from(time) } else { 0.0 }, steps)
    };
    match mode {
        TimestepMode::Fixed { dt, substeps } => plan(dt, substeps),
        TimestepMode::Variable {
            max_dt,
            time_scale,
            substeps,
        } => plan((delta * time_scale).min(max_dt), substeps),
        TimestepMode::Interpolated {
            dt,
            time_scale,
            substeps,
        } => {
            // Same float operations as in bevy_rapier's loop, so that both count the same steps.
            let mut lag = lag + delta;
            let mut calls = 0_u16;
            while lag > 0.0 && dt > 0.0 && calls < u16::MAX {
                calls += 1;
                lag -= dt;
            }
            plan(
                f32::from(calls) * dt * time_scale,
                usize::from(calls) * substeps,
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolated_mode_counts_as_the_engine_does() {
        let mode = TimestepMode::Interpolated {
            dt: 0.01,
            time_scale: 1.0,
            substeps: 2,
        };
        let (time, steps) = calls(mode, 0.025, 0.0);
        assert_eq!(steps, 6);
        assert!((time - 0.03).abs() < 1e-8);
        assert_eq!(calls(mode, 0.004, -0.006).0, 0.0);
    }

    #[test]
    fn a_frame_without_time_steps_nothing() {
        let mode = TimestepMode::default();
        assert_eq!(calls(mode, 0.0, 0.0).0, 0.0);
        assert!(calls(mode, 1.0, 0.0).0 > 0.0);
    }
}
