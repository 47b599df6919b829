//! What is so of a row and what is not; one word each.

use bitflags::bitflags;

bitflags! {
    /// Of an element.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub(crate) struct ElementFlags: u16 {
        /// A parameter or an end changed since the last tick.
        const CHANGED = 1;
        /// Its numbers or laws are others than in its last step.
        const REFITTED = 1 << 1;
        /// The rest length was found in this tick and has to be written back.
        const CAPTURED = 1 << 2;
        /// The coefficients were worked out in this tick and have to be written back.
        const TUNED = 1 << 3;
        /// They are to be worked out once more: contacts are known only after the first step.
        const TUNED_AGAIN = 1 << 4;
        /// Some body of it was stepped, or none can be: there is something to read out.
        const ACTIVE = 1 << 5;
        /// End A has to be looked for in every tick: what is not a body itself can be moved by the game.
        const A_IS_WATCHED = 1 << 6;
        /// End B has.
        const B_IS_WATCHED = 1 << 7;
        /// Where its ends are is known for good: on two bodies, at the same points of them.
        const PLACED = 1 << 8;
        /// It acts along the line between its ends, and holds what it moves by the centres of mass.
        const IS_PLAIN = 1 << 9;
        /// Contacts or joints hold its component.
        const HELD = 1 << 10;
        /// It was found asleep, and nothing but its bodies can wake it.
        const DOZES = 1 << 11;
        /// It was said that it is too stiff to be followed.
        const TOLD_UNRESOLVED = 1 << 12;
        /// What a snapshot keeps; the rest is found anew.
        const KEPT = Self::CHANGED.bits() | Self::REFITTED.bits() | Self::CAPTURED.bits()
            | Self::TUNED.bits() | Self::TUNED_AGAIN.bits() | Self::ACTIVE.bits();
    }
}

bitflags! {
    /// Of a body.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub(crate) struct BodyFlags: u32 {
        /// Some element holds it off its centre of mass.
        const TURNS = 1;
        /// Its mass, its elements or the user's share changed since the last step.
        const DISTURBED = 1 << 1;
        /// It has been at rest since some time,
        const RESTS = 1 << 2;
        /// and for long enough.
        const RESTS_LONG = 1 << 3;
        /// Its only element goes through the step without an assembly.
        const IS_ALONE = 1 << 4;
        /// Its place after the last step is noted; nobody asks for that of a body that is alone.
        const NOTED = 1 << 5;
        /// It was stepped and has not been looked at since.
        const FRESH = 1 << 6;
        /// The engine has not stepped it yet.
        const NEW = 1 << 7;
        /// It has colliders.
        const CAN_TOUCH = 1 << 8;
        /// A joint holds it.
        const JOINTED = 1 << 9;
        /// Something touches it,
        const TOUCHED = 1 << 10;
        /// and pushes it.
        const PRESSED = 1 << 11;
        /// So it may go on creeping: see `scene::sleep`.
        const CREEPS = 1 << 12;
        /// The engine has a share of ours, which it should not have while it solves the elements itself.
        const CARRIES_SHARE = 1 << 13;
        /// The share has a torque too.
        const SHARES_TORQUE = 1 << 14;
        /// It was given a second substep, which has to be given back.
        const SECOND_SUBSTEP = 1 << 15;
        /// The user's share has a torque.
        const USER_TORQUE = 1 << 16;
        /// It counts as held: a contact or a joint holds it, or did a moment ago.
        const LINGERS = 1 << 17;
        /// What a snapshot keeps; the rest is found anew.
        const KEPT = !(Self::TURNS.bits() | Self::SHARES_TORQUE.bits()
            | Self::SECOND_SUBSTEP.bits() | Self::USER_TORQUE.bits());
    }
}

/// Takes a flag down, and says whether it was up.
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
    //! As numbers; bits that mean nothing are dropped.

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

    as_bits!(ElementFlags: u16, BodyFlags: u32);
}
