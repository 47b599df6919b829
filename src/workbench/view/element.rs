//! Shows the chosen element: its ends, verdict, numbers, readout and companions.

use super::companions;
use super::field::{Drag, brief, is_changed, line, number, vector};
use crate::element::SpringLaw;
use crate::readout::SpringReadout;
use crate::workbench::bench::{Ask, Bench};
use crate::workbench::model::facts::{EndKind, Facts};
use crate::workbench::model::snapshot::Snapshot;
use crate::workbench::model::units::Units;
use crate::workbench::model::verdict::{Tone, verdict};
use crate::workbench::model::{code, preset};
use bevy_egui::egui::{Button, Color32, ComboBox, Grid, RichText, ScrollArea, TextEdit, Ui};

pub(super) fn show(ui: &mut Ui, bench: &mut Bench) {
    let Some(subject) = bench.subject.clone() else {
        ui.add_space(8.0);
        ui.label("Choose an element in the list, or click it in the scene.");
        return;
    };
    // Fields of two elements must not be the same to egui: it keeps what is typed by field.
    let fields = ScrollArea::vertical().id_salt(subject.entity);
    fields.auto_shrink(false).show(ui, |ui| {
        ui.add_space(2.0);
        ui.label(RichText::new(&subject.title).heading());
        ends(ui, &subject.now, &subject.facts);
        exports(ui, bench, &subject.title, &subject.now);
        // `exports` may have reset the element just now.
        let reset = bench.subject.as_ref().map(|subject| subject.now.clone());
        let mut draft = reset.unwrap_or(subject.now.clone());
        ui.separator();
        for sentence in verdict(&subject.now, &subject.facts) {
            ui.label(RichText::new(sentence.text).color(color(ui, sentence.tone)));
        }
        ui.separator();
        Grid::new("numbers").num_columns(2).show(ui, |ui| {
            numbers(ui, &mut draft, &subject.facts);
        });
        // Numbers and companions have different names in the history, so that their changes are not merged into one
        // edit.
        changed(bench, &draft, "a number");
        ui.separator();
        if let Some(sample) = bench.sample() {
            readout(ui, &sample.readout, draft.part.units());
        }
        ui.separator();
        companions::show(ui, &mut draft, &subject.facts);
        changed(bench, &draft, "a companion");
    });
}

fn changed(bench: &mut Bench, draft: &Snapshot, what: &'static str) {
    bench.edit(what, draft.clone());
}

fn color(ui: &Ui, tone: Tone) -> Color32 {
    match tone {
        Tone::Good => Color32::from_rgb(120, 200, 120),
        Tone::Plain => ui.visuals().text_color(),
        Tone::Warning => ui.visuals().warn_fg_color,
        Tone::Bad => ui.visuals().error_fg_color,
    }
}

/// Shows the ends of the element.
fn ends(ui: &mut Ui, draft: &Snapshot, facts: &Facts) {
    ui.label(RichText::new(draft.part.name()).weak());
    for (name, end) in ["A", "B"].into_iter().zip(&facts.ends) {
        let kind = match end.kind {
            EndKind::Missing => "missing",
            EndKind::Point => "no body",
            EndKind::Fixed => "fixed",
            EndKind::Kinematic => "kinematic",
            EndKind::Dynamic if end.asleep => "asleep",
            EndKind::Dynamic => "dynamic",
        };
        ui.label(format!("{name}: {} ({kind})", end.name));
    }
}

/// Shows stiffness, damping and rest length, and the figures derived from them.
fn numbers(ui: &mut Ui, draft: &mut Snapshot, facts: &Facts) {
    let torsion = draft.part.is_torsion();
    let units = draft.part.units();
    // A law with coefficients of its own does not use the element's, nor does a function of the game.
    let used = match draft.spring_law {
        _ if facts.custom[0] => None,
        None | Some(SpringLaw::Linear) => Some(units.stiffness),
        Some(SpringLaw::Cubic) => Some(units.stiffness_cubed),
        Some(SpringLaw::Polynomial { .. } | SpringLaw::Table(_)) => None,
    };
    if let (Some(value), Some(unit)) = (draft.part.stiffness_mut(), used) {
        line(ui, "stiffness", value, unit, Drag::Share);
    }
    let linear = facts.damper_is_linear(draft);
    if let Some(value) = draft.part.damping_mut().filter(|_| linear) {
        line(ui, "damping", value, units.damping, Drag::Share);
    }
    let drag = if draft.has_sign() {
        Drag::Even(0.002)
    } else {
        Drag::Positive(0.002)
    };
    if let Some(rest) = draft.part.rest_mut() {
        ui.label(if torsion { "rest angle" } else { "rest length" });
        match rest {
            Some(value) => {
                number(ui, value, units.length, drag);
            }
            None => {
                ui.label("as at the first step");
            }
        }
        ui.end_row();
    }
    figures(ui, draft, facts);
    if let Some(axis) = draft.part.twist_mut() {
        ui.label("axis, in A");
        vector(ui, axis, 0.01);
        ui.end_row();
    } else {
        let mut anchors = draft.anchors.unwrap_or_default();
        for (name, point) in [
            ("anchor on A", &mut anchors.a),
            ("anchor on B", &mut anchors.b),
        ] {
            ui.label(name);
            vector(ui, point, 0.005);
            ui.end_row();
        }
        if draft.anchors.is_some() || anchors != Default::default() {
            draft.anchors = Some(anchors);
        }
    }
}

/// Shows frequency, damping ratio, sag, effective mass and critical damping. Editing the first three changes
/// stiffness and damping.
fn figures(ui: &mut Ui, draft: &mut Snapshot, facts: &Facts) {
    let (Some(load), Some(stiffness)) = (facts.load_of(draft), draft.part.stiffness()) else {
        return;
    };
    if stiffness.is_nan() || stiffness <= 0.0 {
        return;
    }
    let (torsion, units) = (draft.part.is_torsion(), draft.part.units());
    let damping = draft.part.damping();
    let damping = damping.filter(|_| facts.damper_is_linear(draft));
    let mut frequency = load.frequency(stiffness);
    ui.label("frequency");
    if is_changed(ui, &mut frequency, " Hz", Drag::Share) && frequency > 0.0 {
        set(
            draft.part.stiffness_mut(),
            load.stiffness_for_frequency(frequency),
        );
    }
    ui.end_row();
    if let Some(damping) = damping {
        let mut ratio = load.ratio(stiffness, damping);
        ui.label("damping ratio");
        if is_changed(ui, &mut ratio, "", Drag::Positive(0.005)) {
            set(
                draft.part.damping_mut(),
                load.damping_for_ratio(stiffness, ratio),
            );
        }
        ui.end_row();
    }
    if !torsion && load.gravity > 0.0 {
        let mut sag = load.sag(stiffness);
        ui.label("sag")
            .on_hover_text("The rest length goes with it: the load stays where it rests");
        if is_changed(ui, &mut sag, units.length, Drag::Share) {
            facts.set_sag(draft, sag);
        }
        ui.end_row();
    }
    ui.label("effective mass");
    ui.label(format!("{}{}", brief(load.mass.into()), units.mass));
    ui.end_row();
    if damping.is_some() {
        let critical = f64::from(load.critical(stiffness));
        ui.label("critical damping");
        ui.label(format!("{}{}", brief(critical), units.damping));
        ui.end_row();
    }
}

fn set(field: Option<&mut f32>, value: f32) {
    if let Some(field) = field.filter(|_| value.is_finite()) {
        *field = value;
    }
}

/// Shows the readout of the last step, or of the chosen time in the record.
fn readout(ui: &mut Ui, readout: &SpringReadout, units: &Units) {
    let lines = [
        ("length", readout.length, units.length),
        ("rate", readout.rate, units.rate),
        ("spring force", readout.spring_force, units.force),
        ("damper force", readout.damper_force, units.force),
        ("stored energy", readout.stored_energy, " J"),
        ("dissipated", readout.dissipated_energy, " J"),
        ("dissipated power", readout.dissipated_power, " W"),
        ("work done on it", readout.work, " J"),
    ];
    Grid::new("readout").num_columns(4).show(ui, |ui| {
        for pair in lines.chunks(2) {
            for (name, value, unit) in pair {
                ui.label(RichText::new(*name).weak());
                ui.label(format!("{}{unit}", brief(f64::from(*value))));
            }
            ui.end_row();
        }
    });
}

/// A function that writes an element as text.
type Writer = fn(&Snapshot) -> Result<String, String>;

/// Shows the buttons for reset, copy, paste and presets.
fn exports(ui: &mut Ui, bench: &mut Bench, title: &str, draft: &Snapshot) {
    ui.horizontal(|ui| {
        let edited = bench
            .selected
            .is_some_and(|entity| bench.history.has(entity));
        let reset = ui.add_enabled(edited, Button::new("Reset"));
        if reset
            .on_hover_text("Takes back all edits of this element")
            .clicked()
        {
            bench.reset();
        }
        ui.separator();
        ui.label("Copy as");
        if ui.button("Rust").clicked() {
            let text = code::rust(draft, &code::function_name(title), title);
            bench.asks.push(Ask::Copy(text, "Rust"));
        }
        for (what, written) in [("JSON", preset::json as Writer), ("RON", preset::ron)] {
            if ui.button(what).clicked() {
                match written(draft) {
                    Ok(text) => bench.asks.push(Ask::Copy(text, what)),
                    Err(wrong) => bench.message = Some(wrong),
                }
            }
        }
        ui.separator();
        let paste = ui.button("Paste");
        if paste
            .on_hover_text("JSON or RON, into this element")
            .clicked()
        {
            bench.asks.push(Ask::Paste);
        }
    });
    ui.horizontal(|ui| {
        let name = TextEdit::singleline(&mut bench.preset_name)
            .hint_text("preset name")
            .desired_width(120.0);
        ui.add(name);
        let named = !bench.preset_name.trim().is_empty();
        if ui.add_enabled(named, Button::new("Save")).clicked() {
            let name = bench.preset_name.trim();
            match preset::text_for(name, draft) {
                Ok(text) => bench.asks.push(Ask::Save(name.into(), text)),
                Err(wrong) => bench.message = Some(wrong),
            }
        }
        ComboBox::from_id_salt("presets")
            .selected_text("Load")
            .width(80.0)
            .show_ui(ui, |ui| {
                for name in &bench.presets {
                    if ui.selectable_label(false, name).clicked() {
                        bench.asks.push(Ask::Load(name.clone()));
                    }
                }
                if bench.presets.is_empty() {
                    ui.label("none saved yet");
                }
            });
    });
}
