//! Number fields with units, which can be dragged and typed.

use crate::workbench::model::like::is_like;
use bevy::prelude::Vec3;
use bevy_egui::egui::{DragValue, Response, Ui};

/// How a drag changes a number, and its lower bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drag {
    /// By a fraction of the number per pixel. Never below zero.
    Share,
    /// By a fixed amount per pixel.
    Even(f64),
    /// By a fixed amount per pixel. Never below zero.
    Positive(f64),
}

/// Change per pixel as a fraction of the number, for [`Drag::Share`].
const SHARE: f64 = 0.01;

/// Least change per pixel for [`Drag::Share`], so that a drag also leaves zero.
const SLOWEST: f64 = 1e-4;

/// Formats a number with six significant digits, or more if it has more before the point, without trailing zeros.
/// Very large and very small numbers have an exponent.
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

/// Formats a number that is only read, with at most four significant digits and at most four decimals.
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

/// Parses a typed number, with comma or point, and with or without a unit.
fn parse(text: &str) -> Option<f64> {
    let text = text.trim().replace(',', ".");
    let (sign, size) = match text.strip_prefix('-') {
        Some(size) => (-1.0, size),
        None => (1.0, &*text),
    };
    let word = size.split_whitespace().next().unwrap_or_default();
    if word.eq_ignore_ascii_case("inf") {
        return Some(sign * f64::INFINITY);
    }
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
    text[..end.unwrap_or(text.len())].trim().parse().ok()
}

/// Shows a number that can be dragged and typed.
pub(super) fn number(ui: &mut Ui, value: &mut f32, unit: &str, drag: Drag) -> Response {
    // With infinity, an arrow key would make NaN.
    let size = Some(f64::from(value.abs())).filter(|size| size.is_finite());
    let (speed, least) = match drag {
        Drag::Share => ((SHARE * size.unwrap_or(0.0)).max(SLOWEST), 0.0),
        Drag::Even(speed) => (speed, f32::NEG_INFINITY),
        Drag::Positive(speed) => (speed, 0.0),
    };
    // Showing a number must not change it, so a number outside the range is not clamped.
    let range = least..=f32::INFINITY;
    // NaN differs from itself, and egui discards typed text if the number differs from that of the last frame. So a
    // NaN is shown as such, but edited from zero.
    let is_nan = value.is_nan();
    // The text may have fewer digits than the number. So a text that was left as it is shown is not read, or a click
    // into the field would round the number.
    let shown = f64::from(*value);
    let typed = move |text: &str| {
        if text == significant(shown) {
            None
        } else {
            parse(text)
        }
    };
    let get_set = move |new: Option<f64>| {
        if let Some(new) = new {
            // The arrow keys go below the range.
            *value = (new as f32).max(least);
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
            .custom_parser(typed)
            .suffix(unit),
    )
}

/// Shows a number from which other numbers are computed. Returns whether it has changed. The egui response cannot be
/// used for that: it also reports typed letters that are not accepted yet. Numbers recomputed from an unchanged
/// number would differ by rounding.
///
/// A field whose number has changed forgets the typed text. So the number stands still while the field is in use, and in the
/// pass after that, in which egui may read the text.
pub(super) fn is_changed(ui: &mut Ui, value: &mut f32, unit: &str, drag: Drag) -> bool {
    let id = ui.next_auto_id();
    let (key, typing) = (id.with("held"), ui.memory(|memory| memory.has_focus(id)));
    *value = ui.data_mut(|data| match data.get_temp(key) {
        Some(held) => held,
        None if typing => *data.get_temp_mut_or(key, *value),
        None => *value,
    });
    if !typing {
        ui.data_mut(|data| data.remove::<f32>(key));
    }
    let before = *value;
    number(ui, value, unit, drag);
    !is_like(&*value, &before)
}

/// Shows a name and a number as a line of a grid.
pub(super) fn line(ui: &mut Ui, name: &str, value: &mut f32, unit: &str, drag: Drag) {
    ui.label(name);
    number(ui, value, unit, drag);
    ui.end_row();
}

/// Shows three coordinates.
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
        assert_eq!(parse("-Inf m"), Some(f64::NEG_INFINITY));
        assert_eq!(parse("much"), None);
        assert_eq!(parse(""), None);
    }
}
