//! Computes stiffness and damping for a `SpringTuning` from the masses at the ends, once, when the element is found.

use super::body::{handle, is_movable, point_of, read, turning_of};
use super::find::RapierFinder;
use crate::backend::rapier::held::{Holding, inverse_mass};
use crate::backend::{Allowance, Place, Stance, Wrench};
use crate::dynamics::body::Body;
use crate::dynamics::element::{Element, End, Path};
use crate::dynamics::guide::Guide;
use crate::dynamics::line::Line;
use crate::element::SpringTuning;
use crate::input::check::{Fault, Parameters};
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;

/// Acceleration of a load along its element without the element, as a share of gravity (for a twist per metre), above which the
/// element is loaded. Below it there is rounding only: on an arm of 1 m, Rapier's f32 positions give such a share about 250 m from the
/// origin. With more, light loads would be refused. Pinned by `laws::unloaded`.
const LOADED: f64 = 1e-5;

/// Why no stiffness gives the sag.
const UNLOADED: &str = "asks for a sag where no weight loads the element in its present pose, or it is not clear which end is \
                        the load; use SpringTuning::Frequency, or give the stiffness";

/// The bodies on which an element acts, and its line.
pub(crate) struct Lever {
    pub line: Line,
    /// The movable bodies at its ends, with gravity.
    pub bodies: Vec<Body>,
    /// The engine's handles of `bodies`.
    pub handles: Vec<RigidBodyHandle>,
    /// Entity of the Rapier context.
    pub context: Entity,
    /// Whether one of `bodies` has colliders.
    can_touch: bool,
}

impl Lever {
    /// Gravity on the ends with their gravity scales, m/s²; the greater one if they differ.
    fn gravity(&self) -> f64 {
        let each = self.bodies.iter().map(|body| body.acceleration.length());
        each.fold(0.0, f64::max)
    }
}

impl RapierFinder<'_, '_> {
    /// Writes the coefficients that `tuning` asks for into `parameters`. A sag also sets the rest length if there is none, so that
    /// the stretch gives what the preload does not give of the tension. Returns whether contacts may hold the ends.
    pub(crate) fn tuned(
        &self,
        tuning: SpringTuning,
        stance: &Stance,
        allowed: Allowance,
        parameters: &mut Parameters,
    ) -> Result<bool, Fault> {
        let guide = stance.guide;
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
        if parameters.ties.names.stiffness.is_empty() {
            return fault("stands on a damper without a spring");
        }
        let lever = self.lever(stance).map(|lever| {
            let left = self.left(&lever, lever.line);
            (lever, left)
        });
        let Some((lever, left)) = lever.filter(|(_, left)| *left > 0.0) else {
            return fault("stands on an element whose ends cannot move or coincide");
        };
        let (gravity, carried) = match tuning {
            SpringTuning::Frequency { .. } => (0.0, None),
            SpringTuning::Sag { .. } => self.load_of(&lever, left, guide)?,
        };
        let beyond = carried.map_or(0.0, |tension| allowed.beyond(tension));
        if beyond * left > LOADED * gravity {
            return fault("needs a tension that SpringAction or MaxForce does not allow");
        }
        let (stiffness, damping) = tuning.coefficients(left.recip() as f32, gravity as f32);
        parameters.numbers.stiffness = stiffness;
        if !parameters.ties.names.damping.is_empty() {
            parameters.numbers.damping = damping;
        }
        let stretch = carried.map(|tension| (tension - allowed.preload) / f64::from(stiffness));
        if let Some(stretch) = stretch.filter(|stretch| stretch.is_finite())
            && parameters.numbers.rest_length.is_none()
        {
            let rest = lever.line.distance() - stretch;
            if guide == Guide::Centres && rest < 0.0 {
                return fault("has a sag that is longer than the element");
            }
            parameters.numbers.rest_length = Some(rest as f32);
        }
        Ok(lever.can_touch)
    }

    /// Returns the gravity that makes the load of an element from its effective mass, m/s² (for a twist rad/s²), and the tension
    /// with which it carries its load in the present pose, N, if it is clear which end is the load. `left` is the inverse of the
    /// effective mass.
    fn load_of(&self, lever: &Lever, left: f64, guide: Guide) -> Result<(f64, Option<f64>), Fault> {
        let fault = |reason| Err(Fault::new("SpringTuning", reason));
        let gravity = lever.gravity();
        if gravity == 0.0 {
            return fault("asks for a sag where no gravity acts on the ends");
        }
        let one_sided = |end: usize| {
            let mut line = lever.line;
            line.holds[1 - end].body = None;
            self.left(lever, line)
        };
        let load = lever.load(one_sided);
        let carried = load.and_then(|end| self.tension_alone(lever, end, None));
        let tension = carried.map(|(tension, _)| tension);
        if !(guide.is_twist() || carried.is_some_and(|(_, helped)| helped)) {
            return Ok((gravity, tension));
        }
        // On a lever, the load is not the weight of the effective mass, which is an inertia.
        let along = tension.map_or(0.0, |tension| tension.abs() * left);
        if along > LOADED * gravity && along.is_finite() {
            Ok((along, tension))
        } else {
            fault(UNLOADED)
        }
    }

    /// Inverse mass along a line that joints and contacts leave, 1/kg.
    fn left(&self, lever: &Lever, line: Line) -> f64 {
        let Ok((set, colliders, joints, simulation)) = self.sets.get(lever.context) else {
            return 0.0;
        };
        let all = Holding {
            contacts: true,
            bodies: &set.bodies,
            joints,
            colliders: &colliders.colliders,
            narrow: &simulation.narrow_phase,
            gravity: Vec3::ZERO,
        };
        inverse_mass(&line, |body| lever.handles[body], all)
    }

    /// Gravity of the context that contains an element's ends, m/s².
    fn gravity_at(&self, places: &[Place; 2]) -> Vec3 {
        let on = |place: &Place| match place {
            Place::OnBody { context, .. } => Some(*context),
            Place::Point(_) => None,
        };
        let context = places.iter().find_map(on);
        let configuration = context.and_then(|context| self.configurations.get(context).ok());
        configuration.map_or(Vec3::ZERO, |configuration| configuration.gravity)
    }

    /// An element's present line and bodies. `None` if it has no line or neither end can move.
    pub(crate) fn lever(&self, stance: &Stance) -> Option<Lever> {
        let places = stance.places;
        let (mut bodies, mut handles) = (Vec::new(), Vec::new());
        let mut context = None;
        let mut can_touch = false;
        let gravity = self.gravity_at(places);
        let ends = places.map(|place| match place {
            Place::Point(at) => End::Path(Path::straight(at, DVec3::ZERO)),
            Place::OnBody {
                body,
                context: here,
                local,
                ..
            } => {
                let of = handle(body);
                let set = self.sets.get(here).ok();
                let Some(body) = set.as_ref().and_then(|parts| parts.0.bodies.get(of)) else {
                    return End::Path(Path::straight(DVec3::ZERO, DVec3::ZERO));
                };
                if !is_movable(body) {
                    let (at, _) = point_of(body, local);
                    let mut path = Path::straight(at, DVec3::ZERO);
                    (path.rotation, _) = turning_of(body, 1.0);
                    return End::Path(path);
                }
                context = Some(here);
                can_touch |= !body.colliders().is_empty();
                handles.push(of);
                let none = Wrench::default();
                bodies.push(read(body, gravity, &none, true));
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
            guide: stance.guide,
            law: None,
            angle: stance.angle,
            heat: 0.0,
            work: 0.0,
            direction: None,
            stiff_damper: false,
        };
        let line = element.line(&bodies)?;
        Some(Lever {
            line,
            bodies,
            handles,
            context: context?,
            can_touch,
        })
    }
}
