//! Computes the sizes of an element's parts from its looks and its length when first drawn.

use super::coil::Coil;
use super::layout::Layout;
use super::telescope::Telescope;

/// Default stroke, as a share of the length when first drawn.
const STROKE: f32 = 0.5;
/// Share of the tube that still holds the rod at full stroke.
const OVERLAP: f32 = 0.15;

impl Layout {
    /// Returns the layout of an element whose ends were `first` metres apart when first drawn.
    pub fn new(coil: Option<&Coil>, telescope: Option<&Telescope>, first: f32) -> Self {
        let mut out = Self::default();
        if let Some(coil) = coil {
            out.coil_radius = coil.radius;
            out.wire_radius = coil.wire_radius;
            out.solid = coil.solid_length();
            out.reach = out.coil_radius + 2.0 * out.wire_radius;
        }
        let Some(telescope) = telescope else {
            return out;
        };
        out.tube_radius = telescope.tube_radius;
        out.rod_radius = telescope.rod_radius;
        out.reach = out.reach.max(2.0 * out.tube_radius);
        out.eye = if telescope.eyes {
            1.25 * telescope.tube_radius
        } else {
            0.0
        };
        out.body = 0.8 * out.eye;
        out.foot = out.body + 1.5 * out.wire_radius;

        let stroke = telescope.stroke.unwrap_or(STROKE * first).min(1.9 * first);
        let (shortest, longest) = (first - 0.5 * stroke, first + 0.5 * stroke);
        let head = out.foot + 0.5 * out.tube_radius;
        let tube = (shortest - head).max(0.6 * shortest);
        out.tube = telescope.tube_length.unwrap_or(tube);
        let rod = longest - out.tube * (1.0 - OVERLAP);
        let room = (shortest - out.body).max(0.5 * shortest);
        out.rod = telescope.rod_length.unwrap_or(rod.min(room));
        if telescope.bump_rubber {
            // A quarter of the way in, so that three quarters stay free.
            out.bump = 0.25 * (first - out.tube - out.foot).max(0.0);
        }
        out
    }
}
