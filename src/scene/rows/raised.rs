//! Settings of the engine's bodies and contexts that the crate changes for a time, and the user's
//! values, which are restored later.

/// Number of sweeps over all joints and contacts per substep that the crate has set in a context, and the user's number.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sweeps(Option<Replaced<usize>>);

impl Sweeps {
    /// Sets the number of sweeps `now` to `wanted`, or to the user's number if that is greater.
    pub(crate) fn raise(&mut self, now: &mut usize, wanted: usize) {
        *now = Replaced::order(&mut self.0, *now, wanted);
    }

    /// Whether a context with the number of sweeps `now` has the setting that this value records, and not one
    /// that the crate set later (`meanwhile`).
    pub(crate) fn fits(&self, now: usize, meanwhile: Self) -> bool {
        Replaced::fits(self.0, now, meanwhile.0)
    }
}

/// Settings of a body that the crate has changed, and the user's values.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Raised {
    substeps: Option<Replaced<u32>>,
    prediction: Option<Replaced<f32>>,
}

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Replaced<T> {
    ours: T,
    users: T,
}

impl<T: Copy + Default + PartialEq + PartialOrd> Replaced<T> {
    /// Returns the value to set: `wanted`, or the user's value if that is greater. `now` is the present value; if it is not the
    /// crate's, it is the user's. Updates `known`.
    fn order(known: &mut Option<Self>, now: T, wanted: T) -> T {
        let users = match *known {
            // The crate only raises. A record that says otherwise is forged, and would order a step that never ends.
            Some(Self { ours, users }) if ours == now && users >= T::default() && users < ours => {
                users
            }
            _ => now,
        };
        let ours = if wanted > users { wanted } else { users };
        *known = (ours != users).then_some(Self { ours, users });
        ours
    }

    /// Whether `now` is the value that `known` records, and not one that the crate set later (`meanwhile`).
    fn fits(known: Option<Self>, now: T, meanwhile: Option<Self>) -> bool {
        match (known, meanwhile) {
            (Some(known), _) => known.ours == now,
            (None, Some(meanwhile)) => meanwhile.ours != now,
            (None, None) => true,
        }
    }
}

impl Raised {
    /// Returns the number of extra substeps to set for a body: `wanted`, or the user's number if that is
    /// greater. `now` is the present number.
    pub(crate) fn order_substeps(&mut self, now: usize, wanted: usize) -> usize {
        Replaced::order(&mut self.substeps, short(now), short(wanted)) as usize
    }

    /// Takes note that the user has set a number of extra substeps. It may be the number that the crate has set before, and
    /// then it is the user's from now on.
    pub(crate) fn leave_substeps(&mut self, number: usize) {
        self.substeps = self.substeps.filter(|known| known.ours != short(number));
    }

    /// Returns the contact prediction distance to set for a body, m: `wanted`, or the user's if that is
    /// greater. `now` is the present distance.
    pub(crate) fn order_prediction(&mut self, now: f32, wanted: f32) -> f32 {
        Replaced::order(&mut self.prediction, now, wanted)
    }

    /// Whether a body with these extra substeps and this prediction distance has the settings that this value records, and not
    /// those that the crate set later (`meanwhile`).
    pub(crate) fn fits(&self, substeps: usize, prediction: f32, meanwhile: Self) -> bool {
        Replaced::fits(self.substeps, short(substeps), meanwhile.substeps)
            && Replaced::fits(self.prediction, prediction, meanwhile.prediction)
    }

    /// Whether there is anything to restore.
    pub(crate) fn is_any(&self) -> bool {
        self.substeps.is_some() || self.prediction.is_some()
    }
}

/// A number of substeps as it is kept.
fn short(substeps: usize) -> u32 {
    u32::try_from(substeps).unwrap_or(u32::MAX)
}
