//! Plots quantities over time, and forces over length and rate together with the law.

use super::field::brief;
use crate::workbench::bench::{Ask, Bench, Plots};
use crate::workbench::model::record::{Quantity, SECONDS};
use bevy_egui::egui::{Color32, RichText, Slider, Ui, Vec2, Vec2b};
use egui_plot::{HoverPosition, Line, Plot, PlotPoints, Points, VLine};

const SPRING: Color32 = Color32::from_rgb(90, 170, 255);
const DAMPER: Color32 = Color32::from_rgb(255, 150, 60);
const LAW: Color32 = Color32::from_gray(150);
const NOW: Color32 = Color32::from_rgb(240, 230, 90);

const PLAIN: Color32 = Color32::from_gray(190);

/// Greatest number of measured points that are drawn.
const MEASURED: usize = 600;

/// Number of intervals of a law's curve.
const POINTS: u32 = 200;

/// Least margin on each side of a law's curve, m or m/s.
const LEAST: f64 = 1e-3;

pub(super) fn show(ui: &mut Ui, bench: &mut Bench) {
    ui.add_space(2.0);
    ui.horizontal(|ui| controls(ui, bench));
    if bench.record.span().is_none() {
        ui.label("Nothing is recorded yet: choose an element and let the game run.");
        return;
    }
    match bench.plots {
        Plots::Time => over_time(ui, bench),
        Plots::Law => laws(ui, bench),
    }
}

/// Shows the controls: which plots, which time, and exports.
fn controls(ui: &mut Ui, bench: &mut Bench) {
    ui.selectable_value(&mut bench.plots, Plots::Time, "Over time");
    ui.selectable_value(&mut bench.plots, Plots::Law, "Force laws");
    ui.separator();
    let Some([first, last]) = bench.record.span() else {
        return;
    };
    let mut back = bench.scrub.unwrap_or(last).clamp(first, last) - last;
    ui.label("Look at");
    ui.spacing_mut().slider_width = 240.0;
    let slider = Slider::new(&mut back, first - last..=0.0)
        .suffix(" s")
        .fixed_decimals(2);
    if ui.add_enabled(last > first, slider).changed() {
        bench.scrub = (back < 0.0).then_some(back + last);
    }
    if bench.scrub.is_some() && ui.button("Now").clicked() {
        bench.scrub = None;
    }
    ui.separator();
    let table = ui.button("Save CSV");
    let hover = format!("The last {SECONDS} s as a table");
    if table.on_hover_text(hover).clicked() {
        let table = bench.record.csv(is_torsion(bench));
        bench.asks.push(Ask::Csv(table));
    }
    if ui.button("Save picture").clicked() {
        bench.asks.push(Ask::Picture);
    }
}

/// Whether the chosen element has angles and moments.
fn is_torsion(bench: &Bench) -> bool {
    let subject = bench.subject.as_ref();
    subject.is_some_and(|subject| subject.now.part.is_torsion())
}

/// Shows several plots side by side, each below its title. A title is a list of words in the colours of their curves.
fn row(
    ui: &mut Ui,
    titles: &[Vec<(&str, Color32)>],
    mut plot: impl FnMut(&mut Ui, usize, Plot<'static>),
) {
    let spacing = ui.spacing().item_spacing.x;
    let gaps = spacing * (titles.len() - 1) as f32;
    let width = ((ui.available_width() - gaps) / titles.len() as f32).max(60.0);
    let size = Vec2::new(width, ui.available_height());
    ui.horizontal_top(|ui| {
        for (i, title) in titles.iter().enumerate() {
            ui.allocate_ui(size, |ui| {
                ui.vertical(|ui| {
                    ui.horizontal(|ui| {
                        for (text, color) in title {
                            ui.label(RichText::new(*text).color(*color));
                        }
                    });
                    let place = Plot::new(("coilover_plot", i, titles.len()))
                        .width(width)
                        .height(ui.available_height().max(60.0))
                        .allow_scroll(false)
                        .set_margin_fraction(Vec2::new(0.0, 0.08))
                        .y_axis_min_width(38.0);
                    plot(ui, i, place);
                });
            });
        }
    });
}

fn over_time(ui: &mut Ui, bench: &Bench) {
    let names = if is_torsion(bench) {
        ["angle, rad", "rate, rad/s", "moment, N m", "energy, J"]
    } else {
        ["length, m", "rate, m/s", "force, N", "energy, J"]
    };
    let groups: [&[(Quantity, Color32)]; 4] = [
        &[(Quantity::Length, SPRING)],
        &[(Quantity::Rate, DAMPER)],
        &[
            (Quantity::SpringForce, SPRING),
            (Quantity::DamperForce, DAMPER),
        ],
        &[(Quantity::Stored, SPRING), (Quantity::Dissipated, DAMPER)],
    ];
    let titles = [0, 1, 2, 3].map(|i: usize| match groups[i] {
        [(_, color)] => vec![(names[i], *color)],
        several => {
            let each = several.iter().map(|(q, color)| (q.name(), *color));
            std::iter::once((names[i], PLAIN)).chain(each).collect()
        }
    });
    let Some([first, last]) = bench.record.span() else {
        return;
    };
    row(ui, &titles, |ui, i, plot| {
        // Times are relative to the present, so that the axis labels do not move.
        let title = names[i].to_owned();
        let plot = plot
            .link_axis("coilover_time", Vec2b::new(true, false))
            .include_x(first - last)
            .include_x(0.0)
            .label_formatter(move |at| {
                let at = match at {
                    HoverPosition::NearDataPoint { position, .. }
                    | HoverPosition::Elsewhere { position } => position,
                };
                Some(format!("{} s\n{}: {}", brief(at.x), title, brief(at.y)))
            });
        plot.show(ui, |ui| {
            for (quantity, color) in groups[i] {
                let mut points = bench.record.curve(*quantity, 400);
                points.iter_mut().for_each(|point| point[0] -= last);
                let line = Line::new(quantity.name(), PlotPoints::from(points));
                ui.line(line.color(*color));
            }
            if let Some(time) = bench.scrub {
                ui.vline(VLine::new("", time - last).color(NOW));
            }
        });
    });
}

/// Returns the range of some values, widened by a margin.
fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let range = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    let [low, high] = range;
    let room = (0.25 * (high - low)).max(LEAST);
    (low <= high).then_some([low - room, high + room])
}

fn law_curve([low, high]: [f64; 2], force: impl Fn(f64) -> f64) -> PlotPoints<'static> {
    let step = (high - low) / f64::from(POINTS);
    (0..=POINTS)
        .map(|i| low + step * f64::from(i))
        .map(|x| [x, force(x)])
        .collect()
}

fn laws(ui: &mut Ui, bench: &Bench) {
    let Some(subject) = &bench.subject else {
        return;
    };
    let curve = subject.facts.curve.as_ref();
    let now = bench.sample();
    let at = now.as_ref().map_or(0.0, |now| Quantity::Length.of(now));
    let names = if subject.now.part.is_torsion() {
        [
            "moment of the spring, N m, over the angle, rad",
            "moment of the damper, N m, over its rate, rad/s",
        ]
    } else {
        [
            "force of the spring, N, over the length, m",
            "force of the damper, N, over the rate, m/s",
        ]
    };
    let axes = [
        (Quantity::Length, Quantity::SpringForce, SPRING),
        (Quantity::Rate, Quantity::DamperForce, DAMPER),
    ];
    let law = "law";
    let titles = [0, 1].map(|i: usize| vec![(names[i], axes[i].2), (law, LAW)]);
    row(ui, &titles, |ui, i, plot| {
        let (x, y, color) = axes[i];
        plot.show(ui, |ui| {
            if let (Some(curve), Some(range)) = (curve, range(bench.record.iter().map(|s| x.of(s))))
            {
                let line = law_curve(range, |value| match x {
                    Quantity::Rate => curve.damper(at, value),
                    _ => curve.spring(value),
                });
                ui.line(Line::new(law, line).color(LAW).width(2.5));
            }
            let each = bench.record.iter().count().div_ceil(MEASURED).max(1);
            let samples = bench.record.iter().step_by(each);
            let points: PlotPoints = samples.map(|s| [x.of(s), y.of(s)]).collect();
            ui.points(Points::new("measured", points).radius(1.8).color(color));
            if let Some(now) = &now {
                let here = vec![[x.of(now), y.of(now)]];
                ui.points(Points::new("now", here).radius(4.5).color(NOW));
            }
        });
    });
}
