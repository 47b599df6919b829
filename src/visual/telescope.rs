use super::place::Placement;
use bevy::prelude::*;

/// Draws a telescoping damper between the ends of the element on the same entity: a tube fixed to end A
/// and a rod fixed to end B that slides into it.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility, Placement)]
pub struct Telescope {
    /// Of the tube, m.
    pub tube_radius: f32,
    /// Of the rod, m.
    pub rod_radius: f32,
    /// Length of the tube, m; `None` is 0.55 of the length when first drawn.
    pub tube_length: Option<f32>,
    /// Length of the rod, m; `None` is 0.6 of the length when first drawn.
    pub rod_length: Option<f32>,
    /// Paint of the tube.
    pub color: Color,
}

impl Default for Telescope {
    fn default() -> Self {
        Self {
            tube_radius: 0.062,
            rod_radius: 0.026,
            tube_length: None,
            rod_length: None,
            color: Color::srgb(0.10, 0.11, 0.13),
        }
    }
}

/// Share of the first length that the tube takes, and the rod.
const TUBE: f32 = 0.55;
const ROD: f32 = 0.60;
/// The tube holds at least this share of itself over the rod, however far they are pulled.
const OVERLAP: f32 = 0.08;

impl Telescope {
    /// Lengths of tube and rod where the ends are `length` apart and were `first` apart when first
    /// drawn. Both are constant while they fit; past full travel the rod is drawn longer rather than
    /// leave the tube, and both end at the other end rather than poke through it.
    pub(super) fn lengths(&self, length: f32, first: f32) -> (f32, f32) {
        let sound = |given: Option<f32>, otherwise: f32| match given {
            Some(l) if l.is_finite() && l > 0.0 => l,
            _ => otherwise,
        };
        let tube = sound(self.tube_length, TUBE * first);
        let rod = sound(self.rod_length, ROD * first);
        let reach = length - tube * (1.0 - OVERLAP);
        (tube.min(length), rod.max(reach).min(length))
    }

    /// Whether it can be drawn.
    pub(super) fn is_sound(&self) -> bool {
        [self.tube_radius, self.rod_radius]
            .iter()
            .all(|x| x.is_finite() && *x > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tube_and_rod_always_overlap_and_never_poke_through() {
        let telescope = Telescope::default();
        for length in [0.01, 0.3, 0.7, 1.0, 1.1, 1.5, 4.0] {
            let (tube, rod) = telescope.lengths(length, 1.0);
            assert!(tube <= length && rod <= length, "{length}: {tube} {rod}");
            assert!(tube + rod > length, "{length}: {tube} + {rod}");
        }
        assert_eq!(telescope.lengths(1.0, 1.0), (0.55, 0.6));
        assert_eq!(telescope.lengths(1.1, 1.0), (0.55, 0.6));
    }
}
