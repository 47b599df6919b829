//! Curves over time, and forces over length and rate with the law behind them.

use super::field::brief;
use crate::workbench::bench::{Ask, Bench, Plots};
use crate::workbench::model::record::{Quantity, SECONDS, Sample};
use bevy_egui::egui::{Color32, Slider, Ui, Vec2, Vec2b};
use egui_plot::{Corner, HoverPosition, Legend, Line, Plot, PlotPoint, PlotPoints, Points, VLine};

const SPRING: Color32 = Color32::from_rgb(90, 170, 255);
const DAMPER: Color32 = Color32::from_rgb(255, 150, 60);
const LAW: Color32 = Color32::from_gray(150);
const NOW: Color32 = Color32::from_rgb(240, 230, 90);

/// Points of a law's curve.
const POINTS: u32 = 200;

/// Least width of a law's curve, m or m/s.
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

/// Which plots, which time, and what is done with them.
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
        bench.asks.push(Ask::Csv(bench.record.csv()));
    }
    if ui.button("Save picture").clicked() {
        bench.asks.push(Ask::Picture);
    }
}

/// A place for one of several plots beside each other.
fn plot<'a>(ui: &Ui, name: &str, count: usize) -> Plot<'a> {
    let spacing = ui.spacing().item_spacing.x;
    let width = (ui.available_width() - spacing * (count - 1) as f32) / count as f32;
    Plot::new(name.to_owned())
        .width(width.max(60.0))
        .height(ui.available_height().max(60.0))
        .allow_scroll(false)
        .set_margin_fraction(Vec2::new(0.0, 0.08))
        .y_axis_min_width(38.0)
}

fn over_time(ui: &mut Ui, bench: &Bench) {
    let torsion = bench
        .subject
        .as_ref()
        .is_some_and(|subject| subject.now.part.is_torsion());
    let units = if torsion {
        ["angle, rad", "rate, rad/s", "moment, N m", "energy, J"]
    } else {
        ["length, m", "rate, m/s", "force, N", "energy, J"]
    };
    let groups: [(&str, &[(Quantity, Color32)]); 4] = [
        (units[0], &[(Quantity::Length, SPRING)]),
        (units[1], &[(Quantity::Rate, DAMPER)]),
        (
            units[2],
            &[
                (Quantity::SpringForce, SPRING),
                (Quantity::DamperForce, DAMPER),
            ],
        ),
        (
            units[3],
            &[(Quantity::Stored, SPRING), (Quantity::Dissipated, DAMPER)],
        ),
    ];
    let Some([first, last]) = bench.record.span() else {
        return;
    };
    let widths = plot_width(ui, groups.len());
    ui.horizontal(|ui| {
        for (name, quantities) in groups {
            // Times are counted from the present, so that their labels do not run.
            let title = name.to_owned();
            let mut plot = plot(ui, name, 1)
                .width(widths)
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
            plot = plot.legend(legend());
            plot.show(ui, |ui| {
                for (quantity, color) in quantities {
                    let mut points = bench.record.curve(*quantity, 400);
                    points.iter_mut().for_each(|point| point[0] -= last);
                    let label = if quantities.len() == 1 {
                        name
                    } else {
                        quantity.name()
                    };
                    ui.line(Line::new(label, PlotPoints::from(points)).color(*color));
                }
                if let Some(time) = bench.scrub {
                    ui.vline(VLine::new("", time - last).color(NOW));
                }
            });
        }
    });
}

fn legend() -> Legend {
    Legend::default()
        .position(Corner::LeftTop)
        .background_alpha(0.5)
}

fn plot_width(ui: &Ui, count: usize) -> f32 {
    let spacing = ui.spacing().item_spacing.x;
    (ui.available_width() - spacing * (count - 1) as f32) / count as f32
}

/// Where points lie, with some room about them.
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
    let torsion = subject.now.part.is_torsion();
    let curve = subject.facts.curve.as_ref();
    let now = bench.sample();
    let length = |sample: &Sample| Quantity::Length.of(sample);
    let rate = |sample: &Sample| Quantity::Rate.of(sample);
    let at = now.as_ref().map_or(0.0, length);
    let width = plot_width(ui, 2);
    let names = if torsion {
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
    ui.horizontal(|ui| {
        let force = |sample: &Sample| Quantity::SpringForce.of(sample);
        let measured = |x: &dyn Fn(&Sample) -> f64, y: &dyn Fn(&Sample) -> f64| -> Vec<PlotPoint> {
            let each = bench.record.iter().count().div_ceil(600).max(1);
            let samples = bench.record.iter().step_by(each);
            samples.map(|s| PlotPoint::new(x(s), y(s))).collect()
        };
        let series = |points: Vec<PlotPoint>| PlotPoints::Owned(points);
        plot(ui, names[0], 1)
            .width(width)
            .legend(legend())
            .show(ui, |ui| {
                if let (Some(curve), Some(range)) = (curve, range(bench.record.iter().map(length)))
                {
                    let line = law_curve(range, |x| curve.spring(x));
                    ui.line(Line::new("law", line).color(LAW).width(2.5));
                }
                let points = series(measured(&length, &force));
                ui.points(Points::new(names[0], points).radius(1.8).color(SPRING));
                if let Some(now) = &now {
                    let here = vec![[length(now), force(now)]];
                    ui.points(Points::new("now", here).radius(4.5).color(NOW));
                }
            });
        let force = |sample: &Sample| Quantity::DamperForce.of(sample);
        plot(ui, names[1], 1)
            .width(width)
            .legend(legend())
            .show(ui, |ui| {
                if let (Some(curve), Some(range)) = (curve, range(bench.record.iter().map(rate))) {
                    let line = law_curve(range, |x| curve.damper(at, x));
                    ui.line(Line::new("law", line).color(LAW).width(2.5));
                }
                let points = series(measured(&rate, &force));
                ui.points(Points::new(names[1], points).radius(1.8).color(DAMPER));
                if let Some(now) = &now {
                    let here = vec![[rate(now), force(now)]];
                    ui.points(Points::new("now", here).radius(4.5).color(NOW));
                }
            });
    });
}
