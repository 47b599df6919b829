//! Draws the workbench with egui. Nothing here accesses the world.

mod companions;
mod element;
mod field;
mod laws;
mod list;
mod plots;

use super::bench::{Ask, Bench};
use super::model::facts::Subject;
use bevy::input::keyboard::KeyCode;
use bevy_egui::egui::{self, Panel, Rect, RichText, Ui};

pub(crate) use field::significant;

/// Speeds of the clock to choose from, relative to real time.
const SPEEDS: [f32; 7] = [1.0 / 32.0, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0];

/// Draws the whole workbench, around the middle of the window. Returns the rectangle that it leaves free.
///
/// Drawing a field carries out what was typed into it before the user clicked elsewhere. So undo, redo and a new choice wait
/// until all fields are drawn.
pub(crate) fn show(ui: &mut Ui, bench: &mut Bench) -> Rect {
    let mut step = None;
    Panel::top("coilover_workbench_bar").show(ui, |ui| step = bar(ui, bench));
    Panel::bottom("coilover_workbench_plots")
        .default_size(230.0)
        .size_range(140.0..=500.0)
        .resizable(true)
        .show(ui, |ui| plots::show(ui, bench));
    let mut chosen = None;
    Panel::left("coilover_workbench_list")
        .default_size(285.0)
        .resizable(true)
        .show(ui, |ui| chosen = list::show(ui, bench));
    Panel::right("coilover_workbench_element")
        .default_size(345.0)
        .resizable(true)
        .show(ui, |ui| element::show(ui, bench));
    match step.or_else(|| shortcut(ui)) {
        Some(Step::Back) => bench.undo(),
        Some(Step::Again) => bench.redo(),
        None => {}
    }
    if let Some(entity) = chosen.or(bench.picked.take()) {
        bench.select(Some(entity));
    }
    // A drag changes its number in each frame. A typed number changes once.
    if !ui.input(|input| input.pointer.any_down()) {
        bench.history.close();
    }
    ui.available_rect_before_wrap()
}

/// A step in the history.
#[derive(Clone, Copy, Debug)]
enum Step {
    Back,
    Again,
}

/// Returns the step whose keys were pressed.
fn shortcut(ui: &Ui) -> Option<Step> {
    if ui.ctx().egui_wants_keyboard_input() {
        return None;
    }
    use egui::{Key, KeyboardShortcut, Modifiers};
    let again = KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    let back = KeyboardShortcut::new(Modifiers::COMMAND, Key::Z);
    if ui.input_mut(|input| input.consume_shortcut(&again)) {
        return Some(Step::Again);
    }
    let back = ui.input_mut(|input| input.consume_shortcut(&back));
    back.then_some(Step::Back)
}

/// Draws the bar at the top: clock, undo and messages. Returns the step that was clicked.
fn bar(ui: &mut Ui, bench: &mut Bench) -> Option<Step> {
    let mut clicked = None;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Springs").strong());
        ui.separator();
        let paused = bench.clock.paused;
        let pause = if paused { "Run" } else { "Pause" };
        if ui.button(pause).clicked() {
            bench.asks.push(Ask::Pause(!paused));
        }
        let step = ui.add_enabled(bench.clock.steps, egui::Button::new("Step"));
        let step = step.on_hover_text("One tick");
        let step = step.on_disabled_hover_text("The springs are not in a fixed schedule");
        if step.clicked() {
            bench.asks.push(Ask::Step);
        }
        let speed = bench.clock.speed;
        egui::ComboBox::from_id_salt("speed")
            .width(64.0)
            .selected_text(speed_text(speed))
            .show_ui(ui, |ui| {
                for choice in SPEEDS {
                    if ui
                        .selectable_label(speed == choice, speed_text(choice))
                        .clicked()
                    {
                        bench.asks.push(Ask::Speed(choice));
                    }
                }
            });
        ui.separator();
        let [undo, redo] = bench.history.next();
        let button = |ui: &mut Ui, text: &str, what: Option<&str>| {
            let button = ui.add_enabled(what.is_some(), egui::Button::new(text));
            button.on_hover_text(what.unwrap_or_default()).clicked()
        };
        if button(ui, "Undo", undo) {
            clicked = Some(Step::Back);
        }
        if button(ui, "Redo", redo) {
            clicked = Some(Step::Again);
        }
        ui.separator();
        if let Some(message) = &bench.message {
            ui.label(message);
        }
        let hint = egui::Label::new(RichText::new(hint(bench)).weak()).truncate();
        let right = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(right, |ui| ui.add(hint));
    });
    clicked
}

/// Returns a hint about what the mouse does in the scene.
fn hint(bench: &Bench) -> String {
    let mut hint = String::new();
    if let Some(key) = bench.grab {
        hint += &format!("{} + drag pulls a body", key_name(key));
    }
    let has_anchors = |subject: &Subject| !subject.now.part.is_torsion();
    if bench.subject.as_ref().is_some_and(has_anchors) {
        let gap = if hint.is_empty() { "" } else { "; " };
        hint = format!("Drag a ball to move its anchor{gap}{hint}");
    }
    hint
}

/// Returns the name of a key as printed on a keyboard.
fn key_name(key: KeyCode) -> String {
    let name = match key {
        KeyCode::ShiftLeft => "left Shift",
        KeyCode::ShiftRight => "right Shift",
        KeyCode::ControlLeft => "left Ctrl",
        KeyCode::ControlRight => "right Ctrl",
        KeyCode::AltLeft => "left Alt",
        KeyCode::AltRight => "right Alt",
        other => return format!("{other:?}").trim_start_matches("Key").into(),
    };
    name.into()
}

fn speed_text(speed: f32) -> String {
    if speed < 1.0 && speed > 0.0 {
        format!("1/{}", significant(f64::from(speed.recip())))
    } else {
        format!("{}×", significant(f64::from(speed)))
    }
}
