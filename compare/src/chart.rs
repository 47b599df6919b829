//! The work–precision chart of a scene: error against computing time, both logarithmic.

use crate::front::front;
use crate::method::{Dial, Method};
use crate::paint::{Chart, Drawn, EXTRAPOLATED, INK, Label, Sheet, axes, colour, decades, font};
use crate::table::Row;
use plotters::prelude::*;
use std::path::Path;

/// Errors below this are rounding errors of single precision, m. The chart draws them at this value.
const FLOOR: f64 = 1e-7;

/// One line of the chart: the points of a method as one dial varies.
struct Curve {
    label: String,
    paint: RGBColor,
    dashed: bool,
    points: Vec<(f64, f64)>,
}

/// Draws all rows of a scene.
pub fn draw(path: &Path, title: &str, rows: &[Row]) -> Drawn {
    let sheet = SVGBackend::new(path, (980, 600)).into_drawing_area();
    sheet.fill(&WHITE)?;
    let (left, right) = sheet.split_horizontally(700);
    let kept = |r: &&Row| !r.strayed.diverged;
    let xs = decades(rows.iter().map(work), false);
    let mut ys = decades(rows.iter().filter(kept).map(error), true);
    let lost = rows.iter().any(|r| r.strayed.diverged);
    if lost {
        ys.end *= 10.0;
    }
    let mut chart = ChartBuilder::on(&left)
        .caption(title, font(20))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(xs.log_scale(), ys.clone().log_scale())?;
    let labels: [&Label; 2] = [&|x| format!("{x:.0}"), &|y| format!("{y:.0e}")];
    let titles = [
        "computing time per 1/60 s of the scene, µs",
        "largest position error, m",
    ];
    axes(&mut chart, 14, titles, labels)?;
    let best: Vec<_> = front(rows).iter().map(point).collect();
    chart.draw_series(LineSeries::new(best, INK.mix(0.25).stroke_width(7)))?;
    let curves = curves(rows);
    for curve in &curves {
        line(&mut chart, curve)?;
    }
    for row in rows {
        let paint = colour(row.setting.method);
        if row.strayed.diverged {
            let at = (work(row), ys.end / 2.0);
            chart.draw_series([Cross::new(at, 4, paint.stroke_width(2))])?;
        } else {
            chart.draw_series([Circle::new(point(row), 2, paint.mix(0.5).filled())])?;
        }
    }
    legend(&right, &curves, lost)?;
    sheet.present()?;
    Ok(())
}

fn work(row: &Row) -> f64 {
    1e6 * row.work() / 60.0
}

fn error(row: &Row) -> f64 {
    row.strayed.error.max(FLOOR)
}

fn point(row: &Row) -> (f64, f64) {
    (work(row), error(row))
}

/// Two kinds of curve per method: over its own dial at 60 steps per second, and over the time step at its default dial.
/// bevy_coilover also has a curve over the time step with extrapolation.
fn curves(rows: &[Row]) -> Vec<Curve> {
    let kept: Vec<&Row> = rows.iter().filter(|r| !r.strayed.diverged).collect();
    let mut curves = Vec::new();
    let mut add = |label: String, method, paint, dashed, keep: &dyn Fn(&Row) -> bool| {
        let mut rows: Vec<&&Row> = kept
            .iter()
            .filter(|r| r.setting.method == method && keep(r))
            .collect();
        rows.sort_by_key(|r| (r.setting.rate, r.setting.dial));
        let points: Vec<_> = rows.into_iter().map(|r| point(r)).collect();
        if points.len() > 1 {
            curves.push(Curve {
                label,
                paint,
                dashed,
                points,
            });
        }
    };
    for method in Method::ALL {
        let (name, paint) = (method.title(), colour(method));
        let own = |what: &str| format!("{name}: {what}");
        match method {
            Method::Ours => {
                add(own("micro-steps"), method, paint, false, &|r| {
                    r.setting.rate == 60 && matches!(r.setting.dial, Dial::Microsteps(_))
                });
                add(own("extrapolated, dt"), method, EXTRAPOLATED, true, &|r| {
                    r.setting.dial == Dial::Extrapolated(1)
                });
            }
            Method::Joint => add(own("iterations"), method, paint, false, &|r| {
                r.setting.rate == 60
            }),
            Method::Avian | Method::AvianBare => {
                add(own("substeps"), method, paint, false, &|r| {
                    r.setting.rate == 60
                });
            }
            Method::Force => {}
        }
        add(own("dt"), method, paint, true, &|r| r.setting.is_default());
    }
    curves
}

fn line(chart: &mut Chart, curve: &Curve) -> Drawn {
    let paint = curve.paint;
    let points = curve.points.iter().copied();
    if curve.dashed {
        chart.draw_series(DashedLineSeries::new(points, 6, 4, paint.stroke_width(2)))?;
        let marks = curve.points.iter();
        chart.draw_series(marks.map(|p| TriangleMarker::new(*p, 5, paint.filled())))?;
    } else {
        chart.draw_series(LineSeries::new(points, paint.stroke_width(2)))?;
        let marks = curve.points.iter();
        chart.draw_series(marks.map(|p| Circle::new(*p, 4, paint.filled())))?;
    }
    Ok(())
}

/// Explains the lines, to the right of the chart.
fn legend(area: &Sheet, curves: &[Curve], lost: bool) -> Drawn {
    let mut y = 50;
    let text = |y: i32, words: &str| -> Drawn {
        area.draw(&Text::new(words.to_owned(), (40, y - 6), font(13)))?;
        Ok(())
    };
    for curve in curves {
        let paint = curve.paint;
        for x in (0..32).step_by(if curve.dashed { 10 } else { 8 }) {
            let end = x + if curve.dashed { 6 } else { 8 };
            area.draw(&PathElement::new([(x, y), (end, y)], paint.stroke_width(2)))?;
        }
        if curve.dashed {
            area.draw(&TriangleMarker::new((16, y), 5, paint.filled()))?;
        } else {
            area.draw(&Circle::new((16, y), 4, paint.filled()))?;
        }
        text(y, &curve.label)?;
        y += 24;
    }
    area.draw(&PathElement::new(
        [(0, y), (32, y)],
        INK.mix(0.25).stroke_width(7),
    ))?;
    text(y, "Pareto front: nothing is better in both")?;
    y += 24;
    area.draw(&Circle::new((16, y), 2, INK.mix(0.5).filled()))?;
    text(y, "any other setting")?;
    if lost {
        y += 24;
        area.draw(&Cross::new((16, y), 4, INK.stroke_width(2)))?;
        text(y, "diverged")?;
    }
    y += 36;
    text(y, "solid: own dial at 60 steps a second")?;
    text(y + 20, "dashed: 30 to 960 steps a second")?;
    Ok(())
}
