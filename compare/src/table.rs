//! The measurements of a scene, stored as CSV between runs.

use crate::clock::Times;
use crate::follow::Strayed;
use crate::method::{Method, Setting, rates};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// A setting and its results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    pub setting: Setting,
    pub strayed: Strayed,
    pub times: Times,
    /// Number of timed turns.
    pub turns: u32,
}

/// All rows of a scene.
pub struct Table {
    path: PathBuf,
    pub rows: Vec<Row>,
}

const HEADER: &str = "method,setting,steps_per_second,largest_error_m,energy_drift,momentum_drift,diverged,\
                      step_us,step_us_quartile_1,step_us_quartile_3,turns";

impl Table {
    /// Reads the table of an earlier run. Empty if there is none.
    pub fn open(folder: &Path, scene: &str) -> Self {
        let path = folder.join(format!("{scene}.csv"));
        let text = fs::read_to_string(&path).unwrap_or_default();
        let rows = text.lines().skip(1).filter_map(Row::parse).collect();
        Self { path, rows }
    }

    /// Whether the table has this setting with at least `turns` timed turns.
    pub fn has(&self, setting: Setting, turns: u32) -> bool {
        self.rows
            .iter()
            .any(|row| row.setting == setting && row.turns >= turns)
    }

    /// Adds rows, replaces older rows of the same settings, and writes the file.
    pub fn put(&mut self, rows: Vec<Row>) -> io::Result<()> {
        for row in rows {
            self.rows.retain(|old| old.setting != row.setting);
            self.rows.push(row);
        }
        self.rows
            .sort_by_key(|r| (r.setting.method, r.setting.rate, r.setting.dial));
        let lines: Vec<String> = self.rows.iter().map(Row::line).collect();
        fs::write(&self.path, format!("{HEADER}\n{}\n", lines.join("\n")))
    }
}

impl Row {
    /// Computing time per simulated second, s.
    pub fn work(&self) -> f64 {
        self.times.mean * f64::from(self.setting.rate)
    }

    fn line(&self) -> String {
        let optional = |x: Option<f64>| x.map(|x| format!("{x:.3e}")).unwrap_or_default();
        let Strayed {
            error,
            energy,
            momentum,
            diverged,
        } = self.strayed;
        let us = |s: f64| format!("{:.2}", 1e6 * s);
        format!(
            "{},{},{},{error:.3e},{},{},{},{},{},{},{}",
            self.setting.method.name(),
            self.setting.dial,
            self.setting.rate,
            optional(energy),
            optional(momentum),
            u8::from(diverged),
            us(self.times.mean),
            us(self.times.low),
            us(self.times.high),
            self.turns,
        )
    }

    fn parse(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        let [
            method,
            dial,
            rate,
            error,
            energy,
            momentum,
            diverged,
            mean,
            low,
            high,
            turns,
        ] = cells.as_slice()
        else {
            return None;
        };
        let method = Method::named(method)?;
        let dial = method
            .dials(false)
            .into_iter()
            .find(|d| d.to_string() == *dial)?;
        let rate = rate.parse().ok().filter(|r| rates(false).contains(r))?;
        let us = |cell: &str| cell.parse::<f64>().ok().map(|us| 1e-6 * us);
        Some(Self {
            setting: Setting { method, dial, rate },
            strayed: Strayed {
                error: error.parse().ok()?,
                energy: energy.parse().ok(),
                momentum: momentum.parse().ok(),
                diverged: *diverged == "1",
            },
            times: Times {
                mean: us(mean)?,
                low: us(low)?,
                high: us(high)?,
            },
            turns: turns.parse().ok()?,
        })
    }
}

/// A row of a method's default that takes `step` seconds and does not diverge.
#[cfg(test)]
pub fn row(method: Method, rate: u32, step: f64, error: f64) -> Row {
    Row {
        setting: Setting::default_of(method, rate),
        strayed: Strayed {
            error,
            energy: None,
            momentum: None,
            diverged: false,
        },
        times: Times {
            mean: step,
            low: step,
            high: step,
        },
        turns: 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Dial;

    #[test]
    fn a_row_survives_its_file() {
        for error in [1.25e-4, f64::NAN] {
            let row = Row {
                setting: Setting {
                    method: Method::Ours,
                    dial: Dial::Tolerance(3),
                    rate: 240,
                },
                strayed: Strayed {
                    error,
                    energy: Some(1e-3),
                    momentum: None,
                    diverged: error.is_nan(),
                },
                times: Times {
                    mean: 42.5e-6,
                    low: 40e-6,
                    high: 45e-6,
                },
                turns: 15,
            };
            let back = Row::parse(&row.line()).map(|r| r.line());
            assert_eq!(back, Some(row.line()));
        }
    }
}
