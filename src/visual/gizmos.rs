//! Lines for debugging: ends, rest length, forces.

use super::bodies::Bodies;
use super::layout::SHORT;
use super::place::{Ends, Line, Lines};
use crate::element::{Spring, SpringAxis, SpringDamper};
use crate::readout::SpringReadout;
use bevy::gizmos::AppGizmoBuilder;
use bevy::gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy::gizmos::gizmos::Gizmos;
use bevy::math::{Mat3A, Vec3A};
use bevy::prelude::*;

/// Gizmo group that draws elements as lines, for debugging: crosses at the ends, the rest length beside the line, and
/// the forces on both ends as arrows, red for tension and blue for compression. Rest length and forces are drawn along
/// the line between the ends, or along the element's [`SpringAxis`](crate::SpringAxis). Torsion elements are not drawn.
///
/// Nothing is drawn unless `all` is set or an element has [`ShowSpringGizmos`], nor while a size here is not finite. It needs
/// Bevy's `GizmoPlugin`, which `DefaultPlugins` contains with the feature `bevy_gizmos_render`.
///
/// ```
/// # use bevy::gizmos::config::GizmoConfigStore;
/// # use bevy::prelude::*;
/// # use bevy_coilover::SpringGizmos;
/// fn show_all(mut store: ResMut<GizmoConfigStore>) {
///     let (config, springs) = store.config_mut::<SpringGizmos>();
///     config.depth_bias = -1.0; // In front of what is solid.
///     springs.all = true;
/// }
/// ```
#[derive(GizmoConfigGroup, Reflect, Clone, Debug)]
#[type_path = "bevy_coilover"]
#[reflect(Default)]
pub struct SpringGizmos {
    /// Whether to draw every element that has no [`ShowSpringGizmos`] of its own.
    pub all: bool,
    /// Length of a force arrow, m per N.
    pub scale: f32,
    /// Half the size of the crosses at the ends, m.
    pub cross: f32,
}

impl Default for SpringGizmos {
    fn default() -> Self {
        Self {
            all: false,
            scale: 0.005,
            cross: 0.05,
        }
    }
}

/// On an element: whether its [`SpringGizmos`] are drawn, whatever [`SpringGizmos::all`] says.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct ShowSpringGizmos(pub bool);

impl Default for ShowSpringGizmos {
    fn default() -> Self {
        Self(true)
    }
}

const TENSION: Color = Color::srgb(0.95, 0.15, 0.1);
const COMPRESSION: Color = Color::srgb(0.15, 0.4, 1.0);
const REST: Color = Color::srgb(0.2, 0.8, 0.3);
const END: Color = Color::srgb(0.95, 0.9, 0.2);

/// Adds the group, if the app has gizmos.
pub(super) fn add(app: &mut App, after: impl SystemSet) {
    if !app.world().contains_resource::<GizmoConfigStore>() {
        return;
    }
    app.init_gizmo_group::<SpringGizmos>()
        .add_systems(PostUpdate, draw.after(after));
}

fn draw(
    elements: Query<(
        Line,
        &SpringReadout,
        Option<&Spring>,
        Option<&SpringDamper>,
        Option<&SpringAxis>,
        Option<&ShowSpringGizmos>,
    )>,
    lines: Lines,
    bodies: Bodies,
    mut gizmos: Gizmos<SpringGizmos>,
) {
    let SpringGizmos { all, scale, cross } = gizmos.config_ext.clone();
    if !(scale.is_finite() && cross.is_finite()) {
        return;
    }
    for (line, readout, spring, pair, axis, show) in &elements {
        if !show.map_or(all, |s| s.0) {
            continue;
        }
        let Some(ends) = lines.ends(&line) else {
            continue;
        };
        let Ends { from, to, .. } = ends;
        if !(from.is_finite() && to.is_finite()) {
            continue;
        }
        let turn = || lines.turn(bodies.of(line.between()?.0));
        let direction = direction(&ends, axis, turn);
        for end in [from, to] {
            gizmos.cross(Isometry3d::from_translation(end), cross, END);
        }
        gizmos.line(from.into(), to.into(), END.with_alpha(0.5));
        let rest = spring
            .and_then(|s| s.rest_length)
            .or_else(|| pair.and_then(|p| p.rest_length));
        if let Some(rest) = rest.filter(|rest| rest.is_finite()) {
            // Beside the line and about its middle, so that a difference to the length shows at both ends.
            let beside = cross * direction.any_orthonormal_vector();
            let middle = 0.5 * (from + to) + beside;
            let half = 0.5 * rest * direction;
            gizmos.line((middle - half).into(), (middle + half).into(), REST);
        }
        let force = readout.force();
        if !force.is_finite() || force == 0.0 {
            continue;
        }
        // Tension pulls both ends inwards.
        let color = if force > 0.0 { TENSION } else { COMPRESSION };
        let pull = scale * force * direction;
        for (end, tip) in [(from, from + pull), (to, to - pull)] {
            let length = end.distance(tip);
            // Bevy finds no direction for the head of a shorter arrow, and would draw it at NaN.
            if length > SHORT && length.is_finite() {
                gizmos.arrow(end.into(), tip.into(), color);
            }
        }
    }
}

/// Direction along which an element acts, as a unit vector of the world. `turn` is the rotation of end A's body.
fn direction(ends: &Ends, axis: Option<&SpringAxis>, turn: impl Fn() -> Option<Mat3A>) -> Vec3A {
    let along = match axis {
        None => ends.to - ends.from,
        Some(SpringAxis::World(axis)) => Vec3A::from(*axis),
        Some(SpringAxis::BodyA(axis)) => turn().unwrap_or_default() * Vec3A::from(*axis),
    };
    along.normalize_or(Vec3A::Y)
}
