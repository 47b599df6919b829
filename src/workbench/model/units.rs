//! Units of an element's numbers: of lengths and forces, or of angles and moments.

use super::snapshot::Part;

/// Units as they appear after a number, each with a leading space.
#[derive(Debug)]
pub(crate) struct Units {
    pub length: &'static str,
    pub rate: &'static str,
    pub force: &'static str,
    pub stiffness: &'static str,
    /// Unit of a force per square of the stretch.
    pub stiffness_squared: &'static str,
    /// Unit of a force per cube of the stretch.
    pub stiffness_cubed: &'static str,
    pub damping: &'static str,
    /// Unit of a force per square of the rate.
    pub damping_squared: &'static str,
    /// Unit of the progression of a stop's stiffness.
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
    /// Returns the units of the element's numbers and of its companions' numbers.
    pub fn units(&self) -> &'static Units {
        if self.is_torsion() { &TORSION } else { &LINEAR }
    }
}
