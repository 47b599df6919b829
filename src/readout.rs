//! What a game reads back from an element.

use crate::dynamics::tolerance::Method;
use crate::scene::rows::Solved;
use bevy::prelude::*;

/// The state of an element after the last step, on every element without asking. SI units.
///
/// Forces are the element's own, tension positive. On torsion elements angles stand for lengths (rad, full
/// turns counted), moments for forces (N m), and a moment of inertia for the mass (kg m²). (The force that stands in a body's
/// `ExternalForce` is what the engine must be given for the body to arrive where this force takes
/// it; see [`SpringLoad`](crate::SpringLoad).) Zero on an element that has not acted yet,
/// or is at fault.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct SpringReadout {
    /// Distance between the anchors, m.
    pub length: f32,
    /// Rate of the length, m/s.
    pub rate: f32,
    /// Tension of all that does not depend on the rate, N: spring and [`Preload`](crate::Preload), as
    /// [`SpringAction`](crate::SpringAction) and [`MaxForce`](crate::MaxForce) leave them, and pressed stops on top.
    /// 0 where a rope is slack.
    pub spring_force: f32,
    /// Tension of the damper and of the dampers of pressed stops, N.
    pub damper_force: f32,
    /// Energy in spring and stops, J: 0 where they give no force.
    pub stored_energy: f32,
    /// Power that the damper turns into heat, W.
    pub dissipated_power: f32,
    /// Energy that the element has turned into heat since it began to act, J.
    pub dissipated_energy: f32,
    /// Work that was done on it since then, J: by changes of its parameters, and by ends that something other
    /// than the physics moves.
    pub work: f32,
    /// Phase per engine step, rad: √(stiffness / effective mass) times the step. Up to 1 the motion is
    /// followed closely with one micro-step. Free elements beyond 2 take more by themselves, as far as
    /// [`CoiloverSettings::resolve`](crate::CoiloverSettings::resolve) goes; a motion that no step resolves is stable, with a wrong
    /// frequency.
    pub omega_dt: f32,
    /// Mass that the two ends have against each other along the line, kg, with their lever arms and
    /// inertia; infinite if neither can move.
    pub effective_mass: f32,
    /// How the last step was solved.
    pub method: SpringMethod,
    /// Kicks that the last step took.
    pub microsteps: u32,
    /// Estimate of the error that the last step added to a position, m; where the accuracy was asked for
    /// as a tolerance, else 0.
    pub error: f32,
    /// An upper bound of [`CoiloverSettings`](crate::CoiloverSettings) (`max_…`, `resolve`) kept the step from being finer
    /// or more exact. Of an element whose own vibration is not followed for that, the log tells once.
    pub capped: bool,
}

/// How an element's step was solved: the cheapest way that is sound.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone, Hash)]
pub enum SpringMethod {
    /// It took no part: nothing it holds can move, or it is at fault. What is asleep shows its last step.
    #[default]
    None,
    /// Alone on its ends: solved in closed form.
    ClosedForm,
    /// In a network: one factorisation for all.
    Direct,
    /// In a large network: conjugate gradients.
    Iterative,
    /// By the engine's own solver, together with the contacts or joints that hold its bodies;
    /// [`SpringReadout::microsteps`] are that solver's substeps.
    Engine,
}

impl SpringReadout {
    /// Spring and damper together, N, tension positive.
    pub const fn force(&self) -> f32 {
        (self.spring_force + self.damper_force).clamp(-f32::MAX, f32::MAX)
    }

    pub(crate) fn note(&mut self, solved: &Solved) {
        self.method = match solved.method {
            Method::None => SpringMethod::None,
            Method::ClosedForm => SpringMethod::ClosedForm,
            Method::Direct => SpringMethod::Direct,
            Method::Iterative => SpringMethod::Iterative,
            Method::Engine => SpringMethod::Engine,
        };
        self.microsteps = solved.microsteps;
        self.error = solved.error;
        self.capped = solved.capped;
    }
}
