//! Where each part is along the line from end A to end B: only lengths, no directions.

use bevy::prelude::*;

/// Which part of an element a drawn child is.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Coil,
    Tube,
    /// The collar at the tube's mouth.
    Collar,
    Rod,
    Bump,
    /// Plate at end A on which a coilover's coil sits.
    SeatA,
    /// Plate at end B on which a coilover's coil sits.
    SeatB,
    EyeA,
    EyeB,
    /// Something of the user's, of this length when it is not scaled, m.
    Custom(f32),
}

/// Lengths below this have no direction and no size, m.
pub(super) const SHORT: f32 = 1e-5;
/// Least share of the tube that holds the rod, however far the ends are pulled apart.
const LEAST_OVERLAP: f32 = 0.05;

/// Transform of a part that is not drawn.
pub(super) fn nothing() -> GlobalTransform {
    GlobalTransform::from_scale(Vec3::ZERO)
}

/// Sizes of an element's parts, m; zero for a part that it does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Layout {
    pub coil_radius: f32,
    pub wire_radius: f32,
    pub tube_radius: f32,
    pub rod_radius: f32,
    /// Greatest distance of any part from the line between the ends.
    pub reach: f32,
    /// Outer radius of the eyes.
    pub eye: f32,
    /// Distance from an end to where the tube or the rod itself begins.
    pub body: f32,
    /// Distance from an end to where the coil stands, on its spring seat.
    pub foot: f32,
    /// Distance from end A to the tube's mouth.
    pub tube: f32,
    /// Distance from end B to the rod's tip.
    pub rod: f32,
    /// Length of the bump rubber.
    pub bump: f32,
    /// Length at which the coil's turns touch.
    pub solid: f32,
}

impl Layout {
    /// Distance from end A to the tube's mouth, for ends at a distance `length`: the tube does not pass through the
    /// fittings at end B.
    pub fn mouth(&self, length: f32) -> f32 {
        self.tube.min((length - self.foot).max(0.5 * length))
    }

    /// Distance from end B to the rod's tip, for ends at a distance `length`: the rod neither leaves the tube nor
    /// passes through its bottom.
    pub fn tip(&self, length: f32) -> f32 {
        let least = length - self.mouth(length) * (1.0 - LEAST_OVERLAP);
        self.rod.max(least).min((length - self.body).max(least))
    }

    /// Length of the coil, for ends at a distance `length`.
    pub fn span(&self, length: f32) -> f32 {
        (length - 2.0 * self.foot).max(SHORT)
    }

    /// Position of a part's origin on the line from end A, and the scale of its mesh. Meshes of solids are one metre
    /// high about their middle, with a radius of one. Meshes of coils stand on their foot.
    #[inline]
    pub fn lay(&self, part: Part, length: f32) -> (f32, Vec3) {
        let round = |radius: f32, low: f32, high: f32| {
            let height = (high - low).max(SHORT);
            (low + 0.5 * height, Vec3::new(radius, height, radius))
        };
        let plate = || self.coil_radius + 1.5 * self.wire_radius;
        let (body, foot) = (self.body, self.foot);
        match part {
            Part::Coil => (foot, Vec3::new(1.0, self.span(length), 1.0)),
            Part::Tube => round(self.tube_radius, body, self.mouth(length)),
            Part::Collar => {
                let mouth = self.mouth(length);
                let radius = 1.12 * self.tube_radius;
                round(
                    radius,
                    mouth - 0.5 * self.tube_radius,
                    mouth + 1e-3 * self.tube_radius,
                )
            }
            Part::Rod => round(self.rod_radius, length - self.tip(length), length - body),
            Part::Bump => {
                let top = length - foot;
                let low = (top - self.bump).max(self.mouth(length));
                round(0.5 * (self.tube_radius + self.rod_radius), low, top)
            }
            Part::SeatA => round(plate(), body, foot),
            Part::SeatB => round(plate(), length - foot, length - body),
            Part::EyeA => (0.0, Vec3::splat(self.eye)),
            Part::EyeB => (length, Vec3::splat(self.eye)),
            Part::Custom(own) => (foot, Vec3::new(1.0, self.span(length) / own, 1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::coil::Coil;
    use super::super::telescope::Telescope;
    use super::*;

    fn cases() -> impl Iterator<Item = (Telescope, Option<Coil>)> {
        let plain = Telescope::default();
        let long = plain.with_stroke(0.9);
        let given = Telescope {
            tube_length: Some(0.3),
            rod_length: Some(0.4),
            ..plain
        };
        [plain, plain.with_fittings(), long, given]
            .into_iter()
            .flat_map(|t| [(t, None), (t, Some(Coil::default()))])
    }

    #[test]
    fn tube_and_rod_always_overlap_and_never_poke_through() {
        for (telescope, coil) in cases() {
            let layout = Layout::new(coil.as_ref(), Some(&telescope), 1.0);
            for length in [0.001, 0.01, 0.3, 0.7, 1.0, 1.1, 1.5, 4.0] {
                let (mouth, tip) = (layout.mouth(length), layout.tip(length));
                assert!(mouth <= length && tip <= length, "{length}: {mouth} {tip}");
                assert!(mouth + tip > length, "{length}: {mouth} + {tip}");
            }
        }
    }

    #[test]
    fn tube_and_rod_keep_their_lengths_through_the_stroke() {
        for stroke in [0.1, 0.3, 0.5] {
            let telescope = Telescope::default().with_stroke(stroke);
            let layout = Layout::new(None, Some(&telescope), 1.0);
            let (mouth, tip) = (layout.mouth(1.0), layout.tip(1.0));
            for i in 0..=20 {
                let length = 1.0 + stroke * (i as f32 / 20.0 - 0.5);
                assert!(
                    (layout.mouth(length) - mouth).abs() < 1e-6,
                    "{stroke} {length}"
                );
                assert!((layout.tip(length) - tip).abs() < 1e-6, "{stroke} {length}");
            }
        }
    }

    #[test]
    fn a_coil_alone_goes_from_end_to_end_and_a_coilovers_between_its_seats() {
        let coil = Coil::default();
        let alone = Layout::new(Some(&coil), None, 1.0);
        assert_eq!(alone.lay(Part::Coil, 1.2), (0.0, Vec3::new(1.0, 1.2, 1.0)));
        let both = Layout::new(
            Some(&coil),
            Some(&Telescope::default().with_fittings()),
            1.0,
        );
        let (foot, scale) = both.lay(Part::Coil, 1.2);
        let (low, a) = both.lay(Part::SeatA, 1.2);
        let (high, b) = both.lay(Part::SeatB, 1.2);
        assert!((foot - low - 0.5 * a.y).abs() < 1e-6);
        assert!((foot + scale.y - high + 0.5 * b.y).abs() < 1e-6);
    }

    #[test]
    fn nothing_is_negative_or_infinite_at_any_length() {
        for (telescope, coil) in cases() {
            let layout = Layout::new(coil.as_ref(), Some(&telescope), 1.0);
            for length in [0.0, SHORT, 0.05, 0.2, 1.0, 100.0] {
                for part in [
                    Part::Coil,
                    Part::Tube,
                    Part::Collar,
                    Part::Rod,
                    Part::Bump,
                    Part::SeatA,
                    Part::SeatB,
                    Part::EyeA,
                    Part::EyeB,
                    Part::Custom(1.0),
                ] {
                    let (at, scale) = layout.lay(part, length);
                    assert!(at.is_finite() && scale.is_finite(), "{part:?} at {length}");
                    let is_there = match part {
                        Part::Coil | Part::SeatA | Part::SeatB => coil.is_some(),
                        Part::EyeA | Part::EyeB => telescope.eyes,
                        _ => true,
                    };
                    let least = scale.min_element();
                    assert!(
                        least > 0.0 || (!is_there && least >= 0.0),
                        "{part:?} at {length}: {scale}"
                    );
                }
            }
        }
    }
}
