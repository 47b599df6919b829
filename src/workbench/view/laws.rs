//! Shows the force laws of springs and dampers.

use super::companions::{choice, grid};
use super::field::{Drag, line, number};
use crate::element::*;
use crate::workbench::model::units::Units;
use bevy::prelude::Vec2;
use bevy_egui::egui::Ui;

/// Whether two laws are of the same kind, whatever their numbers.
fn is<T>(a: &Option<T>, b: &Option<T>) -> bool {
    a.as_ref().map(std::mem::discriminant) == b.as_ref().map(std::mem::discriminant)
}

/// Shows a choice of laws. A newly chosen law starts with numbers near those of the element.
fn law<T: Clone + PartialEq>(
    ui: &mut Ui,
    name: &str,
    law: &mut Option<T>,
    choices: &[(Option<T>, &str)],
) {
    let at = choices.iter().position(|(other, _)| is(other, law));
    let numbers: Vec<_> = choices
        .iter()
        .zip(0..)
        .map(|((_, text), i)| (i, *text))
        .collect();
    let mut chosen = at.unwrap_or(0);
    ui.horizontal(|ui| {
        ui.label(name);
        if choice(ui, name, &mut chosen, &numbers) {
            law.clone_from(&choices[chosen].0);
        }
    });
}

pub(super) fn spring(ui: &mut Ui, spring: &mut Option<SpringLaw>, stiffness: f32, units: &Units) {
    let k = stiffness;
    law(
        ui,
        "spring law",
        spring,
        &[
            (None, "linear"),
            (Some(SpringLaw::Cubic), "cubic"),
            (Some(SpringLaw::polynomial(k, 0.0, 0.0)), "polynomial"),
            (
                Some(SpringLaw::table([(-1.0, -k), (0.0, 0.0), (1.0, k)])),
                "table",
            ),
        ],
    );
    match spring {
        Some(SpringLaw::Polynomial { pull, push }) => {
            for (name, polynomial) in [("pull", pull), ("push", push)] {
                grid(ui, name, |ui| {
                    ui.label(name);
                    ui.end_row();
                    let terms = [
                        ("linear", &mut polynomial.linear, units.stiffness),
                        (
                            "quadratic",
                            &mut polynomial.quadratic,
                            units.stiffness_squared,
                        ),
                        ("cubic", &mut polynomial.cubic, units.stiffness_cubed),
                    ];
                    for (name, coefficient, unit) in terms {
                        line(ui, name, coefficient, unit, Drag::Share);
                    }
                });
            }
        }
        Some(SpringLaw::Table(points)) => {
            table(ui, "spring table", points, [units.length, units.force]);
        }
        None | Some(SpringLaw::Linear | SpringLaw::Cubic) => {}
    }
}

pub(super) fn damping(
    ui: &mut Ui,
    damping: &mut Option<DampingLaw>,
    coefficient: f32,
    units: &Units,
) {
    let c = coefficient;
    let quadratic = DampingLaw::Quadratic {
        linear: c,
        quadratic: 0.0,
    };
    let blow_off = DampingLaw::BlowOff {
        damping: c,
        knee: 1.0,
        beyond: 0.2 * c,
    };
    law(
        ui,
        "damping law",
        damping,
        &[
            (None, "linear"),
            (Some(DampingLaw::sided(c, c)), "bump and rebound"),
            (Some(quadratic), "quadratic"),
            (Some(blow_off), "blow-off"),
            (
                Some(DampingLaw::table([(-1.0, -c), (0.0, 0.0), (1.0, c)])),
                "table",
            ),
        ],
    );
    match damping {
        Some(DampingLaw::Sided { bump, rebound }) => grid(ui, "sided", |ui| {
            line(ui, "bump", bump, units.damping, Drag::Share);
            line(ui, "rebound", rebound, units.damping, Drag::Share);
        }),
        Some(DampingLaw::Quadratic { linear, quadratic }) => grid(ui, "orifice", |ui| {
            line(ui, "linear", linear, units.damping, Drag::Share);
            line(
                ui,
                "quadratic",
                quadratic,
                units.damping_squared,
                Drag::Share,
            );
        }),
        Some(DampingLaw::BlowOff {
            damping,
            knee,
            beyond,
        }) => grid(ui, "blow-off", |ui| {
            line(ui, "damping", damping, units.damping, Drag::Share);
            line(ui, "knee", knee, units.rate, Drag::Share);
            line(ui, "beyond", beyond, units.damping, Drag::Share);
        }),
        Some(DampingLaw::Table(points)) => {
            table(ui, "damping table", points, [units.rate, units.force]);
        }
        None | Some(DampingLaw::Linear) => {}
    }
}

/// Shows the points of a table, which can be moved, added and removed. `[x, y]` are the units of their coordinates.
fn table(ui: &mut Ui, name: &str, table: &mut ForceTable, [x, y]: [&str; 2]) {
    let mut removed = None;
    grid(ui, name, |ui| {
        for (i, point) in table.points.iter_mut().enumerate() {
            number(ui, &mut point.x, x, Drag::Even(0.005));
            number(ui, &mut point.y, y, Drag::Even(0.5));
            if ui
                .small_button("−")
                .on_hover_text("Remove this point")
                .clicked()
            {
                removed = Some(i);
            }
            ui.end_row();
        }
        if ui.small_button("+").on_hover_text("Add a point").clicked() {
            let next = match table.points[..] {
                [.., a, b] => b + (b - a),
                [a] => a + Vec2::ONE,
                [] => Vec2::ZERO,
            };
            table.points.push(next);
        }
    });
    if let Some(i) = removed {
        table.points.remove(i);
    }
}
