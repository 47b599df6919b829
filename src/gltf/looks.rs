//! Reads the visual components of an element from `BEVY_coilover`.

use super::companions::choice;
use super::json::Object;
use crate::visual::{Coil, Handedness, HelixEnds, ShowSpringGizmos, Telescope};
use bevy::prelude::*;

/// Inserts the visual components that the extension object describes.
pub(super) fn insert(object: &Object, entity: &mut EntityWorldMut) {
    if let Some(look) = object.object("coil") {
        entity.insert(coil(&look));
    }
    if let Some(look) = object.object("telescope") {
        entity.insert(telescope(&look));
    }
    if let Some(shown) = object.flag("showSpringGizmos") {
        entity.insert(ShowSpringGizmos(shown));
    }
}

fn coil(look: &Object) -> Coil {
    look.only(&[
        "radius",
        "wireRadius",
        "turns",
        "ends",
        "handedness",
        "color",
        "fitted",
    ]);
    let fitted = look.flag("fitted").unwrap_or(false);
    let default = if fitted {
        Coil::fitted()
    } else {
        Coil::default()
    };
    let ends = [
        ("Open", HelixEnds::Open),
        ("Closed", HelixEnds::Closed),
        ("ClosedGround", HelixEnds::ClosedGround),
    ];
    let hands = [("Right", Handedness::Right), ("Left", Handedness::Left)];
    Coil {
        radius: look.number("radius").unwrap_or(default.radius),
        wire_radius: look.number("wireRadius").unwrap_or(default.wire_radius),
        turns: look.number("turns").unwrap_or(default.turns),
        ends: choice(look, "ends", ends).unwrap_or(default.ends),
        handedness: choice(look, "handedness", hands).unwrap_or(default.handedness),
        color: color(look).unwrap_or(default.color),
        fitted,
    }
}

fn telescope(look: &Object) -> Telescope {
    look.only(&[
        "tubeRadius",
        "rodRadius",
        "tubeLength",
        "rodLength",
        "stroke",
        "eyes",
        "bumpRubber",
        "color",
        "fitted",
    ]);
    let fitted = look.flag("fitted").unwrap_or(false);
    let default = if fitted {
        Telescope::fitted()
    } else {
        Telescope::default()
    };
    Telescope {
        tube_radius: look.number("tubeRadius").unwrap_or(default.tube_radius),
        rod_radius: look.number("rodRadius").unwrap_or(default.rod_radius),
        tube_length: look.number("tubeLength"),
        rod_length: look.number("rodLength"),
        stroke: look.number("stroke"),
        eyes: look.flag("eyes").unwrap_or(false),
        bump_rubber: look.flag("bumpRubber").unwrap_or(false),
        color: color(look).unwrap_or(default.color),
        fitted,
    }
}

/// Reads a colour in linear RGB or RGBA.
fn color(look: &Object) -> Option<Color> {
    let list = look.list("color");
    if !look.has("color") {
        return None;
    }
    let [r, g, b, a] = if list.len() == 3 {
        let [r, g, b] = look.numbers::<3>("color")?;
        [r, g, b, 1.0]
    } else {
        look.numbers::<4>("color")?
    };
    Some(Color::linear_rgba(r, g, b, a))
}
