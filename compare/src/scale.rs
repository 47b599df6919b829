//! Study of 10 to 100 000 isolated springs: time of an update and memory. Each measurement runs in its own process.

use crate::clock::{Times, turn_of};
use crate::machine::field;
use crate::method::{Method, Setting};
use crate::paint::{Drawn, Label, axes, colour, decades, font};
use crate::problem::{Body, Link, Problem, Truth};
use crate::rig::Rig;
use crate::study::{Study, number};
use crate::words::digits;
use bevy::math::Vec3;
use plotters::prelude::*;
use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Number of processes per method and number of springs.
const ROUNDS: u32 = 3;

/// Result of a method with a number of springs.
#[derive(Clone, Copy)]
pub struct Load {
    pub method: Method,
    pub springs: u32,
    /// Time of an update, s.
    pub times: Times,
    /// Peak memory of the process, bytes. `None` where the system does not report it.
    pub memory: Option<f64>,
}

fn counts(quick: bool) -> &'static [u32] {
    if quick {
        &[10, 100, 1_000]
    } else {
        &[10, 100, 1_000, 10_000, 100_000]
    }
}

/// The study of isolated springs, each between two bodies of its own.
pub struct Scale;

impl Study for Scale {
    type Item = Load;

    fn name(&self) -> &'static str {
        "scale"
    }

    fn wanted(&self, _: Method, quick: bool) -> usize {
        counts(quick).len()
    }

    /// Measures all methods in turns and keeps, for each method and number of springs, the process with the smallest mean.
    fn measure(&self, methods: &[Method], quick: bool) -> Result<Vec<Load>, Box<dyn Error>> {
        let mut loads: Vec<Load> = Vec::new();
        for springs in counts(quick) {
            for _ in 0..ROUNDS {
                for method in methods {
                    let load = ask(*method, *springs)?;
                    let same = |l: &&mut Load| l.method == *method && l.springs == *springs;
                    match loads.iter_mut().find(same) {
                        Some(old) if load.times.mean < old.times.mean => *old = load,
                        Some(_) => {}
                        None => loads.push(load),
                    }
                }
            }
        }
        Ok(loads)
    }

    fn method(item: &Load) -> Method {
        item.method
    }

    fn header(&self) -> String {
        "method,springs,update_us,quartile_1_us,quartile_3_us,peak_memory_mib".into()
    }

    fn line(l: &Load) -> String {
        let us = |s: f64| format!("{:.2}", 1e6 * s);
        let memory = l
            .memory
            .map_or(String::new(), |b| format!("{:.1}", b / MIB));
        let [mean, low, high] = [l.times.mean, l.times.low, l.times.high].map(us);
        format!(
            "{},{},{mean},{low},{high},{memory}",
            l.method.name(),
            l.springs
        )
    }

    fn parse(cells: &[&str]) -> Option<Load> {
        let [method, springs, mean, low, high, memory] = cells else {
            return None;
        };
        let us = |cell: &str| number(cell).map(|us| 1e-6 * us);
        Some(Load {
            method: Method::named(method)?,
            springs: springs.parse().ok()?,
            times: Times {
                mean: us(mean)?,
                low: us(low)?,
                high: us(high)?,
            },
            memory: number(memory).map(|m| m * MIB),
        })
    }

    fn draw(&self, path: &Path, loads: &[Load]) -> Drawn {
        draw(path, loads)
    }

    fn section(&self, loads: &[Load]) -> String {
        section(loads)
    }
}

/// Measures in this process and prints the result, which `ask` reads.
pub fn tell(method: Method, springs: u32) {
    let problem = pairs(springs);
    let mut rig = Rig::new(&problem, Setting::default_of(method, 60));
    (0..10).for_each(|_| rig.tick());
    let turns = (0..15).map(|_| {
        let batch = (2_000 / springs).max(1);
        turn_of(batch, || rig.tick())
    });
    let times = Times::of(turns.collect());
    let memory = field("/proc/self/status", "VmHWM", ':')
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok())
        .map_or("-".into(), |kib| (1024.0 * kib).to_string());
    println!("{} {} {} {memory}", times.mean, times.low, times.high);
}

/// Runs updates of a number of body pairs, some of which have a bevy_coilover spring. For counting instructions.
pub fn update([bodies, springs, updates]: [u32; 3]) {
    let mut problem = pairs(bodies);
    problem.links.truncate(springs as usize);
    let mut rig = Rig::new(&problem, Setting::default_of(Method::Ours, 60));
    (0..updates).for_each(|_| rig.tick());
}

/// Starts another process that measures, and reads its result.
fn ask(method: Method, springs: u32) -> Result<Load, Box<dyn Error>> {
    let output = Command::new(std::env::current_exe()?)
        .args(["--scale-of", method.name(), &springs.to_string()])
        .output()?;
    let text = String::from_utf8(output.stdout)?;
    let words: Vec<&str> = text.split_whitespace().collect();
    let [mean, low, high, memory] = words.as_slice() else {
        return Err(format!("{} springs of {} tell nothing", springs, method.name()).into());
    };
    Ok(Load {
        method,
        springs,
        times: Times {
            mean: mean.parse()?,
            low: low.parse()?,
            high: high.parse()?,
        },
        memory: memory.parse().ok(),
    })
}

/// Pairs of bodies, each joined by a spring and moving both along the spring and across it.
fn pairs(count: u32) -> Problem {
    let mut bodies = Vec::new();
    let mut links = Vec::new();
    for i in 0..count {
        let at = Vec3::new((i % 100) as f32, (i / 100) as f32, 0.0) * 4.0;
        let across = Vec3::new(0.0, 0.3, 0.1);
        links.push(Link::new(bodies.len(), bodies.len() + 1, 40.0, 0.1, 1.0));
        bodies.push(Body::point(1.0, at).moving(across));
        bodies.push(Body::point(1.0, at + Vec3::X * 1.2).moving(-across));
    }
    Problem {
        gravity: Vec3::ZERO,
        bodies,
        links,
        ground: false,
        seconds: 1.0,
        size: 1.0,
        energy: None,
        truth: Truth::unknown(),
    }
}

const MIB: f64 = 1024.0 * 1024.0;

/// Draws the time of an update over the number of springs.
fn draw(path: &Path, loads: &[Load]) -> Drawn {
    let sheet = SVGBackend::new(path, (700, 520)).into_drawing_area();
    sheet.fill(&WHITE)?;
    let xs = decades(loads.iter().map(|l| f64::from(l.springs)), false);
    let ys = decades(loads.iter().map(|l| 1e6 * l.times.mean), false);
    let mut chart = ChartBuilder::on(&sheet)
        .caption("Isolated springs between two bodies each", font(19))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(70)
        .build_cartesian_2d(xs.log_scale(), ys.log_scale())?;
    let labels: [&Label; 2] = [&|x| format!("{x:.0}"), &|y| format!("{y:.0}")];
    let titles = ["springs", "time of an update, µs"];
    axes(&mut chart, 14, titles, labels)?;
    for method in Method::ALL {
        let of: Vec<(f64, f64)> = loads
            .iter()
            .filter(|l| l.method == method)
            .map(|l| (f64::from(l.springs), 1e6 * l.times.mean))
            .collect();
        if of.is_empty() {
            continue;
        }
        let paint = colour(method);
        chart
            .draw_series(LineSeries::new(of, paint.stroke_width(2)).point_size(4))?
            .label(method.title())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], paint.stroke_width(3)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .label_font(font(14))
        .draw()?;
    sheet.present()?;
    Ok(())
}

fn section(loads: &[Load]) -> String {
    let mut text = String::from(
        "## From ten springs to a hundred thousand\n\nIsolated springs between two moving bodies each, without \
         shapes, at 60 steps a second, each method at its default; every cell is the fastest \
         of three processes of its own, in turns. Memory is the most that the process has had, bodies and engine \
         included.\n\n\
         ![Time over number of springs](speed_vs_error/scale.svg)\n\n\
         | method | springs | update | quartiles | per spring | peak memory |\n|---|---|---|---|---|---|\n",
    );
    for l in loads {
        let _ = writeln!(
            text,
            "| {} | {} | {} µs | {}–{} | {} µs | {} |",
            l.method.title(),
            l.springs,
            digits(1e6 * l.times.mean),
            digits(1e6 * l.times.low),
            digits(1e6 * l.times.high),
            digits(1e6 * l.times.mean / f64::from(l.springs)),
            l.memory
                .map_or("–".into(), |b| format!("{:.0} MiB", b / MIB)),
        );
    }
    text.push_str(&ratios(loads));
    text.push('\n');
    text
}

/// Ratios of bevy_coilover's time per update to that of the other methods, in words.
fn ratios(loads: &[Load]) -> String {
    let mut text = String::new();
    for other in [Method::Joint, Method::Force, Method::Avian] {
        let of = |method, springs| {
            let mut loads = loads.iter();
            loads.find(|l: &&Load| l.method == method && l.springs == springs)
        };
        let ratios: Vec<String> = counts(false)
            .iter()
            .filter_map(|n| Some((n, of(Method::Ours, *n)?, of(other, *n)?)))
            .map(|(n, ours, peer)| format!("{:.2} at {n}", ours.times.mean / peer.times.mean))
            .collect();
        if !ratios.is_empty() {
            let (title, ratios) = (other.title(), ratios.join(", "));
            let _ = writeln!(
                text,
                "\n- Time of our update, divided by that with {title}: {ratios}."
            );
        }
    }
    text
}
