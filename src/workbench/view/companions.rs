//! What stands beside an element: each can be added, changed and removed.

use super::field::{Drag, line, vector};
use super::laws;
use crate::element::*;
use crate::workbench::model::snapshot::Snapshot;
use bevy::prelude::Vec3;
use bevy_egui::egui::{ComboBox, Grid, Ui};

/// Shows all that fit an element.
pub(super) fn show(ui: &mut Ui, draft: &mut Snapshot, custom: [bool; 2]) {
    let torsion = draft.part.is_torsion();
    let [force, length] = if torsion {
        [" N m", " rad"]
    } else {
        [" N", " m"]
    };
    // A rest length is what a law starts from, so a sensible one starts at the element's own numbers.
    let stiffness = draft.part.stiffness();
    let damping = draft.part.damping();
    let rest = draft.part.rest().unwrap_or(1.0);

    if custom[0] {
        ui.label("The spring's force is a function of the game's own.");
    } else if let Some(stiffness) = stiffness {
        laws::spring(ui, &mut draft.spring_law, stiffness);
    }
    if custom[1] {
        ui.label("The damper's force is a function of the game's own.");
    } else if let Some(damping) = damping {
        laws::damping(ui, &mut draft.damping_law, damping);
    }
    action(ui, &mut draft.action);
    if optional(ui, "preload", &mut draft.preload, Preload(0.0))
        && let Some(Preload(value)) = &mut draft.preload
    {
        grid(ui, "preload", |ui| {
            line(ui, "tension", value, force, Drag::Even(0.5))
        });
    }
    let most = MaxForce(1_000.0);
    if optional(ui, "force limit", &mut draft.max_force, most)
        && let Some(MaxForce(value)) = &mut draft.max_force
    {
        grid(ui, "limit", |ui| {
            line(ui, "most", value, force, Drag::Share)
        });
    }
    let stops = SpringTravel::new(
        0.5 * rest.abs(),
        1.5 * rest.abs().max(0.1),
        10.0 * stiffness.unwrap_or(100.0),
    );
    if optional(ui, "stops", &mut draft.travel, stops)
        && let Some(travel) = &mut draft.travel
    {
        grid(ui, "stops", |ui| {
            let [min, max] = if torsion || draft.axis.is_some() {
                [Drag::Even(0.005); 2]
            } else {
                [Drag::Positive(0.005); 2]
            };
            line(ui, "least length", &mut travel.min_length, length, min);
            line(ui, "greatest length", &mut travel.max_length, length, max);
            let stop = &mut travel.stop_stiffness;
            line(ui, "stop stiffness", stop, " N/m", Drag::Share);
            let progression = &mut travel.progression;
            line(ui, "progression", progression, " 1/m", Drag::Positive(0.05));
            line(
                ui,
                "stop damping",
                &mut travel.stop_damping,
                " N s/m",
                Drag::Share,
            );
        });
    }
    let breaks = Breakable::at_force(1_000.0);
    if optional(ui, "breaks", &mut draft.breakable, breaks)
        && let Some(limit) = &mut draft.breakable
    {
        grid(ui, "breaks", |ui| {
            line(ui, "at force", &mut limit.force, force, Drag::Share);
            line(ui, "at length", &mut limit.length, length, Drag::Share);
            ui.label("then");
            choice(
                ui,
                "then",
                &mut limit.then,
                &[
                    (WhenBroken::Despawn, "it is despawned"),
                    (WhenBroken::Disable, "it is disabled"),
                ],
            );
            ui.end_row();
        });
    }
    if !torsion {
        axis(ui, &mut draft.axis);
    }
}

/// A companion that is there or not; whether it is.
fn optional<T: Clone>(ui: &mut Ui, name: &str, part: &mut Option<T>, new: T) -> bool {
    let mut there = part.is_some();
    if ui.checkbox(&mut there, name).changed() {
        *part = there.then_some(new);
    }
    part.is_some()
}

/// Indented lines of names and numbers.
pub(super) fn grid(ui: &mut Ui, name: &str, lines: impl FnOnce(&mut Ui)) {
    ui.indent(name, |ui| {
        Grid::new(name).num_columns(2).show(ui, lines);
    });
}

/// One of several.
pub(super) fn choice<T: PartialEq + Clone>(
    ui: &mut Ui,
    name: &str,
    value: &mut T,
    choices: &[(T, &str)],
) -> bool {
    let chosen = choices.iter().find(|(choice, _)| choice == value);
    let mut changed = false;
    ComboBox::from_id_salt(name)
        .selected_text(chosen.map_or("", |(_, text)| *text))
        .show_ui(ui, |ui| {
            for (choice, text) in choices {
                changed |= ui.selectable_value(value, choice.clone(), *text).changed();
            }
        });
    changed
}

fn action(ui: &mut Ui, action: &mut Option<SpringAction>) {
    ui.horizontal(|ui| {
        ui.label("acts");
        choice(
            ui,
            "action",
            action,
            &[
                (None, "both ways"),
                (Some(SpringAction::Pull), "by pulling only"),
                (Some(SpringAction::Push), "by pushing only"),
            ],
        );
        if *action == Some(SpringAction::Both) {
            ui.label("both ways");
        }
    });
}

fn axis(ui: &mut Ui, axis: &mut Option<SpringAxis>) {
    /// Which kind it is.
    #[derive(Clone, Copy, PartialEq)]
    enum Kind {
        None,
        World,
        BodyA,
    }
    let (before, mut along) = match axis {
        None => (Kind::None, Vec3::Y),
        Some(SpringAxis::World(axis)) => (Kind::World, *axis),
        Some(SpringAxis::BodyA(axis)) => (Kind::BodyA, *axis),
    };
    let mut kind = before;
    ui.horizontal(|ui| {
        ui.label("direction");
        choice(
            ui,
            "axis",
            &mut kind,
            &[
                (Kind::None, "from end to end"),
                (Kind::World, "an axis of the world"),
                (Kind::BodyA, "an axis of A"),
            ],
        );
    });
    if kind != Kind::None {
        ui.indent("axis", |ui| vector(ui, &mut along, 0.01));
    }
    *axis = match kind {
        Kind::None => None,
        Kind::World => Some(SpringAxis::World(along)),
        Kind::BodyA => Some(SpringAxis::BodyA(along)),
    };
}
