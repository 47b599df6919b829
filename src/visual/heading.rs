//! How a drawn element is rotated about its own axis.

use bevy::math::{Mat3A, Vec3A};

/// The direction of an element and a vector across it (the side), both in the frame of end A. So the looks turn with
/// end A. When the direction changes, the side is carried along without spin (parallel transport).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heading {
    axis: Vec3A,
    side: Vec3A,
}

impl Default for Heading {
    fn default() -> Self {
        Self {
            axis: Vec3A::Y,
            side: Vec3A::X,
        }
    }
}

impl Heading {
    /// Turns to a direction (unit vector in the frame of end A) by the shortest way.
    #[inline]
    pub fn turn_to(&mut self, direction: Vec3A) {
        // Rounding errors must not accumulate. That of the last turn is removed here, off the critical path.
        let side = at_unit_length(self.side, self.side.length_squared());
        let closeness = 1.0 + self.axis.dot(direction);
        // Perpendicular to the direction, whatever rounding has done to the side. But precision is lost near a turn by
        // 180°.
        let turned = side - (self.axis + direction) * (side.dot(direction) / closeness);
        self.side = if closeness > 1e-2 {
            turned
        } else {
            // For a turn by 180° every way is the shortest: the side stays.
            let turned = if closeness > 1e-6 { turned } else { side };
            (turned - direction * turned.dot(direction))
                .try_normalize()
                .unwrap_or_else(|| direction.any_orthonormal_vector())
        };
        self.axis = direction;
    }

    /// The direction, in the frame of end A.
    #[inline]
    pub const fn axis(&self) -> Vec3A {
        self.axis
    }

    /// The side, in the frame of end A.
    #[inline]
    pub const fn side(&self) -> Vec3A {
        self.side
    }
}

/// Rotation that maps Y to an axis and X to a vector across it.
#[inline]
pub(super) fn rotation(axis: Vec3A, side: Vec3A) -> Mat3A {
    Mat3A::from_cols(side, axis, side.cross(axis))
}

/// Rotation part of a matrix that may scale and shear, from its first two columns.
#[inline]
pub(super) fn upright(x: Vec3A, y: Vec3A) -> Mat3A {
    let z = x.cross(y);
    let (square_x, square_z) = (x.length_squared(), z.length_squared());
    // Nearly all matrices are rotations already, which is cheap to check.
    let (x, z) = if is_near_one(square_x) && is_near_one(square_z) {
        (at_unit_length(x, square_x), at_unit_length(z, square_z))
    } else {
        let x = x.normalize_or(Vec3A::X);
        let z = x.cross(y).try_normalize();
        (x, z.unwrap_or_else(|| x.any_orthonormal_vector()))
    };
    Mat3A::from_cols(x, z.cross(x), z)
}

#[inline]
fn is_near_one(square: f32) -> bool {
    (square - 1.0).abs() < 2e-4
}

/// Scales a vector to unit length, given its squared length, which is nearly 1. One step of Newton's method is exact to
/// rounding, and needs neither a root nor a division.
#[inline]
fn at_unit_length(v: Vec3A, square: f32) -> Vec3A {
    v * (1.5 - 0.5 * square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{Quat, Vec3};

    /// Rotation of a heading, in the frame of end A.
    fn at(heading: &Heading) -> Mat3A {
        rotation(heading.axis, heading.side)
    }

    fn is_rotation(matrix: &Mat3A) -> bool {
        (*matrix * matrix.transpose()).abs_diff_eq(Mat3A::IDENTITY, 1e-5)
            && (matrix.determinant() - 1.0).abs() < 1e-5
    }

    #[test]
    fn a_swing_right_round_neither_spins_nor_flips() {
        let mut heading = Heading::default();
        let mut before = at(&heading);
        for i in 0..=720 {
            let angle = (i as f32).to_radians();
            let direction = Vec3A::new(angle.sin(), angle.cos(), 0.0);
            heading.turn_to(direction);
            let now = at(&heading);
            assert!(is_rotation(&now));
            assert!(now.y_axis.distance(direction) < 1e-5);
            assert!(now.z_axis.distance(Vec3A::Z) < 1e-3, "spun at {i}°");
            assert!(now.x_axis.distance(before.x_axis) < 0.03, "flipped at {i}°");
            before = now;
        }
    }

    #[test]
    fn any_swing_is_a_turn_by_the_shortest_way() {
        let mut heading = Heading::default();
        for i in 0..2000 {
            let t = i as f32 * 0.1;
            let direction = Vec3A::new(t.sin(), (1.7 * t).cos(), (0.6 * t).sin()).normalize();
            let before = at(&heading);
            let arc = Quat::from_rotation_arc(before.y_axis.into(), direction.into());
            heading.turn_to(direction);
            let now = at(&heading);
            // Near 180° the shortest way depends on rounding.
            if before.y_axis.dot(direction) > -0.9 {
                assert!(now.x_axis.distance(arc * before.x_axis) < 1e-3, "step {i}");
            }
        }
        assert!(is_rotation(&at(&heading)));
    }

    #[test]
    fn straight_back_is_no_harm() {
        let mut heading = Heading::default();
        for direction in [Vec3A::Y, Vec3A::NEG_Y, Vec3A::Y] {
            heading.turn_to(direction);
            assert!(is_rotation(&at(&heading)));
        }
    }

    #[test]
    fn scale_shear_and_mirrors_leave_a_rotation() {
        let turn = Mat3A::from_quat(Quat::from_rotation_x(0.7) * Quat::from_rotation_z(2.0));
        for scale in [
            Vec3A::new(2.0, 0.3, 5.0),
            Vec3A::new(-1.0, 1.0, 1.0),
            Vec3A::new(0.0, 1.0, 1.0),
            Vec3A::ZERO,
        ] {
            let matrix = turn * Mat3A::from_diagonal(scale.into());
            assert!(
                is_rotation(&upright(matrix.x_axis, matrix.y_axis)),
                "{scale}"
            );
        }
        let scaled = turn * Mat3A::from_diagonal(Vec3::splat(3.0));
        assert!(upright(scaled.x_axis, scaled.y_axis).abs_diff_eq(turn, 1e-5));
    }
}
