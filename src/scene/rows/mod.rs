//! The rows of a scene: plain data about elements and bodies that is kept from step to step.

mod body;
mod cut;
mod element;
mod flags;
mod marks;
mod raised;

pub(crate) use body::{BodyRow, RareBody, Rest, Searched};
pub(crate) use cut::{Cut, Rows, RowsMut};
pub(crate) use element::{ElementRow, EnergyLedger, Held, Jump, RareElement, Solved};
pub(crate) use flags::{BodyFlags, ElementFlags, take};
pub(crate) use marks::{mix, pull_mark, turning_mark};
pub(crate) use raised::{Raised, Sweeps};

/// Row indices of the elements and bodies of one component.
pub(crate) struct Members<'a> {
    pub elements: &'a [u32],
    pub bodies: &'a [u32],
}

#[cfg(test)]
mod tests;
