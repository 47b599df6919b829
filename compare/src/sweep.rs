//! Study of the single oscillator over ω·dt: error, frequency and damping ratio of each method's default.

use crate::follow::follow;
use crate::method::{Method, Setting};
use crate::paint::{Drawn, Label, axes, colour, decades, font};
use crate::rig::Rig;
use crate::scenes::oscillator::{AMPLITUDE, oscillator};
use crate::study::{Study, number};
use crate::words::digits;
use plotters::prelude::*;
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

/// Steps per second of the sweep.
const RATE: u32 = 60;
const ZETAS: [f64; 3] = [0.0, 0.1, 1.0];

/// Result of one method for one oscillator.
pub struct Point {
    pub method: Method,
    pub zeta: f64,
    /// Phase ω·dt of one step, rad.
    pub phase: f64,
    /// Largest error divided by the initial stretch. `None` if the method diverged.
    pub error: Option<f64>,
    /// Relative error of the natural frequency, or `None` where it is not resolved.
    pub frequency: Option<f64>,
    /// Error of the damping ratio, or `None` where it is not resolved.
    pub damping: Option<f64>,
}

/// The study of all methods at all ω·dt and ζ.
pub struct Sweep;

impl Study for Sweep {
    type Item = Point;

    fn name(&self) -> &'static str {
        "sweep"
    }

    fn wanted(&self, _: Method, quick: bool) -> usize {
        ZETAS.len() * steps(quick)
    }

    fn measure(&self, methods: &[Method], quick: bool) -> Result<Vec<Point>, Box<dyn Error>> {
        let mut points = Vec::new();
        let last = steps(quick) - 1;
        for (method, zeta) in methods.iter().flat_map(|m| ZETAS.map(|zeta| (*m, zeta))) {
            for i in 0..=last {
                // From 0.01 to 10.
                let phase = 10.0_f64.powf(3.0 * i as f64 / last as f64 - 2.0);
                points.push(point(method, zeta, phase));
            }
        }
        Ok(points)
    }

    fn method(item: &Point) -> Method {
        item.method
    }

    fn header(&self) -> String {
        "method,zeta,omega_dt,error_of_amplitude,frequency_error,damping_ratio_error".into()
    }

    fn line(p: &Point) -> String {
        let cell = |x: Option<f64>| x.map(|x| format!("{x:.3e}")).unwrap_or_default();
        let error = p.error.map_or("diverged".into(), |e| format!("{e:.3e}"));
        let (frequency, damping) = (cell(p.frequency), cell(p.damping));
        let (name, zeta, phase) = (p.method.name(), p.zeta, p.phase);
        format!("{name},{zeta},{phase:.4},{error},{frequency},{damping}")
    }

    fn parse(cells: &[&str]) -> Option<Point> {
        let [method, zeta, phase, error, frequency, damping] = cells else {
            return None;
        };
        Some(Point {
            method: Method::named(method)?,
            zeta: number(zeta)?,
            phase: number(phase)?,
            error: number(error),
            frequency: number(frequency),
            damping: number(damping),
        })
    }

    fn draw(&self, path: &Path, points: &[Point]) -> Drawn {
        draw(path, points)
    }

    fn section(&self, points: &[Point]) -> String {
        section(points)
    }
}

fn steps(quick: bool) -> usize {
    if quick { 4 } else { 16 }
}

fn point(method: Method, zeta: f64, phase: f64) -> Point {
    let setting = Setting::default_of(method, RATE);
    let omega = phase / setting.dt();
    let problem = oscillator(omega, zeta, 5.0);
    let strayed = follow(&problem, setting);
    let mut point = Point {
        method,
        zeta,
        phase,
        error: (!strayed.diverged).then_some(strayed.error / AMPLITUDE),
        frequency: None,
        damping: None,
    };
    if zeta < 1.0 && phase < 3.0 && !strayed.diverged {
        let mut rig = Rig::new(&problem, setting);
        // About one radian between samples: the fit loses accuracy if neighbouring samples are almost equal.
        let stride = (1.0 / phase).round().max(1.0);
        let samples: Vec<f64> = (0..300)
            .map(|_| {
                rig.tick();
                rig.state(1).position.x - 1.0
            })
            .step_by(stride as usize)
            .collect();
        if let Some((wave, decay)) = poles(&samples) {
            let span = stride * setting.dt();
            let (natural, lost) = ((wave.hypot(decay)) / span, decay / span);
            point.frequency = Some(natural / omega - 1.0);
            point.damping = Some(lost / natural - zeta);
        }
    }
    point
}

/// Phase and decay per sample, from the least-squares fit of the recurrence x₊ = T x − D x₋.
fn poles(samples: &[f64]) -> Option<(f64, f64)> {
    let (mut aa, mut ab, mut bb, mut ay, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for w in samples.windows(3) {
        let (b, a, y) = (w[0], w[1], w[2]);
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ay += a * y;
        by += b * y;
    }
    let det = aa * bb - ab * ab;
    let trace = (ay * bb - by * ab) / det;
    let product = -(by * aa - ay * ab) / det;
    let decay = -0.5 * product.ln();
    let cosine = trace / (2.0 * product.sqrt());
    (samples.len() > 4 && cosine.abs() < 1.0 && decay.is_finite()).then(|| (cosine.acos(), decay))
}

/// Draws the error over ω·dt, one panel per damping ratio.
fn draw(path: &Path, points: &[Point]) -> Drawn {
    let sheet = SVGBackend::new(path, (1160, 460)).into_drawing_area();
    sheet.fill(&WHITE)?;
    let panels = sheet.split_evenly((1, ZETAS.len()));
    let errors = points.iter().filter_map(|p| p.error).map(|e| e.max(1e-7));
    let mut range = decades(errors, true);
    range.end *= 10.0;
    for (panel, zeta) in panels.iter().zip(ZETAS) {
        let mut chart = ChartBuilder::on(panel)
            .caption(format!("ζ = {zeta}"), font(18))
            .margin(8)
            .x_label_area_size(44)
            .y_label_area_size(60)
            .build_cartesian_2d((0.008..12.0).log_scale(), range.clone().log_scale())?;
        let labels: [&Label; 2] = [&|x| format!("{x}"), &|y| format!("{y:.0e}")];
        let titles = [
            "ω·dt, radians per step",
            "largest error in 5 s, of the first stretch",
        ];
        axes(&mut chart, 13, titles, labels)?;
        for method in Method::ALL {
            let of = |p: &&Point| p.method == method && p.zeta == zeta;
            if !points.iter().any(|p| of(&p)) {
                continue;
            }
            let paint = colour(method);
            let kept: Vec<(f64, f64)> = points
                .iter()
                .filter(of)
                .filter_map(|p| Some((p.phase, p.error?.max(1e-7))))
                .collect();
            let lost = points.iter().filter(of).filter(|p| p.error.is_none());
            let lost =
                lost.map(|p| Cross::new((p.phase, range.end / 2.0), 4, paint.stroke_width(2)));
            chart
                .draw_series(LineSeries::new(kept, paint.stroke_width(2)).point_size(3))?
                .label(method.title())
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], paint.stroke_width(3))
                });
            chart.draw_series(lost)?;
        }
        if zeta == ZETAS[0] {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperLeft)
                .background_style(WHITE.mix(0.85))
                .label_font(font(13))
                .draw()?;
        }
    }
    sheet.present()?;
    Ok(())
}

/// Chart, table and verdict.
fn section(points: &[Point]) -> String {
    let mut text = String::from(
        "## One oscillator at every ω·dt\n\nThe single oscillator, released stretched and moving, 5 s at 60 steps a \
         second, each method at its default; crosses have diverged. Frequency and damping ratio are those of the \
         two-pole recurrence that fits the samples best.\n\n\
         ![Error over ω·dt](speed_vs_error/sweep.svg)\n\n\
         | method | ζ | ω·dt | error / first stretch | frequency | damping ratio |\n|---|---|---|---|---|---|\n",
    );
    let percent = |x: Option<f64>| x.map_or("–".into(), |x| format!("{:+.1e}", x));
    for p in points {
        // Every fifth value is enough for the table.
        let near = [0.01, 0.1, 1.0, 10.0]
            .iter()
            .any(|x| (p.phase / x - 1.0).abs() < 1e-3);
        if near {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {} |",
                p.method.title(),
                p.zeta,
                digits(p.phase),
                p.error.map_or("diverges".into(), |e| format!("{e:.1e}")),
                percent(p.frequency),
                percent(p.damping)
            );
        }
    }
    text.push('\n');
    text.push_str(&verdict(points));
    text
}

/// Counts for each ζ at how many ω·dt bevy_coilover has the smallest error, and lists the others. What diverges is
/// not compared, and is named.
fn verdict(points: &[Point]) -> String {
    let mut text = String::new();
    for zeta in ZETAS {
        let of = |method: Method| {
            points
                .iter()
                .filter(move |p| p.zeta == zeta && p.method == method)
        };
        let (mut sum, mut lost) = (0, Vec::new());
        for our in of(Method::Ours) {
            let mut peers = points
                .iter()
                .filter(|p| p.zeta == zeta && p.method != Method::Ours && p.phase == our.phase)
                .filter_map(|p| p.error)
                .peekable();
            if peers.peek().is_none() {
                continue;
            }
            sum += 1;
            if our.error.is_none_or(|our| peers.any(|peer| peer <= our)) {
                lost.push(digits(our.phase));
            }
        }
        let won = sum - lost.len();
        let _ = write!(
            text,
            "- ζ = {zeta}: our error is below every other's that does not diverge at {won} of {sum} ω·dt"
        );
        if !lost.is_empty() {
            let _ = write!(text, "; it is not at {}", lost.join(", "));
        }
        text.push('.');
        for method in Method::ALL {
            let phases: Vec<String> = of(method)
                .filter(|p| p.error.is_none())
                .map(|p| digits(p.phase))
                .collect();
            if !phases.is_empty() {
                let (title, phases) = (method.title(), phases.join(", "));
                let _ = write!(text, " At {phases}, {title} diverges.");
            }
        }
        text.push('\n');
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::{Point, poles, verdict};
    use crate::method::Method;

    fn point(method: Method, phase: f64, error: Option<f64>) -> Point {
        Point {
            method,
            zeta: 0.0,
            phase,
            error,
            frequency: None,
            damping: None,
        }
    }

    #[test]
    fn what_diverges_is_named_and_not_beaten() {
        let told = verdict(&[
            point(Method::Ours, 0.1, Some(1e-3)),
            point(Method::Ours, 1.0, Some(1e-3)),
            point(Method::Ours, 10.0, None),
            point(Method::Force, 0.1, Some(1e-2)),
            point(Method::Force, 1.0, None),
            point(Method::Joint, 10.0, Some(1.0)),
        ]);
        let wanted = "- ζ = 0: our error is below every other's that does not diverge at 1 of 2 ω·dt; it is not at 10. \
                      At 10, bevy_coilover diverges. At 1.0, force once per step diverges.\n";
        assert!(told.starts_with(wanted), "{told}");
    }

    #[test]
    fn poles_of_a_fading_wave() {
        let samples: Vec<f64> = (0..50)
            .map(|i| (-0.02 * f64::from(i)).exp() * (0.7 * f64::from(i)).cos())
            .collect();
        let (wave, decay) = poles(&samples).expect("there are poles");
        assert!((wave - 0.7).abs() < 1e-9 && (decay - 0.02).abs() < 1e-9);
    }
}
