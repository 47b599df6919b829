//! Table and chart of the cheapest setting of every method that stays within an error, for each scene.

use crate::method::{Method, Setting};
use crate::paint::{Drawn, FAINT, INK, Sheet, colour, font};
use crate::scenes::Scene;
use crate::table::Row;
use crate::words::{name, time};
use plotters::prelude::*;
use std::fmt::Write;
use std::path::Path;

/// Error limits, m.
const WITHIN: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// Fewest steps per second: the frame rate of a game.
const SLOWEST: u32 = 60;

/// The columns of the tables, each with the methods that count as variants of one method.
pub const WAYS: [&[Method]; 4] = [
    &[Method::Ours],
    &[Method::Joint],
    &[Method::Avian, Method::AvianBare],
    &[Method::Force],
];

/// Scenes with their rows.
type Measured<'a> = [(&'a Scene, Vec<Row>)];

/// The cheapest row, by computing time, of a column's methods with an error of at most `within` (m).
fn cheapest(rows: &[Row], way: &[Method], within: f64) -> Option<Row> {
    rows.iter()
        .filter(|r| way.contains(&r.setting.method) && r.setting.rate >= SLOWEST)
        .filter(|r| !r.strayed.diverged && r.strayed.error <= within)
        .min_by(|a, b| a.work().total_cmp(&b.work()))
        .copied()
}

/// Computing time per 1/60 s of the scene, µs.
fn price(row: &Row) -> f64 {
    1e6 * row.work() / 60.0
}

/// The shortest frame at 60 steps per second, of all settings that do not diverge, with its scene.
fn shortest<'a>(scenes: &Measured<'a>) -> Option<(&'a Scene, Row)> {
    scenes
        .iter()
        .flat_map(|(scene, rows)| rows.iter().map(move |row| (*scene, *row)))
        .filter(|(_, row)| row.setting.rate == SLOWEST && !row.strayed.diverged)
        .min_by(|(_, a), (_, b)| a.times.mean.total_cmp(&b.times.mean))
}

/// The table with its introduction and the link to the chart.
pub fn section(scenes: &Measured) -> String {
    let frame = shortest(scenes).map_or(String::new(), |(scene, row)| {
        let (name, time) = (name(row.setting), time(&row));
        format!(
            " Even the shortest frame of all, that of {name} in \"{}\", takes {time}.",
            scene.title
        )
    });
    let mut text = format!(
        "## What truth costs\n\n\
         ![For each scene the cheapest setting of every method](speed_vs_error/cost.svg)\n\n\
         For each scene and each error, the cheapest setting of every method that stays within that error, of all \
         settings at 60 to 960 steps a second. The numbers are computing time per 1/60 s of the scene in µs. It is \
         that of the whole frame, with all that Bevy and the engine do in it.{frame} A dash means that no \
         setting has so small an error; *not run*, that the method has no such spring or was not measured. \
         The settings are in the CSV files of the scenes, beside the chart.\n\n\
         | scene | within | bevy_coilover | Rapier SpringJoint | Avian distance joint | force once per step |\n\
         |---|---|---|---|---|---|\n",
    );
    for (scene, rows) in scenes {
        for within in WITHIN {
            let _ = write!(text, "| {} | {} mm |", scene.title, 1e3 * within);
            for way in WAYS {
                let _ = write!(text, " {} |", cell(rows, way, within));
            }
            text.push('\n');
        }
    }
    text + "\n"
}

/// Price and setting of the cheapest row of a column.
fn cell(rows: &[Row], way: &[Method], within: f64) -> String {
    if !rows.iter().any(|row| way.contains(&row.setting.method)) {
        return "not run".into();
    }
    cheapest(rows, way, within).map_or("–".into(), |row| {
        let Setting { dial, rate, .. } = row.setting;
        format!("{:.1} ({dial}, {rate} Hz)", price(&row))
    })
}

/// Draws a panel for each error limit, with a line for each scene and a dot for each method.
pub fn draw(path: &Path, scenes: &Measured) -> Drawn {
    let size = (1120, 130 + 34 * scenes.len() as u32);
    let sheet = SVGBackend::new(path, size).into_drawing_area();
    sheet.fill(&WHITE)?;
    let (names, panels) = sheet.split_horizontally(190);
    for (i, (scene, _)) in scenes.iter().enumerate() {
        let at = (14, height(i) - 7);
        names.draw(&Text::new(scene.title, at, font(14)))?;
    }
    let all = || {
        let rows = scenes
            .iter()
            .flat_map(|(_, rows)| WAYS.map(|way| (rows, way)));
        rows.flat_map(|(rows, way)| WITHIN.map(|within| cheapest(rows, way, within)))
    };
    let dearest = all().flatten().map(|row| price(&row)).fold(100.0, f64::max);
    for (panel, within) in panels.split_evenly((1, WITHIN.len())).iter().zip(WITHIN) {
        draw_panel(panel, scenes, within, dearest)?;
    }
    legend(&sheet, size.1 as i32 - 20)?;
    sheet.present()?;
    Ok(())
}

/// Vertical position of a scene's line, px.
fn height(scene: usize) -> i32 {
    66 + 34 * scene as i32
}

fn draw_panel(panel: &Sheet, scenes: &Measured, within: f64, dearest: f64) -> Drawn {
    const CHEAPEST: f64 = 7.0;
    let width = panel.dim_in_pixel().0 as i32;
    // The space to the right of this holds the methods without a setting within the limit.
    let reach = f64::from(width - 76);
    let at = |price: f64| 10 + (reach * (price / CHEAPEST).ln() / (dearest / CHEAPEST).ln()) as i32;
    let title = format!("within {} mm", 1e3 * within);
    panel.draw(&Text::new(title, (10, 14), font(17)))?;
    let bottom = height(scenes.len()) - 16;
    let ticks = ["10 µs", "100 µs", "1 ms", "10 ms", "100 ms"];
    for (decade, label) in ticks.into_iter().enumerate() {
        let tick = 10.0_f64.powi(decade as i32 + 1);
        if tick <= dearest {
            let x = at(tick);
            panel.draw(&PathElement::new([(x, 46), (x, bottom)], FAINT))?;
            panel.draw(&Text::new(label, (x - 14, bottom + 4), font(12)))?;
        }
    }
    let never = width - 28;
    panel.draw(&Text::new("not reached", (never - 40, 28), font(12)))?;
    for (i, (_, rows)) in scenes.iter().enumerate() {
        let y = height(i);
        panel.draw(&PathElement::new([(10, y), (width - 10, y)], FAINT))?;
        let mut missing = 0;
        // bevy_coilover comes first in `WAYS` and is drawn last, so that nothing hides it.
        for way in WAYS.iter().rev() {
            let paint = colour(way[0]);
            if !rows.iter().any(|row| way.contains(&row.setting.method)) {
                continue;
            }
            match cheapest(rows, way, within) {
                Some(row) => {
                    let radius = if way[0] == Method::Ours { 7 } else { 5 };
                    panel.draw(&Circle::new((at(price(&row)), y), radius, paint.filled()))?;
                }
                None => {
                    let x = never - 21 + 14 * missing;
                    panel.draw(&Cross::new((x, y), 4, paint.stroke_width(2)))?;
                    missing += 1;
                }
            }
        }
    }
    Ok(())
}

fn legend(sheet: &Sheet, y: i32) -> Drawn {
    let mut x = 200;
    for way in WAYS {
        sheet.draw(&Circle::new((x, y), 6, colour(way[0]).filled()))?;
        sheet.draw(&Text::new(way[0].title(), (x + 12, y - 7), font(14)))?;
        x += 180;
    }
    let words = "further left is cheaper";
    sheet.draw(&Text::new(words, (x, y - 7), font(14).color(&INK)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::SCENES;
    use crate::table::row;

    #[test]
    fn the_cheapest_that_is_true_enough_is_taken() {
        let rows = [
            row(Method::Joint, 30, 9e-6, 1e-5),
            row(Method::Joint, 60, 10e-6, 5e-3),
            row(Method::Joint, 120, 10e-6, 9e-4),
            row(Method::Joint, 240, 10e-6, 1e-4),
        ];
        let rate = |within| cheapest(&rows, WAYS[1], within).map(|row| row.setting.rate);
        assert_eq!(
            rate(1e-2),
            Some(60),
            "30 steps a second are too few for a game"
        );
        assert_eq!(rate(1e-3), Some(120));
        assert_eq!(rate(1e-5), None);
    }

    #[test]
    fn the_shortest_frame_is_one_that_was_measured() {
        let mut lost = row(Method::Force, 60, 8e-6, 1.0);
        lost.strayed.diverged = true;
        let rows = vec![
            lost,
            row(Method::Joint, 60, 21e-6, 1.0),
            row(Method::Ours, 60, 23e-6, 1.0),
            row(Method::Ours, 240, 9e-6, 1.0),
        ];
        let text = section(&[(&SCENES[0], rows)]);
        let told = "that of Rapier SpringJoint, 4 iterations, at 60 Hz in \"Single oscillator\", takes 21.0 µs.";
        assert!(text.contains(told), "{text}");
        assert!(
            text.contains("| – | – | not run | – |"),
            "no row of Avian: {text}"
        );
    }
}
