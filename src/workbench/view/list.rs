//! All elements; only those in sight are laid out.

use super::field::brief;
use crate::workbench::bench::Bench;
use crate::workbench::model::rows::Order;
use bevy_egui::egui::{Align, Layout, RichText, ScrollArea, Sense, TextEdit, Ui, UiBuilder};

/// Width of a column of numbers.
const NUMBER: f32 = 58.0;

pub(super) fn show(ui: &mut Ui, bench: &mut Bench) {
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
    let height = ui.text_style_height(&bevy_egui::egui::TextStyle::Body) + 2.0;
    columns(ui, height, None, |ui, column| {
        let text = ["name", "force, N", "ω·dt", "energy, J"][column];
        ui.label(RichText::new(text).weak());
    });
    ui.separator();
    let (mut chosen, selected, rows) = (None, bench.selected, &bench.rows);
    ScrollArea::vertical()
        .auto_shrink(false)
        .show_rows(ui, height, rows.len(), |ui, range| {
            for row in range.filter_map(|i| rows.get(i)) {
                let is_selected = selected == Some(row.entity);
                let clicked = columns(ui, height, Some(is_selected), |ui, column| {
                    let value = [0.0, row.force, row.omega_dt, row.energy][column];
                    if column == 0 {
                        ui.add(
                            bevy_egui::egui::Label::new(row.label.as_str())
                                .truncate()
                                .selectable(false),
                        );
                    } else {
                        ui.add(
                            bevy_egui::egui::Label::new(brief(f64::from(value))).selectable(false),
                        );
                    }
                });
                if clicked {
                    chosen = Some(row.entity);
                }
            }
        });
    if chosen.is_some() {
        bench.select(chosen);
    }
}

/// One row of the list; whether it was clicked.
fn columns(
    ui: &mut Ui,
    height: f32,
    selected: Option<bool>,
    mut cell: impl FnMut(&mut Ui, usize),
) -> bool {
    let size = bevy_egui::egui::vec2(ui.available_width(), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    if let Some(selected) = selected {
        if selected {
            let fill = ui.visuals().selection.bg_fill;
            ui.painter().rect_filled(rect, 2.0, fill);
        } else if response.hovered() {
            let fill = ui.visuals().widgets.hovered.weak_bg_fill;
            ui.painter().rect_filled(rect, 2.0, fill);
        }
    }
    let mut right = rect.right();
    for column in (1..=3).rev() {
        let mut place = rect;
        place.set_right(right);
        place.set_left(right - NUMBER);
        right -= NUMBER;
        let layout = Layout::right_to_left(Align::Center);
        let mut child = ui.new_child(
            UiBuilder::new()
                .max_rect(place.shrink2([2.0, 0.0].into()))
                .layout(layout),
        );
        cell(&mut child, column);
    }
    let mut place = rect;
    place.set_right(right);
    let layout = Layout::left_to_right(Align::Center);
    let mut child = ui.new_child(
        UiBuilder::new()
            .max_rect(place.shrink2([2.0, 0.0].into()))
            .layout(layout),
    );
    cell(&mut child, 0);
    response.clicked()
}
