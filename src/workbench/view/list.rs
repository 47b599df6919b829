//! Shows the list of all elements. Only the visible rows are laid out.

use super::field::brief;
use crate::workbench::bench::Bench;
use crate::workbench::model::rows::{Order, Row};
use bevy::prelude::Entity;
use bevy_egui::egui::text::{LayoutJob, TextWrapping};
use bevy_egui::egui::{
    Align2, Color32, Rect, ScrollArea, Sense, TextEdit, TextStyle, Ui, WidgetInfo, WidgetType,
    pos2, vec2,
};

/// Width of a column of numbers, logical pixels.
const NUMBER: f32 = 58.0;

/// Draws the list. Returns the element that was clicked.
pub(super) fn show(ui: &mut Ui, bench: &mut Bench) -> Option<Entity> {
    ui.add_space(2.0);
    let rows = &mut bench.rows;
    let hint = format!("Search {} elements", rows.total());
    let search = TextEdit::singleline(&mut rows.search)
        .hint_text(hint)
        .desired_width(f32::INFINITY);
    let mut changed = ui.add(search).changed();
    ui.horizontal(|ui| {
        ui.label("Sort by");
        for (order, text) in [
            (Order::Name, "name"),
            (Order::Force, "force"),
            (Order::OmegaDt, "ω·dt"),
            (Order::Energy, "energy"),
        ] {
            changed |= ui.selectable_value(&mut rows.order, order, text).changed();
        }
    });
    if changed {
        rows.arrange();
    }
    let height = ui.text_style_height(&TextStyle::Body) + 2.0;
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let weak = ui.visuals().weak_text_color();
    let titles = ["force", "ω·dt", "energy, J"].map(String::from);
    columns(ui, place, "name", titles, weak);
    ui.separator();
    let (mut chosen, selected, rows) = (None, bench.selected, &bench.rows);
    ScrollArea::vertical()
        .auto_shrink(false)
        .show_rows(ui, height, rows.len(), |ui, range| {
            for row in range.filter_map(|i| rows.get(i)) {
                if line(ui, row, height, selected == Some(row.entity)) {
                    chosen = Some(row.entity);
                }
            }
        });
    chosen
}

/// Shows one row of the list, and returns whether it was clicked. The row is a single widget with painted texts. A
/// widget for each text would take half of the panel's time.
fn line(ui: &mut Ui, row: &Row, height: f32, is_selected: bool) -> bool {
    let size = vec2(ui.available_width(), height);
    let (place, response) = ui.allocate_exact_size(size, Sense::click());
    response
        .widget_info(|| WidgetInfo::selected(WidgetType::Button, true, is_selected, &row.label));
    let visuals = ui.visuals();
    let fill = if is_selected {
        Some(visuals.selection.bg_fill)
    } else if response.hovered() {
        Some(visuals.widgets.hovered.weak_bg_fill)
    } else {
        None
    };
    let color = visuals.text_color();
    if let Some(fill) = fill {
        ui.painter().rect_filled(place, 2.0, fill);
    }
    let numbers = [row.force, row.omega_dt, row.energy].map(|number| brief(f64::from(number)));
    columns(ui, place, &row.label, numbers, color);
    response.clicked()
}

/// Paints a name, truncated if it is too long, and three numbers on the right.
fn columns(ui: &Ui, place: Rect, name: &str, numbers: [String; 3], color: Color32) {
    let font = TextStyle::Body.resolve(ui.style());
    let mut right = place.right();
    for number in numbers.into_iter().rev() {
        let at = pos2(right - 2.0, place.center().y);
        ui.painter()
            .text(at, Align2::RIGHT_CENTER, number, font.clone(), color);
        right -= NUMBER;
    }
    let mut job = LayoutJob::simple_singleline(name.into(), font, color);
    job.wrap = TextWrapping::truncate_at_width((right - place.left() - 4.0).max(0.0));
    let galley = ui.ctx().fonts_mut(|fonts| fonts.layout_job(job));
    let top = place.center().y - 0.5 * galley.size().y;
    ui.painter()
        .galley(pos2(place.left() + 2.0, top), galley, color);
}
