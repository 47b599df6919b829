//! Lays the parts between the ends, where the ends are drawn in this frame.

use super::coil::Coil;
use super::parts::Part;
use super::telescope::Telescope;
use crate::element::{Anchors, Damper, Spring, SpringDamper};
use bevy::prelude::*;

/// Where an element was drawn last.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Placement {
    /// From +Y to the line in the frame of end A, carried along with it so that it neither spins nor
    /// flips.
    rotation: Quat,
    /// Length when first drawn, m.
    first: Option<f32>,
}

/// Ends, looks and parts of an element.
type Elements<'a> = (
    Entity,
    Option<&'a Spring>,
    Option<&'a Damper>,
    Option<&'a SpringDamper>,
    Option<&'a Anchors>,
    Option<&'a Coil>,
    Option<&'a Telescope>,
    &'a mut Placement,
    &'a Children,
);

/// Shorter than this a line has no direction of its own, m.
const SHORT: f32 = 1e-5;

pub(super) fn place(
    mut elements: Query<Elements, Or<(With<Coil>, With<Telescope>)>>,
    globals: Query<&GlobalTransform, Without<Part>>,
    mut parts: Query<(&Part, &mut Transform, &mut GlobalTransform)>,
) {
    for (entity, spring, damper, pair, anchors, coil, telescope, mut placement, children) in
        &mut elements
    {
        let ends = spring
            .map(|s| (s.body_a, s.body_b))
            .or(damper.map(|d| (d.body_a, d.body_b)))
            .or(pair.map(|p| (p.body_a, p.body_b)));
        let Some((Ok(a), Ok(b))) = ends.map(|(a, b)| (globals.get(a), globals.get(b))) else {
            continue;
        };
        let anchors = anchors.copied().unwrap_or_default();
        let (from, to) = (a.transform_point(anchors.a), b.transform_point(anchors.b));
        let length = from.distance(to);
        if !length.is_finite() {
            continue;
        }
        let frame = a.rotation();
        let local = frame.inverse() * (to - from);
        placement.rotation = carry(placement.rotation, local);
        let first = *placement.first.get_or_insert(length.max(SHORT));
        let Ok(own) = globals.get(entity) else {
            continue;
        };
        let line = Line {
            from,
            rotation: frame * placement.rotation,
            length,
        };
        for child in children {
            if let Ok((part, mut transform, mut global)) = parts.get_mut(*child) {
                let world = line.lay(part, coil, telescope, first);
                // Propagation has run: set both, so that this frame and the next agree.
                *global = GlobalTransform::from(world);
                *transform = global.reparented_to(own);
            }
        }
    }
}

/// Turns a rotation along with the direction that +Y has under it (parallel transport).
fn carry(rotation: Quat, direction: Vec3) -> Quat {
    match direction.try_normalize() {
        Some(direction) if direction.is_finite() => {
            (Quat::from_rotation_arc(rotation * Vec3::Y, direction) * rotation).normalize()
        }
        _ => rotation,
    }
}

struct Line {
    from: Vec3,
    rotation: Quat,
    length: f32,
}

impl Line {
    /// Where a part goes, in the world.
    fn lay(
        &self,
        part: &Part,
        coil: Option<&Coil>,
        telescope: Option<&Telescope>,
        first: f32,
    ) -> Transform {
        let length = self.length.max(SHORT);
        let coil = coil.copied().unwrap_or_default();
        let telescope = telescope.copied().unwrap_or_default();
        let (tube, rod) = telescope.lengths(length, first);
        let seat = Vec3::new(
            coil.radius + 1.8 * coil.wire_radius,
            2.0 * coil.wire_radius,
            coil.radius + 1.8 * coil.wire_radius,
        );
        // Cylinders are one metre high about their middle, coils stand on their foot.
        let (at, scale) = match part {
            Part::Coil { length: mesh } => (0.0, Vec3::new(1.0, length / mesh, 1.0)),
            Part::Tube => (0.5 * tube, round(telescope.tube_radius, tube)),
            Part::Rod => (length - 0.5 * rod, round(telescope.rod_radius, rod)),
            Part::SeatA => (-0.5 * seat.y, seat),
            Part::SeatB => (length + 0.5 * seat.y, seat),
        };
        Transform {
            translation: self.from + self.rotation * (at * Vec3::Y),
            rotation: self.rotation,
            scale,
        }
    }
}

fn round(radius: f32, height: f32) -> Vec3 {
    Vec3::new(radius, height, radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_right_round_neither_spins_nor_flips() {
        let mut rotation = Quat::IDENTITY;
        let mut before = rotation;
        for i in 0..=720 {
            let angle = (i as f32).to_radians();
            let direction = Vec3::new(angle.sin(), angle.cos(), 0.0);
            rotation = carry(rotation, direction);
            assert!((rotation * Vec3::Y).distance(direction) < 1e-4);
            assert!(
                (rotation * Vec3::Z).distance(Vec3::Z) < 1e-3,
                "spun at {i}°"
            );
            assert!(rotation.angle_between(before) < 0.03, "flipped at {i}°");
            before = rotation;
        }
    }

    #[test]
    fn no_length_keeps_the_last_direction() {
        let rotation = carry(Quat::IDENTITY, Vec3::X);
        assert_eq!(carry(rotation, Vec3::ZERO), rotation);
    }
}
