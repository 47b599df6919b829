//! The flags of rows. Each row has one word of them.

use bitflags::bitflags;

bitflags! {
    /// Flags of an element.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub(crate) struct ElementFlags: u32 {
        /// A parameter or an end changed since the last step.
        const CHANGED = 1;
        /// Its parameters or laws differ from those of its last step.
        const REFITTED = 1 << 1;
        /// The rest length was captured in this tick and must be written back.
        const CAPTURED = 1 << 2;
        /// The coefficients were computed in this tick and must be written back.
        const TUNED = 1 << 3;
        /// The coefficients must be computed once more, because contacts are known only after the first step.
        const TUNED_AGAIN = 1 << 4;
        /// Its component was awake in the last step, so its readout must be updated.
        const ACTIVE = 1 << 5;
        /// End A must be looked for in every tick, because the game can move an end that is not the origin of a rigid body.
        const A_IS_WATCHED = 1 << 6;
        /// End B must be looked for in every tick, because the game can move an end that is not the origin of a rigid body.
        const B_IS_WATCHED = 1 << 7;
        /// The places of its ends cannot change: they are fixed points of two movable bodies.
        const PLACED = 1 << 8;
        /// It acts along the line between its ends and moves at least one body, but not the same body at both ends.
        const IS_PLAIN = 1 << 9;
        /// Contacts or joints hold its component.
        const HELD = 1 << 10;
        /// It was found asleep, and only its bodies can wake it.
        const DOZES = 1 << 11;
        /// It was reported as too stiff to be followed.
        const TOLD_UNRESOLVED = 1 << 12;
        /// The game changed its parameters before this step, and with them its force: see `RareElement::jump`.
        const JUMPED = 1 << 13;
        /// The game changed its parameters before the last step. The readout must give the force that an even change would leave.
        const LEADS = 1 << 14;
        /// It did not act in its last step, for example because solving found a fault. So its energy was no part of its component's.
        const INERT = 1 << 15;
        /// The preload was computed in this tick, and `HoldPose` must be removed after the step.
        const POSED = 1 << 16;
        /// The flags that a snapshot keeps. The other flags are found anew.
        const KEPT = Self::CHANGED.bits() | Self::REFITTED.bits() | Self::CAPTURED.bits()
            | Self::TUNED.bits() | Self::TUNED_AGAIN.bits() | Self::ACTIVE.bits() | Self::JUMPED.bits()
            | Self::INERT.bits();
    }
}

bitflags! {
    /// Flags of a body.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub(crate) struct BodyFlags: u32 {
        /// Some element can turn it, for example one that holds it off its centre of mass.
        const TURNS = 1;
        /// Its mass, its elements or the user's force changed since the last step.
        const DISTURBED = 1 << 1;
        /// It has been at rest for some time.
        const RESTS = 1 << 2;
        /// It has been at rest for long enough to fall asleep.
        const RESTS_LONG = 1 << 3;
        /// Its only element was solved without an assembly.
        const IS_ALONE = 1 << 4;
        /// Its position after the last step is stored. That is not necessary for a body with `IS_ALONE`.
        const NOTED = 1 << 5;
        /// It was stepped, and its position has not been stored since.
        const FRESH = 1 << 6;
        /// The engine has not stepped it yet.
        const NEW = 1 << 7;
        /// It has colliders.
        const CAN_TOUCH = 1 << 8;
        /// A joint that the crate did not make holds it.
        const JOINTED = 1 << 9;
        /// Something touches it, or will touch it in the step.
        const TOUCHED = 1 << 10;
        /// A contact presses on it.
        const PRESSED = 1 << 11;
        /// It may fall asleep even if it creeps: see `scene::sleep`.
        const CREEPS = 1 << 12;
        /// The engine has a force of elements for it, which must be removed while the engine solves the elements itself.
        const CARRIES_SHARE = 1 << 13;
        /// The force of elements comes with a torque.
        const SHARES_TORQUE = 1 << 14;
        /// It was given a second substep, which must be taken back later.
        const SECOND_SUBSTEP = 1 << 15;
        /// The force of the user comes with a torque.
        const USER_TORQUE = 1 << 16;
        /// It counts as held: a contact or a joint holds it, or did a moment ago.
        const LINGERS = 1 << 17;
        /// Its rest in this step is counted already.
        const COUNTED = 1 << 18;
        /// The flags that a snapshot keeps. The other flags are found anew.
        const KEPT = !(Self::TURNS.bits() | Self::SHARES_TORQUE.bits()
            | Self::SECOND_SUBSTEP.bits() | Self::USER_TORQUE.bits());
    }
}

/// Clears a flag and returns whether it was set.
macro_rules! take {
    ($flags:expr, $flag:expr) => {{
        let was = $flags.contains($flag);
        $flags.remove($flag);
        was
    }};
}

pub(crate) use take;

#[cfg(feature = "serialize")]
mod serial {
    //! Serialises flags as numbers. Unknown bits are dropped.

    use super::{BodyFlags, ElementFlags};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    macro_rules! as_bits {
        ($($flags:ident: $bits:ty),*) => {$(
            impl Serialize for $flags {
                fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                    self.bits().serialize(to)
                }
            }

            impl<'de> Deserialize<'de> for $flags {
                fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                    <$bits>::deserialize(from).map(Self::from_bits_truncate)
                }
            }
        )*};
    }

    as_bits!(ElementFlags: u32, BodyFlags: u32);
}
