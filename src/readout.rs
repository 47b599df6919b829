//! What a game reads back from an element.

use crate::dynamics::tolerance::Method;
use crate::scene::rows::Solved;
use bevy::prelude::*;

/// State of an element after the last step, in SI units. Every element has this component.
///
/// Forces are the element's own, tension positive. On torsion elements, lengths are angles (rad, full turns counted),
/// forces are moments (N m), and the mass is a moment of inertia (kg m²). The force in a body's `ExternalForce` is a
/// different one: it makes the engine move the body to where the element's force takes it; see
/// [`SpringLoad`](crate::SpringLoad).
///
/// All fields are zero before the element's first step, and while a fault of its components or ends takes it out of
/// action. If a fault is only found during a step (ends that coincide, a custom law that gives NaN), length, rate,
/// dissipated energy and work are still set.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct SpringReadout {
    /// Distance between the anchors, m. Beside a [`SpringAxis`](crate::SpringAxis), the signed distance along that
    /// axis.
    pub length: f32,
    /// Rate of change of the length, m/s.
    pub rate: f32,
    /// Tension that does not depend on the rate, N: spring and [`Preload`](crate::Preload), limited by
    /// [`SpringAction`](crate::SpringAction) and [`MaxForce`](crate::MaxForce), plus pressed stops. 0 where a rope is
    /// slack. If the game changed parameters in this tick, as a winch does in each, this is the force that an even
    /// change over the tick would give.
    pub spring_force: f32,
    /// Tension of the damper and of the dampers of pressed stops, N.
    pub damper_force: f32,
    /// Energy stored in spring and stops, J. 0 at a length at which they give no force.
    pub stored_energy: f32,
    /// Power that the damper and the dampers of pressed stops turn into heat, W.
    pub dissipated_power: f32,
    /// Energy that the element has turned into heat since it began to act, J.
    pub dissipated_energy: f32,
    /// Work done on the element since it began to act, J: by changes of its parameters, and by ends that something
    /// other than the physics moves.
    pub work: f32,
    /// Phase per engine step, rad: √(stiffness / effective mass) · dt. Up to 1, one micro-step follows the motion
    /// closely. Beyond 2, elements on free bodies take more micro-steps by themselves, as far as
    /// [`CoiloverSettings::resolve`](crate::CoiloverSettings::resolve) allows. A motion that is not resolved is stable,
    /// but has a wrong frequency.
    pub omega_dt: f32,
    /// Effective mass of the two ends against each other along the line, kg, with lever arms, inertia, and what joints
    /// and contacts hold. Infinite if neither end can move.
    pub effective_mass: f32,
    /// How the last step was solved.
    pub method: SpringMethod,
    /// Number of kicks of this element in the last step, also of attempts that were discarded.
    pub microsteps: u32,
    /// Estimate of the position error that the last step added, m. 0 without a
    /// [`CoiloverSettings::tolerance`](crate::CoiloverSettings::tolerance).
    pub error: f32,
    /// Whether an upper bound of [`CoiloverSettings`](crate::CoiloverSettings) (`max_…`, `resolve`) kept the step from
    /// being as fine or as exact as needed. If the element's own vibration is not followed because of that, the log
    /// names the element once.
    pub capped: bool,
}

/// How an element's step was solved. The crate takes the cheapest method that is valid.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone, Hash)]
pub enum SpringMethod {
    /// Not solved: the element is at fault, or no body of it can move. A sleeping element keeps the method of its last
    /// step.
    #[default]
    None,
    /// Alone on its bodies: solved in closed form.
    ClosedForm,
    /// In a network that is small, or long and narrow such as a rope, a bridge or a tower: solved by one matrix factorisation for
    /// all elements. Also alone with a companion such as [`Preload`](crate::Preload) on a body that it turns.
    Direct,
    /// In a network that is large and wide, such as a cloth, or in a soft one that turns no body: solved by conjugate gradients.
    Iterative,
    /// Solved by the engine's own solver, together with the contacts or joints that hold its bodies.
    /// [`SpringReadout::microsteps`] is then the number of solver substeps.
    Engine,
}

impl SpringReadout {
    /// Returns the force of spring, damper and stops together, N, tension positive.
    pub const fn force(&self) -> f32 {
        (self.spring_force + self.damper_force).clamp(-f32::MAX, f32::MAX)
    }

    /// Whether it can be that of an element. Only the effective mass and the phase may be infinite.
    pub(crate) fn is_sound(&self) -> bool {
        let finite = [
            self.length,
            self.rate,
            self.spring_force,
            self.damper_force,
            self.stored_energy,
            self.dissipated_power,
            self.dissipated_energy,
            self.work,
            self.error,
        ];
        finite.iter().all(|number| number.is_finite())
            && !self.omega_dt.is_nan()
            && !self.effective_mass.is_nan()
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
