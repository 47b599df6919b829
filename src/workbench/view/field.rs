//! Numbers with units that can be dragged and typed.

use crate::workbench::model::like::is_like;
use bevy::prelude::Vec3;
use bevy_egui::egui::{DragValue, Response, Ui};

/// How a number is dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drag {
    /// By a share of itself: never below zero.
    Share,
    /// By so much for a pixel.
    Even(f64),
    /// By so much for a pixel, never below zero.
    Positive(f64),
}

/// As a share of the number, for a pixel.
const SHARE: f64 = 0.01;

/// A number as short as six digits allow.
pub(crate) fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let size = value.abs().log10().floor() as i32;
    if !(-4..9).contains(&size) {
        return format!("{value:.4e}");
    }
    let text = format!("{value:.*}", (5 - size).max(0) as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').into()
    } else {
        text
    }
}

/// As [`significant`], with four digits: for what is only read.
pub(super) fn brief(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let size = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&size) {
        return format!("{value:.2e}");
    }
    format!("{value:.*}", (3 - size).clamp(0, 4) as usize)
}

/// What a person types: with comma or point, and with or without the unit.
fn parse(text: &str) -> Option<f64> {
    let text = text.trim().replace(',', ".");
    if text.eq_ignore_ascii_case("inf") {
        return Some(f64::INFINITY);
    }
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
    text[..end.unwrap_or(text.len())].trim().parse().ok()
}

/// A number that can be dragged and typed.
pub(super) fn number(ui: &mut Ui, value: &mut f32, unit: &str, drag: Drag) -> Response {
    let size = f64::from(value.abs());
    let (speed, least) = match drag {
        Drag::Share => ((SHARE * size).max(1e-4), 0.0),
        Drag::Even(speed) => (speed, -1e12),
        Drag::Positive(speed) => (speed, 0.0),
    };
    let least = least as f32;
    // What stands there already is not changed by being shown.
    let range = least..=f32::INFINITY;
    // A NaN is another number than itself, and what is typed over a number that is another one in every frame is thrown
    // away: it is shown as it is, and edited from zero.
    let is_nan = value.is_nan();
    let get_set = move |new: Option<f64>| {
        if let Some(new) = new {
            *value = new as f32;
        }
        if value.is_nan() {
            0.0
        } else {
            f64::from(*value)
        }
    };
    ui.add(
        DragValue::from_get_set(get_set)
            .speed(speed)
            .range(range)
            .clamp_existing_to_range(false)
            .update_while_editing(false)
            .custom_formatter(move |value, _| significant(if is_nan { f64::NAN } else { value }))
            .custom_parser(parse)
            .suffix(unit),
    )
}

/// The same for a number that others are made from; says whether it is another one now. The response says so too when a
/// letter is typed that is not taken yet: numbers that were made anew from the same one would differ by their rounding, and
/// what shows a number that has changed forgets what is being typed.
pub(super) fn is_changed(ui: &mut Ui, value: &mut f32, unit: &str, drag: Drag) -> bool {
    let before = *value;
    number(ui, value, unit, drag);
    !is_like(&*value, &before)
}

/// A line of a grid with a name and a number.
pub(super) fn line(ui: &mut Ui, name: &str, value: &mut f32, unit: &str, drag: Drag) {
    ui.label(name);
    number(ui, value, unit, drag);
    ui.end_row();
}

/// Three coordinates.
pub(super) fn vector(ui: &mut Ui, value: &mut Vec3, speed: f64) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for coordinate in [&mut value.x, &mut value.y, &mut value.z] {
            number(ui, coordinate, "", Drag::Even(speed));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let text: Vec<_> = [0.0, 80.0, 29_430.0, 0.1_f32.into(), 1.0 / 3.0, 1e-7, 2e12]
            .map(significant)
            .into();
        assert_eq!(
            text,
            [
                "0",
                "80",
                "29430",
                "0.1",
                "0.333333",
                "1.0000e-7",
                "2.0000e12"
            ]
        );
        assert_eq!(brief(1234.567), "1235");
        assert_eq!(brief(0.012345), "0.0123");
    }

    #[test]
    fn what_a_person_types_is_read() {
        assert_eq!(parse("2,5"), Some(2.5));
        assert_eq!(parse(" 80 N/m"), Some(80.0));
        assert_eq!(parse("1e5"), Some(1e5));
        assert_eq!(parse("inf"), Some(f64::INFINITY));
        assert_eq!(parse("much"), None);
        assert_eq!(parse(""), None);
    }
}
