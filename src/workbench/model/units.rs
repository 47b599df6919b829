//! Units of an element's numbers: of lengths and forces, or of angles and moments.

use super::snapshot::Part;

/// Each as it stands behind a number, with the space between them.
#[derive(Debug)]
pub(crate) struct Units {
    pub length: &'static str,
    pub rate: &'static str,
    pub force: &'static str,
    pub stiffness: &'static str,
    /// Of a force over the square of the stretch, and over its cube.
    pub stiffness_squared: &'static str,
    pub stiffness_cubed: &'static str,
    pub damping: &'static str,
    /// Of a force over the square of the rate.
    pub damping_squared: &'static str,
    /// Of how a stop grows stiffer.
    pub progression: &'static str,
    pub mass: &'static str,
}

static LINEAR: Units = Units {
    length: " m",
    rate: " m/s",
    force: " N",
    stiffness: " N/m",
    stiffness_squared: " N/m²",
    stiffness_cubed: " N/m³",
    damping: " N s/m",
    damping_squared: " N s²/m²",
    progression: " 1/m",
    mass: " kg",
};

static TORSION: Units = Units {
    length: " rad",
    rate: " rad/s",
    force: " N m",
    stiffness: " N m/rad",
    stiffness_squared: " N m/rad²",
    stiffness_cubed: " N m/rad³",
    damping: " N m s/rad",
    damping_squared: " N m s²/rad²",
    progression: " 1/rad",
    mass: " kg m²",
};

impl Part {
    /// Those of its numbers and of its companions'.
    pub fn units(&self) -> &'static Units {
        if self.is_torsion() { &TORSION } else { &LINEAR }
    }
}
