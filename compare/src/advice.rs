//! Writes the report's advice on which micro-steps and tick rate suit which spring.

use crate::front::find;
use crate::method::{Dial, Method, Setting};
use crate::scenes::Scene;
use crate::table::Row;
use crate::words::length;
use bevy_coilover::recommend;
use std::fmt::Write;

const RATES: [u32; 5] = [30, 60, 120, 240, 480];
const TOLERANCES: [f32; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// The section "How to choose". Its tables come from the crate's `recommend` and from the measurements.
pub fn section(scenes: &[(&Scene, Vec<Row>)]) -> String {
    let mut text = String::from(
        "## How to choose\n\n\
         ω = √(k/m) is the spring's own angular frequency, dt the time step.\n\n\
         - **ω·dt up to 2.** With one micro-step, frequency and decay are right; a lone element's motion along its \
         line is exact. The remaining error comes from turning. It falls with the fourth power of the number of \
         micro-steps and of the tick rate (the third with damping), for elements that share or turn bodies with the \
         square; micro-steps cost less.\n\
         - **ω·dt above 2.** The default follows the spring's own motion with more micro-steps: a lone element up to \
         ω·dt = 64, networks as far as a budget of time allows. The maps above show how far.\n\
         - **Elements that share bodies** (chains, cloth, stars): more micro-steps, or extrapolation, which is \
         cheapest up to about ω·dt = 1.5 of the stiffest mode.\n\
         - **Contacts** follow the engine's step, not ours: raise the tick rate for them.\n\n\
         `recommend(stiffness, damping, mass, dt, tolerance)` returns the micro-steps of elements that share bodies \
         and swing over a metre. A lone one needs a single micro-step. For ω·dt up to 2 and little damping:\n\n| steps per second |",
    );
    for tolerance in TOLERANCES {
        let _ = write!(text, " {tolerance:e} m/s |");
    }
    text.push_str("\n|---|---|---|---|---|\n");
    for rate in RATES {
        let _ = write!(text, "| {rate} |");
        for tolerance in TOLERANCES {
            let n = recommend(1.0, 0.0, 1.0, (rate as f32).recip(), tolerance);
            let _ = write!(text, " {n} |");
        }
        text.push('\n');
    }
    text.push_str(
        "\nMeasured at 60 steps a second, largest error of each scene:\n\n\
         | scene | 1 | 2 | 4 | 8 | 16 micro-steps | extrapolated | tolerance 1e-3 |\n|---|---|---|---|---|---|---|---|\n",
    );
    let dials = [1, 2, 4, 8, 16]
        .map(Dial::Microsteps)
        .into_iter()
        .chain([Dial::Extrapolated(1), Dial::Tolerance(3)]);
    for (scene, rows) in scenes {
        let _ = write!(text, "| {} |", scene.title);
        for dial in dials.clone() {
            let setting = Setting {
                method: Method::Ours,
                dial,
                rate: 60,
            };
            let cell = find(rows, setting).map_or("–".into(), |row| length(&row));
            let _ = write!(text, " {cell} |");
        }
        text.push('\n');
    }
    text.push_str(&tolerance_prices(scenes));
    text.push('\n');
    text
}

/// Table of what a tolerance costs, relative to the cheapest fixed bevy_coilover setting that is at least as exact.
fn tolerance_prices(scenes: &[(&Scene, Vec<Row>)]) -> String {
    let mut text = String::from(
        "\nAt 60 steps a second: largest error with a tolerance, and its time as a multiple of that of the cheapest \
         fixed setting whose error is no larger (– where no fixed one is as exact):\n\n\
         | scene | tolerance 1e-2 | 1e-3 | 1e-4 m/s |\n|---|---|---|---|\n",
    );
    for (scene, rows) in scenes {
        let _ = write!(text, "| {} |", scene.title);
        for dial in [2, 3, 4].map(Dial::Tolerance) {
            let setting = Setting {
                method: Method::Ours,
                dial,
                rate: 60,
            };
            let Some(row) = find(rows, setting) else {
                text.push_str(" – |");
                continue;
            };
            let fixed = rows.iter().filter(|r| {
                r.setting.method == Method::Ours
                    && r.setting.rate == 60
                    && !matches!(r.setting.dial, Dial::Tolerance(_))
                    && !r.strayed.diverged
                    && r.strayed.error <= row.strayed.error
            });
            let best = fixed.map(|r| r.times.mean).min_by(|a, b| a.total_cmp(b));
            let price = best.map_or("–".into(), |best| format!("{:.2}", row.times.mean / best));
            let _ = if row.strayed.diverged {
                write!(text, " diverges |")
            } else {
                write!(text, " {} · {price} |", length(&row))
            };
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Table;
    use std::path::Path;

    #[test]
    fn a_lone_pendulum_needs_no_more_micro_steps_than_resolve_its_spring() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/speed_vs_error");
        let mut seen = 0;
        for (scene, stiffness) in [
            ("pendulum-soft", 50.0),
            ("pendulum-damped", 500.0),
            ("pendulum-stiff", 5e4),
        ] {
            for row in Table::open(&folder, scene).rows {
                let Dial::Microsteps(n) = row.setting.dial else {
                    continue;
                };
                let phase = f32::sqrt(stiffness) * row.setting.dt() as f32;
                if row.setting.rate < 60 || phase > 2.0 * n as f32 {
                    continue;
                }
                let error = row.strayed.error;
                assert!(error < 2e-4, "{scene}, {n} micro-steps: {error:.1e} m");
                seen += 1;
            }
        }
        assert!(seen > 10, "{seen} rows");
    }
}
