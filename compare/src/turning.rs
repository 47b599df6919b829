//! Study of lone elements that swing and turn: fixed micro-steps against extrapolation, where their time counts.
//!
//! Along its line, a step of a lone element is exact. Its error is of fourth order in the turning of the line, or of second order
//! where it turns its bodies, as in the dumbbell. This study asks whether more micro-steps or extrapolation is the cheaper way
//! to less error. In a scene of one spring the frame costs so
//! much that both look alike. So a thousand copies of a scene are timed in one frame.

use crate::clock::{Times, race};
use crate::follow::follow;
use crate::method::{Dial, Method, Setting};
use crate::paint::{Drawn, EXTRAPOLATED, Label, axes, colour, decades, font};
use crate::problem::{Problem, Truth};
use crate::scenes::{Scene, dumbbell, pendulum};
use crate::study::{Study, number};
use crate::words::digits;
use plotters::prelude::*;
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

const SCENES: [Scene; 4] = [
    pendulum::SOFT,
    pendulum::DAMPED,
    pendulum::STIFF,
    dumbbell::SCENE,
];

/// Number of copies of a scene that are timed together.
const COPIES: usize = 1_000;
/// Number of timed turns of each setting.
const TURNS: u32 = 15;
/// Steps per second.
const RATES: [u32; 4] = [30, 60, 120, 240];
const FIXED: [u32; 6] = [1, 2, 4, 8, 16, 32];
const EXTRAPOLATED_FROM: [u32; 4] = [1, 2, 4, 8];
/// Errors for which the table names the cheapest setting, m.
const LEVELS: [f64; 8] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6];

/// Error and time of a setting in a scene.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Index of the scene in [`SCENES`].
    scene: usize,
    setting: Setting,
    /// Largest position error of one copy, m.
    error: f64,
    /// Time of a step of all copies, s.
    times: Times,
}

/// The study of elements that turn.
pub struct Turning;

impl Run {
    /// Time of one copy per 1/60 s of the scene, s.
    fn work(&self) -> f64 {
        self.times.mean * f64::from(self.setting.rate) / 60.0 / COPIES as f64
    }

    fn is_extrapolated(&self) -> bool {
        matches!(self.setting.dial, Dial::Extrapolated(_))
    }
}

fn dials() -> impl Iterator<Item = Dial> {
    let fixed = FIXED.into_iter().map(Dial::Microsteps);
    fixed.chain(EXTRAPOLATED_FROM.into_iter().map(Dial::Extrapolated))
}

fn settings(rate: u32) -> Vec<Setting> {
    let of = |dial| Setting {
        method: Method::Ours,
        dial,
        rate,
    };
    dials().map(of).collect()
}

/// Many copies of a problem in one world, at the same place. Nothing has a shape, so they do not meet.
fn copies(problem: &Problem) -> Problem {
    let (mut bodies, mut links) = (Vec::new(), Vec::new());
    for _ in 0..COPIES {
        let first = bodies.len();
        bodies.extend(problem.bodies.iter().copied());
        links.extend(problem.links.iter().copied().map(|mut link| {
            link.ends = link.ends.map(|end| first + end);
            link
        }));
    }
    Problem {
        gravity: problem.gravity,
        bodies,
        links,
        ground: false,
        seconds: problem.seconds,
        size: problem.size,
        energy: None,
        truth: Truth::unknown(),
    }
}

impl Study for Turning {
    type Item = Run;

    fn name(&self) -> &'static str {
        "turning"
    }

    fn wanted(&self, method: Method, quick: bool) -> usize {
        match method {
            Method::Ours if !quick => SCENES.len() * RATES.len() * dials().count(),
            _ => 0,
        }
    }

    fn measure(&self, methods: &[Method], quick: bool) -> Result<Vec<Run>, Box<dyn Error>> {
        let mut runs = Vec::new();
        if quick || !methods.contains(&Method::Ours) {
            return Ok(runs);
        }
        for (scene, Scene { make, .. }) in SCENES.iter().enumerate() {
            let problem = make();
            let many = copies(&problem);
            for rate in RATES {
                let settings = settings(rate);
                let times = race(&many, &settings, TURNS);
                runs.extend(settings.into_iter().zip(times).map(|(setting, times)| Run {
                    scene,
                    setting,
                    error: follow(&problem, setting).error,
                    times,
                }));
            }
        }
        Ok(runs)
    }

    fn method(item: &Run) -> Method {
        item.setting.method
    }

    fn header(&self) -> String {
        "scene,setting,steps_per_second,largest_error_m,step_us,step_us_quartile_1,step_us_quartile_3"
            .into()
    }

    fn line(run: &Run) -> String {
        let [mean, low, high] =
            [run.times.mean, run.times.low, run.times.high].map(|s| format!("{:.1}", 1e6 * s));
        format!(
            "{},{},{},{:.3e},{mean},{low},{high}",
            SCENES[run.scene].name, run.setting.dial, run.setting.rate, run.error
        )
    }

    fn parse(cells: &[&str]) -> Option<Run> {
        let [scene, dial, rate, error, mean, low, high] = cells else {
            return None;
        };
        let us = |cell: &str| number(cell).map(|us| 1e-6 * us);
        Some(Run {
            scene: SCENES.iter().position(|known| known.name == *scene)?,
            setting: Setting {
                method: Method::Ours,
                dial: dials().find(|known| known.to_string() == *dial)?,
                rate: rate.parse().ok()?,
            },
            error: number(error)?,
            times: Times {
                mean: us(mean)?,
                low: us(low)?,
                high: us(high)?,
            },
        })
    }

    fn draw(&self, path: &Path, runs: &[Run]) -> Drawn {
        let sheet = SVGBackend::new(path, (980, 760)).into_drawing_area();
        sheet.fill(&WHITE)?;
        let xs = decades(runs.iter().map(|run| 1e6 * run.work()), false);
        let ys = decades(runs.iter().map(|run| run.error), true);
        for (scene, area) in sheet.split_evenly((2, 2)).iter().enumerate() {
            let mut chart = ChartBuilder::on(area)
                .caption(SCENES[scene].title, font(17))
                .margin(10)
                .x_label_area_size(40)
                .y_label_area_size(60)
                .build_cartesian_2d(xs.clone().log_scale(), ys.clone().log_scale())?;
            let labels: [&Label; 2] = [&|x| format!("{x}"), &|y| format!("{y:.0e}")];
            let titles = [
                "time of one element per 1/60 s, µs",
                "largest position error, m",
            ];
            axes(&mut chart, 13, titles, labels)?;
            for (title, paint, wanted) in [
                ("fixed micro-steps", colour(Method::Ours), false),
                ("extrapolated", EXTRAPOLATED, true),
            ] {
                let of = runs
                    .iter()
                    .filter(|run| run.scene == scene && run.is_extrapolated() == wanted);
                let points = of.map(|run| (1e6 * run.work(), run.error));
                let marks = points.map(|at| Circle::new(at, 4, paint.mix(0.7).filled()));
                chart
                    .draw_series(marks)?
                    .label(title)
                    .legend(move |at| Circle::new(at, 4, paint.filled()));
            }
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .label_font(font(13))
                .draw()?;
        }
        sheet.present()?;
        Ok(())
    }

    fn section(&self, runs: &[Run]) -> String {
        let mut text = format!(
            "## Lone elements that turn: micro-steps or extrapolation\n\n\
             Along its line a step of a lone element is exact. Its error is of fourth order in the turning of the line between \
             the centres of two bodies, and of second order where it turns its bodies, as in the dumbbell. Is it cheaper to \
             take more micro-steps, or to extrapolate? In a scene of one spring the frame costs so much that both look \
             alike. Here {COPIES} copies of each scene are timed in one frame, which is whole and divided by {COPIES}; \
             errors are those of one copy.\n\n\
             ![Error against time of one element](speed_vs_error/turning.svg)\n\n\
             For each error, the cheapest setting at 30 to 240 steps a second, in µs per 1/60 s of the scene:\n\n\
             | scene | within | fixed micro-steps | extrapolated | extrapolated : fixed |\n|---|---|---|---|---|\n"
        );
        for (scene, Scene { title, .. }) in SCENES.iter().enumerate() {
            for level in LEVELS {
                let pair = [false, true].map(|wanted| cheapest(runs, scene, level, wanted));
                if pair.iter().all(Option::is_none) {
                    continue;
                }
                let [fixed, extrapolated] = pair.map(|run| run.map_or("–".into(), describe));
                let ratio = match pair {
                    [Some(fixed), Some(extrapolated)] => {
                        format!("{:.2}", extrapolated.work() / fixed.work())
                    }
                    _ => "–".into(),
                };
                let _ = writeln!(
                    text,
                    "| {title} | {} mm | {fixed} | {extrapolated} | {ratio} |",
                    digits(1e3 * level)
                );
            }
        }
        text.push('\n');
        text
    }
}

/// The cheapest setting within an error, of those with fixed micro-steps or of those with extrapolation.
fn cheapest(runs: &[Run], scene: usize, level: f64, extrapolated: bool) -> Option<Run> {
    let of = runs.iter().filter(|run| {
        run.scene == scene && run.error <= level && run.is_extrapolated() == extrapolated
    });
    of.min_by(|a, b| a.work().total_cmp(&b.work())).copied()
}

fn describe(run: Run) -> String {
    format!(
        "{} ({}, {} Hz)",
        digits(1e6 * run.work()),
        run.setting.dial,
        run.setting.rate
    )
}
