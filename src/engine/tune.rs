//! Stiffness and damping worked out from the masses at the ends, once.

use super::check::{Fault, Parameters};
use super::ends::Place;
use super::find::Finder;
use super::inside::{Holding, inverse_mass};
use crate::dynamics::element::{Element, End, Path};
use crate::dynamics::guide::Guide;
use crate::element::SpringTuning;
use bevy::math::DVec3;
use bevy::prelude::*;

/// What an element acts on.
struct Lever {
    /// Of both ends along the line, with what joints and contacts leave, 1/kg.
    inverse_mass: f64,
    /// The Rapier context.
    context: Entity,
    /// A body of it has colliders.
    can_touch: bool,
}

impl Finder<'_, '_> {
    /// Puts the coefficients that a tuning asks for into an element's numbers; says whether contacts may hold its ends.
    pub(super) fn tune(
        &mut self,
        tuning: SpringTuning,
        guide: Guide,
        places: &[Place; 2],
        parameters: &mut Parameters,
    ) -> Result<bool, Fault> {
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
        let Some(Lever {
            inverse_mass,
            context,
            can_touch,
        }) = self.lever(guide, places)
        else {
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
        Ok(can_touch)
    }

    fn lever(&mut self, guide: Guide, places: &[Place; 2]) -> Option<Lever> {
        let (mut bodies, mut handles) = (Vec::new(), Vec::new());
        let mut context = None;
        let mut can_touch = false;
        let ends = places.map(|place| match place {
            Place::Point(at) => End::Path(Path::straight(at, DVec3::ZERO)),
            Place::OnBody {
                handle,
                context: here,
                local,
                ..
            } => {
                let set = self.sets.get(here).ok();
                let Some(body) = set.as_ref().and_then(|parts| parts.0.bodies.get(handle)) else {
                    return End::Path(Path::straight(DVec3::ZERO, DVec3::ZERO));
                };
                if !super::body::is_movable(body) {
                    let (at, _) = super::body::point_of(body, local);
                    let mut path = Path::straight(at, DVec3::ZERO);
                    (path.rotation, _) = super::body::turning_of(body, 1.0);
                    return End::Path(path);
                }
                context = Some(here);
                can_touch |= !body.colliders().is_empty();
                handles.push(handle);
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
        let context = context?;
        let (set, colliders, joints, simulation) = self.sets.get(context).ok()?;
        let all = Holding {
            contacts: true,
            bodies: &set.bodies,
            joints,
            colliders: &colliders.colliders,
            narrow: &simulation.narrow_phase,
        };
        let inverse_mass = inverse_mass(&line, |body| handles[body], all);
        let lever = Lever {
            inverse_mass,
            context,
            can_touch,
        };
        Some(lever).filter(|lever| lever.inverse_mass > 0.0)
    }
}
