//! How the engine is about to step.

use crate::dynamics::delivery::Schedule;
use bevy_rapier3d::prelude::TimestepMode;

/// One call of Rapier's step system: total time, and how many pipeline steps it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    /// Seconds; 0 where nothing will be stepped.
    pub time: f64,
    pub pipeline_steps: u32,
}

impl Plan {
    /// Says what bevy_rapier's `step_simulation` will do with this mode, the time since the last
    /// tick, and the lag of the simulation behind the renderer.
    pub(super) fn new(mode: TimestepMode, delta: f32, lag: f32) -> Self {
        let plan = |time: f32, steps: usize| {
            let steps = u32::try_from(steps).unwrap_or(u32::MAX);
            let runs = time.is_finite() && time > 0.0 && steps > 0;
            Self {
                time: if runs { f64::from(time) } else { 0.0 },
                pipeline_steps: steps,
            }
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
                // The same float operations as the engine's loop, so that both count alike.
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

    /// The substeps of a body that the engine solves with so many iterations a pipeline step.
    pub(super) fn schedule(&self, iterations: usize) -> Schedule {
        let iterations = u32::try_from(iterations.max(1)).unwrap_or(u32::MAX);
        let substeps = iterations.saturating_mul(self.pipeline_steps.max(1));
        Schedule::new(self.time, substeps)
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
        let plan = Plan::new(mode, 0.025, 0.0);
        assert_eq!(plan.pipeline_steps, 6);
        assert!((plan.time - 0.03).abs() < 1e-8);
        assert_eq!(Plan::new(mode, 0.004, -0.006).time, 0.0);
    }

    #[test]
    fn a_frame_without_time_steps_nothing() {
        let mode = TimestepMode::default();
        assert_eq!(Plan::new(mode, 0.0, 0.0).time, 0.0);
        assert!(Plan::new(mode, 1.0, 0.0).time > 0.0);
    }
}
