//! Study of where each method is stable: largest error in 3 s, over ω·dt and damping, and over ω·dt and mass ratio.

use crate::follow::follow;
use crate::method::{Method, Setting};
use crate::paint::{Drawn, INK, font};
use crate::problem::{Body, Link, Problem, Truth};
use crate::scenes::oscillator::{AMPLITUDE, oscillator};
use crate::study::{Study, number};
use bevy::math::{DVec3, Vec3};
use plotters::prelude::*;
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

const RATE: u32 = 60;
const SECONDS: f64 = 3.0;

/// The quantity that is varied besides ω·dt.
#[derive(Clone, Copy, PartialEq)]
pub enum Map {
    Damping,
    MassRatio,
}

/// One cell of a map.
pub struct Field {
    pub method: Method,
    pub phase: f64,
    /// Damping ratio ζ or mass ratio.
    pub other: f64,
    /// Largest error divided by the initial stretch. Infinite if the method diverged.
    pub error: f64,
}

impl Map {
    pub const ALL: [Self; 2] = [Self::Damping, Self::MassRatio];

    fn rows(self) -> &'static [f64] {
        match self {
            Self::Damping => &[0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0],
            Self::MassRatio => &[1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0],
        }
    }

    fn axis(self) -> &'static str {
        match self {
            Self::Damping => "ζ",
            Self::MassRatio => "mass ratio",
        }
    }

    fn problem(self, omega: f64, other: f64) -> Problem {
        match self {
            Self::Damping => oscillator(omega, other, SECONDS),
            Self::MassRatio => two(omega, other),
        }
    }
}

impl Map {
    fn field(self, method: Method, phase: f64, other: f64) -> Field {
        let setting = Setting::default_of(method, RATE);
        let strayed = follow(&self.problem(phase / setting.dt(), other), setting);
        Field {
            method,
            phase,
            other,
            error: if strayed.diverged {
                f64::INFINITY
            } else {
                strayed.error / AMPLITUDE
            },
        }
    }
}

impl Study for Map {
    type Item = Field;

    fn name(&self) -> &'static str {
        match self {
            Self::Damping => "stability-damping",
            Self::MassRatio => "stability-mass-ratio",
        }
    }

    fn wanted(&self, _: Method, quick: bool) -> usize {
        self.rows().len() * columns(quick).len()
    }

    fn measure(&self, methods: &[Method], quick: bool) -> Result<Vec<Field>, Box<dyn Error>> {
        let mut fields = Vec::new();
        for method in methods {
            for other in self.rows() {
                for phase in columns(quick) {
                    fields.push(self.field(*method, phase, *other));
                }
            }
        }
        Ok(fields)
    }

    fn method(item: &Field) -> Method {
        item.method
    }

    fn header(&self) -> String {
        format!("method,omega_dt,{},error_of_amplitude", self.axis())
    }

    fn line(f: &Field) -> String {
        let (name, phase, other, error) = (f.method.name(), f.phase, f.other, f.error);
        format!("{name},{phase:.4},{other},{error:.3e}")
    }

    fn parse(cells: &[&str]) -> Option<Field> {
        let [method, phase, other, error] = cells else {
            return None;
        };
        Some(Field {
            method: Method::named(method)?,
            phase: number(phase)?,
            other: number(other)?,
            error: number(error)?,
        })
    }

    /// Draws a panel per method, coloured by error.
    fn draw(&self, path: &Path, fields: &[Field]) -> Drawn {
        let sheet = SVGBackend::new(path, (1080, 660)).into_drawing_area();
        sheet.fill(&WHITE)?;
        let (maps, key) = sheet.split_horizontally(920);
        let mut methods: Vec<Method> = fields.iter().map(|f| f.method).collect();
        methods.dedup();
        let mut phases: Vec<f64> = fields.iter().map(|f| f.phase).collect();
        phases.sort_by(f64::total_cmp);
        phases.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let rows = self.rows();
        for (panel, method) in maps.split_evenly((2, 2)).iter().zip(methods) {
            let mut chart = ChartBuilder::on(panel)
                .caption(method.title(), font(17))
                .margin(8)
                .x_label_area_size(40)
                .y_label_area_size(62)
                .build_cartesian_2d(
                    (0..phases.len() - 1).into_segmented(),
                    (0..rows.len() - 1).into_segmented(),
                )?;
            let label = |list: &[f64], at: &SegmentValue<usize>, every: usize| match at {
                SegmentValue::CenterOf(i) if i % every == 0 => {
                    list.get(*i).map_or(String::new(), |x| short(*x))
                }
                _ => String::new(),
            };
            let every = if phases.len() > 8 { 3 } else { 1 };
            chart
                .configure_mesh()
                .disable_mesh()
                .axis_style(INK)
                .label_style(font(12))
                .x_desc("ω·dt, radians per step")
                .y_desc(self.axis())
                .x_labels(phases.len())
                .y_labels(rows.len())
                .x_label_formatter(&|i| label(&phases, i, every))
                .y_label_formatter(&|i| label(rows, i, 1))
                .draw()?;
            for f in fields.iter().filter(|f| f.method == method) {
                let place = |list: &[f64], x: f64| list.iter().position(|y| *y == x);
                if let (Some(x), Some(y)) = (place(&phases, f.phase), place(rows, f.other)) {
                    let paint = shade(f.error).filled();
                    let at = |x, y| (SegmentValue::Exact(x), SegmentValue::Exact(y));
                    let corners = [at(x, y), at(x + 1, y + 1)];
                    chart.draw_series([Rectangle::new(corners, paint)])?;
                }
            }
        }
        for (i, (limit, words)) in KEY.iter().enumerate() {
            let y = 60 + 34 * i as i32;
            let paint = shade(limit / 2.0).filled();
            key.draw(&Rectangle::new([(6, y), (30, y + 24)], paint))?;
            key.draw(&Text::new(*words, (38, y + 5), font(13)))?;
        }
        key.draw(&Text::new("error, of the first stretch", (6, 36), font(12)))?;
        sheet.present()?;
        Ok(())
    }

    fn section(&self, fields: &[Field]) -> String {
        let (title, note) = match self {
            Self::Damping => (
                "Stability over ω·dt and damping",
                "The single oscillator, released stretched and moving, 3 s at 60 steps a second.",
            ),
            Self::MassRatio => (
                "Stability over ω·dt and mass ratio",
                "A body of 1 kg on a wall, and a heavier one behind it, both on springs of the same stiffness, along \
                 one line, undamped; ω is that of the heavy body on one of them, 3 s at 60 steps a second.",
            ),
        };
        let mut text = format!(
            "## {title}\n\n{note} Colours show the largest error as a multiple of the first stretch. A wrong phase \
             alone can give 2; more means that energy was gained.\n\n![{title}](speed_vs_error/{}.svg)\n\n",
            self.name()
        );
        let mut methods: Vec<Method> = fields.iter().map(|f| f.method).collect();
        methods.dedup();
        for method in methods {
            let of: Vec<&Field> = fields.iter().filter(|f| f.method == method).collect();
            let count = |keep: &dyn Fn(f64) -> bool| of.iter().filter(|f| keep(f.error)).count();
            let _ = writeln!(
                text,
                "- {}: of {} fields, {} are within 1 %, {} within 10 %, {} have gained energy or diverged.",
                method.title(),
                of.len(),
                count(&|e| e < 0.01),
                count(&|e| e < 0.1),
                count(&|e| e > 3.0 || e.is_nan()),
            );
        }
        text.push('\n');
        text
    }
}

fn columns(quick: bool) -> Vec<f64> {
    let steps = if quick { 4 } else { 16 };
    // From 0.03 to 30.
    (0..steps)
        .map(|i| 0.03 * 10.0_f64.powf(3.0 * f64::from(i) / f64::from(steps - 1)))
        // Rounded as in the CSV file.
        .map(|phase| (1e4 * phase).round() / 1e4)
        .collect()
}

/// Upper error limit and label of each colour.
const KEY: [(f64, &str); 7] = [
    (1e-5, "below 1e-5"),
    (1e-4, "1e-4"),
    (1e-3, "1e-3"),
    (1e-2, "1e-2"),
    (1e-1, "0.1"),
    (3.0, "up to 3"),
    (f64::INFINITY, "won energy"),
];

fn shade(error: f64) -> RGBColor {
    let paints = [
        RGBColor(16, 78, 139),
        RGBColor(49, 130, 189),
        RGBColor(107, 174, 214),
        RGBColor(178, 217, 235),
        RGBColor(253, 224, 160),
        RGBColor(240, 150, 70),
        RGBColor(170, 20, 40),
    ];
    let place = KEY.iter().position(|(limit, _)| error < *limit);
    paints[place.unwrap_or(paints.len() - 1)]
}

fn short(x: f64) -> String {
    if x >= 10.0 || x == x.round() {
        format!("{x:.0}")
    } else if x >= 0.1 {
        format!("{x:.1}")
    } else {
        format!("{x:.2}")
    }
}

/// Fixed point, body of 1 kg and heavy body, joined by two springs of 1 m. ω is that of the heavy body on one spring.
fn two(omega: f64, ratio: f64) -> Problem {
    let k = (omega * omega * ratio) as f32;
    let heavy = ratio as f32;
    let stretched = 2.0 + AMPLITUDE as f32;
    let first = f64::from(stretched) - 2.0;
    let (stiffness, mass) = (f64::from(k), f64::from(heavy));
    let truth = move |t: f64| {
        // Normal modes from the two eigenvalues λ of M⁻¹K = [[2k, −k], [−k/m, k/m]].
        let (half, det) = (
            0.5 * (2.0 * stiffness + stiffness / mass),
            stiffness * stiffness / mass,
        );
        let root = (half * half - det).sqrt();
        let high = half + root;
        let squares = [det / high, high];
        // The eigenvectors are (k, 2k − λ). The initial displacement (0, first) is a combination of both.
        let [low, high] = squares.map(|s| 2.0 * stiffness - s);
        let share = first / (low - high);
        let wave = |i: usize| (squares[i].sqrt() * t).cos();
        share * (low * wave(0) - high * wave(1))
    };
    Problem {
        gravity: Vec3::ZERO,
        bodies: vec![
            Body::fixed(Vec3::ZERO),
            Body::point(1.0, Vec3::X),
            Body::point(heavy, Vec3::X * stretched),
        ],
        links: vec![Link::new(0, 1, k, 0.0, 1.0), Link::new(1, 2, k, 0.0, 1.0)],
        ground: false,
        seconds: SECONDS,
        size: AMPLITUDE,
        energy: None,
        truth: Truth::formula(2, move |t| DVec3::X * (2.0 + truth(t))),
    }
}

#[cfg(test)]
mod tests {
    use super::two;

    #[test]
    fn equal_masses_move_in_the_two_modes_of_the_golden_ratio() {
        let problem = two(1.0, 1.0);
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        // Two bodies of 1 kg on springs of 1 N/m have the modes ω = golden and ω = 1/golden.
        let first = 0.1;
        let shares = [
            golden * golden / (1.0 + golden * golden),
            1.0 / (1.0 + golden * golden),
        ];
        for t in [0.0, 0.5, 1.0] {
            let wanted =
                2.0 + first * (shares[0] * (t / golden).cos() + shares[1] * (t * golden).cos());
            let told = (problem.truth.at)(t).expect("it is known")[0].x;
            assert!((told - wanted).abs() < 1e-6, "{told} {wanted}");
        }
    }
}
