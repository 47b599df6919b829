//! Stiffness and damping worked out from the masses at the ends, once.

use super::check::{Fault, Parameters};
use super::ends::Place;
use super::find::Finder;
use crate::dynamics::element::{Element, End, Path};
use crate::dynamics::guide::Guide;
use crate::element::SpringTuning;
use bevy::math::DVec3;
use bevy::prelude::*;

impl Finder<'_, '_> {
    /// Puts the coefficients that a tuning asks for into an element's numbers.
    pub(super) fn tune(
        &mut self,
        tuning: SpringTuning,
        guide: Guide,
        places: &[Place; 2],
        parameters: &mut Parameters,
    ) -> Result<(), Fault> {
        let fault = |reason| Err(Fault::new("SpringTuning", reason));
        let (value, ratio) = match tuning {
            SpringTuning::Frequency {
                frequency,
                damping_ratio,
            } => (frequency, damping_ratio),
            SpringTuning::Sag { sag, damping_ratio } => (sag, damping_ratio),
        };
        if !(value > 0.0 && value.is_finite() && ratio >= 0.0 && ratio.is_finite()) {
            return fault("has a number that is negative, zero or not finite");
        }
        if parameters.names.stiffness.is_empty() {
            return fault("stands on a damper without a spring");
        }
        let Some((inverse_mass, context)) = self.inverse_mass(guide, places) else {
            return fault("stands on an element whose ends cannot move or coincide");
        };
        let gravity = self
            .configurations
            .get(context)
            .map_or(0.0, |configuration| configuration.gravity.length());
        let mass = inverse_mass.recip() as f32;
        let (stiffness, damping) = tuning.coefficients(mass, gravity);
        parameters.stiffness = stiffness;
        if !parameters.names.damping.is_empty() {
            parameters.damping = damping;
        }
        Ok(())
    }

    /// Of the ends together along the line, and the Rapier context that they are in.
    fn inverse_mass(&mut self, guide: Guide, places: &[Place; 2]) -> Option<(f64, Entity)> {
        let mut bodies = Vec::new();
        let mut context = None;
        let ends = places.map(|place| match place {
            Place::Point(at) => End::Path(Path::straight(at, DVec3::ZERO)),
            Place::OnBody {
                handle,
                context: here,
                local,
                ..
            } => {
                let set = self.sets.get(here).ok();
                let Some(body) = set.as_ref().and_then(|(set, _)| set.bodies.get(handle)) else {
                    return End::Path(Path::straight(DVec3::ZERO, DVec3::ZERO));
                };
                if !super::body::is_movable(body) {
                    let (at, _) = super::body::point_of(body, local);
                    let mut path = Path::straight(at, DVec3::ZERO);
                    (path.rotation, _) = super::body::turning_of(body, 1.0);
                    return End::Path(path);
                }
                context = Some(here);
                let none = bevy_rapier3d::prelude::ExternalForce::default();
                bodies.push(super::body::read(body, Vec3::ZERO, &none, true));
                End::Body {
                    index: bodies.len() - 1,
                    arm: local - body.local_center_of_mass().as_dvec3(),
                }
            }
        });
        let element = Element {
            ends,
            stiffness: 0.0,
            damping: 0.0,
            rest_length: 1.0,
            guide,
            law: None,
            angle: 0.0,
            heat: 0.0,
            work: 0.0,
            direction: None,
            stiff_damper: false,
        };
        let line = element.line(&bodies)?;
        Some((line.inverse_mass, context?)).filter(|(w, _)| *w > 0.0)
    }
}
