//! Computes the preload with which the load of an element stays where it is.

use crate::backend::{Finder, Stance};
use crate::dynamics::guide::Guide;
use crate::dynamics::law::Law;
use crate::element::HoldPose;
use crate::input::check::{Fault, Parameters};
use crate::input::companions::{Companion, Companions};
use bevy::prelude::*;
use std::sync::Arc;

/// Greatest relative difference between the required tension and the tension that the law gives. Pinned by
/// `laws::hold::a_pose_that_cannot_be_held_is_a_fault_that_says_why`.
const NEAR: f64 = 1e-3;

impl Companions<'_, '_> {
    /// Returns the companion of an element with the preload that gives a tension (N) at a length (m), and that preload,
    /// N.
    fn holding(
        &self,
        entity: Entity,
        p: &Parameters,
        guide: Guide,
        [tension, length]: [f64; 2],
    ) -> Result<(Companion, f32), Fault> {
        let fault = |reason| Err(Fault::new("HoldPose", reason));
        let Ok(beside) = self.all.get(entity) else {
            return fault("is gone");
        };
        if p.ties.names.stiffness.is_empty() {
            return fault("stands on a damper without a spring");
        }
        let rest = f64::from(p.numbers.rest_length.unwrap_or(length as f32));
        let mut recipe = beside.recipe(p, guide)?;
        recipe.preload = 0.0;
        let mut bare = recipe.clone();
        bare.limits = [f64::NEG_INFINITY, f64::INFINITY];
        let preload = (tension - Law::new(bare).elastic(length, rest).force) as f32;
        if !preload.is_finite() {
            return Err(Fault::UNSOUND_LAW);
        }
        recipe.preload = f64::from(preload);
        let law = Law::new(recipe);
        let gives = law.elastic(length, rest).force;
        // Beside the force of a stiff spring that is stretched far, f32 may round the preload by more than a small tension.
        let rounding = f64::from(f32::EPSILON * preload.abs());
        if (gives - tension).abs() > NEAR * tension.abs() + 1e-6 + rounding {
            return fault("needs a tension that SpringAction, MaxForce or a stop does not allow");
        }
        let law = (!(beside.is_linear() && preload == 0.0)).then(|| Arc::new(law));
        Ok((Companion { law, guide }, preload))
    }

    /// Computes the preload that holds the load of an element.
    pub(crate) fn hold(
        &self,
        entity: Entity,
        pose: HoldPose,
        parameters: &Parameters,
        stance: &Stance,
        finder: &impl Finder,
    ) -> Result<(Companion, f32), Fault> {
        let held = finder.pose(pose, stance)?;
        self.holding(entity, parameters, stance.guide, held)
    }
}
