//! What bodies and contexts are given besides forces, and what their user had ordered instead.

use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// Sweeps over all joints and contacts in a substep that a context has been told, and what stood there before.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::engine) struct Sweeps(Option<Replaced<usize>>);

impl Sweeps {
    /// Has a context's substeps make so many, or as many as its user asks for.
    pub(in crate::engine) fn raise(&mut self, now: &mut usize, wanted: usize) {
        *now = Replaced::order(&mut self.0, *now, wanted);
    }

    /// Whether this is what a context had been told when its substeps made so many; `meanwhile` it was told that.
    pub(in crate::engine) fn fits(&self, now: usize, meanwhile: Self) -> bool {
        Replaced::fits(self.0, now, meanwhile.0)
    }
}

/// Such orders, and what stood there before.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::engine) struct Raised {
    iterations: Option<Replaced<usize>>,
    prediction: Option<Replaced<f32>>,
}

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Replaced<T> {
    ours: T,
    users: T,
}

impl<T: Copy + Default + PartialEq + PartialOrd> Replaced<T> {
    /// Notes what stands there now, and says what is to stand there.
    fn order(known: &mut Option<Self>, now: T, wanted: T) -> T {
        let users = match *known {
            Some(known) if known.ours == now => known.users,
            _ => now,
        };
        let ours = if wanted > users { wanted } else { users };
        *known = (ours != users).then_some(Self { ours, users });
        ours
    }

    /// Whether `known` tells of what stands there now, and not what was noted `meanwhile`.
    fn fits(known: Option<Self>, now: T, meanwhile: Option<Self>) -> bool {
        match (known, meanwhile) {
            (Some(known), _) => known.ours == now,
            (None, Some(meanwhile)) => meanwhile.ours != now,
            (None, None) => true,
        }
    }
}

impl Raised {
    /// Has the engine solve a body in so many iterations more than its own, or as many as its user asks for.
    pub(in crate::engine) fn raise(&mut self, body: &mut RapierBody, iterations: usize) {
        let now = body.additional_solver_iterations();
        let ours = Replaced::order(&mut self.iterations, now, iterations);
        if ours != now {
            body.set_additional_solver_iterations(ours);
        }
    }

    /// Has the engine see its contacts so far ahead, m.
    pub(in crate::engine) fn look_ahead(&mut self, body: &mut RapierBody, way: f32) {
        let now = body.soft_ccd_prediction();
        let ours = Replaced::order(&mut self.prediction, now, way);
        if ours != now {
            body.set_soft_ccd_prediction(ours);
        }
    }

    /// Whether this is what the body had been given when it was as it is now; `meanwhile` it was given that.
    pub(in crate::engine) fn fits(&self, body: &RapierBody, meanwhile: Self) -> bool {
        let iterations = body.additional_solver_iterations();
        let prediction = body.soft_ccd_prediction();
        Replaced::fits(self.iterations, iterations, meanwhile.iterations)
            && Replaced::fits(self.prediction, prediction, meanwhile.prediction)
    }

    /// Gives back what the user had ordered.
    pub(in crate::engine) fn give_back(&mut self, body: &mut RapierBody) {
        self.raise(body, 0);
        self.look_ahead(body, 0.0);
    }

    /// Solver iterations more than the engine's own.
    pub(in crate::engine) fn iterations(&self) -> usize {
        self.iterations.map_or(0, |iterations| iterations.ours)
    }

    /// Whether there is anything to give back.
    pub(in crate::engine) fn is_any(&self) -> bool {
        self.iterations.is_some() || self.prediction.is_some()
    }
}
