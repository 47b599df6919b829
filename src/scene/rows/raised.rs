//! What bodies and contexts of an engine are lent besides forces, and what their user had ordered instead.

/// Sweeps over all joints and contacts in a substep that a context has been told, and what stood there before.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sweeps(Option<Replaced<usize>>);

impl Sweeps {
    /// Has a context's substeps make so many, or as many as its user asks for.
    pub(crate) fn raise(&mut self, now: &mut usize, wanted: usize) {
        *now = Replaced::order(&mut self.0, *now, wanted);
    }

    /// Whether this is what a context had been told when its substeps made so many; `meanwhile` it was told that.
    pub(crate) fn fits(&self, now: usize, meanwhile: Self) -> bool {
        Replaced::fits(self.0, now, meanwhile.0)
    }
}

/// What a body has been lent, and what stood there before.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Raised {
    substeps: Option<Replaced<usize>>,
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
    /// Substeps that a body is to have beyond those of all, which has so many now: those, or as many as its user asks for.
    pub(crate) fn order_substeps(&mut self, now: usize, wanted: usize) -> usize {
        Replaced::order(&mut self.substeps, now, wanted)
    }

    /// How far ahead the engine is to see a body's contacts, which sees them so far now, m.
    pub(crate) fn order_prediction(&mut self, now: f32, wanted: f32) -> f32 {
        Replaced::order(&mut self.prediction, now, wanted)
    }

    /// Whether this is what a body had been lent that has such substeps and prediction; `meanwhile` it was lent that.
    pub(crate) fn fits(&self, substeps: usize, prediction: f32, meanwhile: Self) -> bool {
        Replaced::fits(self.substeps, substeps, meanwhile.substeps)
            && Replaced::fits(self.prediction, prediction, meanwhile.prediction)
    }

    /// Whether there is anything to give back.
    pub(crate) fn is_any(&self) -> bool {
        self.substeps.is_some() || self.prediction.is_some()
    }
}
