//! Shows the companions of an element. Each can be added, changed and removed.

use super::field::{Drag, line, vector};
use super::laws;
use crate::element::*;
use crate::workbench::model::facts::Facts;
use crate::workbench::model::snapshot::Snapshot;
use bevy::prelude::Vec3;
use bevy_egui::egui::{ComboBox, Grid, Ui};

/// Shows all companions that fit an element.
pub(super) fn show(ui: &mut Ui, draft: &mut Snapshot, facts: &Facts) {
    let torsion = draft.part.is_torsion();
    let units = draft.part.units();
    let (force, length) = (units.force, units.length);
    // New laws and stops start from the element's own stiffness, damping and rest length.
    let stiffness = draft.part.stiffness();
    let damping = draft.part.damping();
    let has_sign = draft.has_sign();
    // A damper has no rest length. Its present length is used, once it has been stepped.
    let length_now = Some(facts.readout.length).filter(|length| *length != 0.0);
    let unknown = if has_sign { 0.0 } else { 1.0 };
    let rest = draft.part.rest().or(length_now).unwrap_or(unknown);

    if facts.custom[0] {
        ui.label("The spring's force is a function of the game's own.");
    } else if let Some(stiffness) = stiffness {
        laws::spring(ui, &mut draft.spring_law, stiffness, units);
    }
    if facts.custom[1] {
        ui.label("The damper's force is a function of the game's own.");
    } else if let Some(damping) = damping {
        laws::damping(ui, &mut draft.damping_law, damping, units);
    }
    action(ui, &mut draft.action);
    if optional(ui, "preload", &mut draft.preload, Preload(0.0))
        && let Some(Preload(value)) = &mut draft.preload
    {
        grid(ui, "preload", |ui| {
            line(ui, "tension", value, force, Drag::Even(0.5))
        });
    }
    // A new limit must not drop the load.
    let strong = 1_000.0_f32.max(2.0 * facts.readout.force().abs());
    let most = MaxForce(strong);
    if optional(ui, "force limit", &mut draft.max_force, most)
        && let Some(MaxForce(value)) = &mut draft.max_force
    {
        grid(ui, "limit", |ui| {
            line(ui, "most", value, force, Drag::Share)
        });
    }
    let new = stops(rest, has_sign, 10.0 * stiffness.unwrap_or(100.0));
    if optional(ui, "stops", &mut draft.travel, new)
        && let Some(travel) = &mut draft.travel
    {
        grid(ui, "stops", |ui| {
            let drag = if has_sign {
                Drag::Even(0.005)
            } else {
                Drag::Positive(0.005)
            };
            line(ui, "least length", &mut travel.min_length, length, drag);
            line(ui, "greatest length", &mut travel.max_length, length, drag);
            let stop = &mut travel.stop_stiffness;
            line(ui, "stop stiffness", stop, units.stiffness, Drag::Share);
            let (progression, drag) = (&mut travel.progression, Drag::Positive(0.05));
            line(ui, "progression", progression, units.progression, drag);
            let damping = &mut travel.stop_damping;
            line(ui, "stop damping", damping, units.damping, Drag::Share);
        });
    }
    let breaks = Breakable::at_force(strong);
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

/// Returns the stops for an element without any: on both sides of the rest length, at half of it away.
fn stops(rest: f32, has_sign: bool, stiffness: f32) -> SpringTravel {
    let least = if has_sign { f32::NEG_INFINITY } else { 0.0 };
    let rest = if rest.is_finite() {
        rest.max(least)
    } else {
        0.0
    };
    let away = 0.5 * rest.abs().max(0.1);
    SpringTravel::new((rest - away).max(least), rest + away, stiffness)
}

/// Shows a companion with a checkbox. Returns whether it is present.
fn optional<T: Clone>(ui: &mut Ui, name: &str, part: &mut Option<T>, new: T) -> bool {
    let mut there = part.is_some();
    if ui.checkbox(&mut there, name).changed() {
        *part = there.then_some(new);
    }
    part.is_some()
}

/// Shows indented lines of names and numbers.
pub(super) fn grid(ui: &mut Ui, name: &str, lines: impl FnOnce(&mut Ui)) {
    ui.indent(name, |ui| {
        Grid::new(name).num_columns(2).show(ui, lines);
    });
}

/// Shows a choice of one value among several. Returns whether it was changed.
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
    /// Kind of the axis.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn new_stops_are_on_either_side_of_the_rest_length_whatever_its_sign() {
        let between = |rest: f32, has_sign: bool| {
            let stops = stops(rest, has_sign, 1.0);
            (stops.min_length, stops.max_length)
        };
        assert_eq!(between(2.0, false), (1.0, 3.0));
        assert_eq!(between(0.0, false), (0.0, 0.05));
        assert_eq!(between(2.0, true), (1.0, 3.0));
        assert_eq!(between(-2.0, true), (-3.0, -1.0));
        assert_eq!(between(0.0, true), (-0.05, 0.05));
        // An invalid rest length is reported elsewhere; the stops are valid.
        for wrong in [f32::NAN, f32::INFINITY, -1.0] {
            assert_eq!(between(wrong, false), (0.0, 0.05));
        }
    }
}
