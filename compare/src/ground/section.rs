//! The report section of the scenes with contacts and joints.

use super::scenes::{Head, SCENES, Unit};
use super::{Told, cases, settings};
use crate::method::{Method, Setting};
use crate::words::digits;
use std::fmt::Write;

/// Introduction, and one table of all scenes and methods.
pub fn section(told: &[Told]) -> String {
    let release = told.iter().all(|t| t.release);
    let build = if release { "--release " } else { "" };
    let mut text = format!(
        "## On the ground and on joints\n\n\
         Made by `cargo run {build}-p compare -- --scene ground --fresh`. \
         Contacts and joints hold the bodies here, and no formula gives their true places. So each scene has a figure \
         of its own, for which physics gives a bound. \
         Time is that of a whole step at 60 steps a second, mean of turns spread over the 2nd to 10th second of \
         each scene.",
    );
    if !release {
        text.push_str(
            " **Times in this section are of a dev build.** Rapier alone is fully optimised in it, and Bevy, Avian and the \
             springs are not, so that they look slower beside Rapier than they are in a release build. \
             With `--release` the same command measures that one.",
        );
    }
    text.push_str("\n\n");
    for scene in &SCENES {
        let _ = writeln!(text, "- **{}.** {}", scene.title, scene.note);
    }
    text.push_str(
        "\nEnergy is the sum of kinetic energy, energy of height and energy stored in springs, computed from places \
         and velocities of the bodies. Above 1, or above 0 J, a method has gained energy from nothing. A method that \
         loses too much energy does not show it here, because the bound is an upper one. \
         Contacts are at each engine's defaults here, and nothing may sleep. \
         Avian has no joint like the wheel's guide, so it has no figure for it.\n\n",
    );
    table(&mut text, told);
    text.push('\n');
    text
}

fn table(text: &mut String, told: &[Told]) {
    let columns: Vec<Setting> = Method::ALL.into_iter().flat_map(settings).collect();
    text.push_str("| scene | figure |");
    for setting in &columns {
        let _ = match setting.method {
            Method::Ours => write!(text, " {} |", setting.method.title()),
            method => write!(text, " {}, {} |", method.title(), setting.dial),
        };
    }
    let _ = writeln!(text, "\n|---|---|{}", "---|".repeat(columns.len()));
    for (scene, speed) in cases(false) {
        let of = |setting: &Setting| {
            told.iter()
                .find(|t| t.scene.name == scene.name && t.speed == speed && t.setting == *setting)
        };
        if !columns.iter().any(|setting| of(setting).is_some()) {
            continue;
        }
        for (i, head) in scene.heads.iter().enumerate() {
            let _ = match scene.speeds {
                [_] => write!(text, "| {} | {} |", scene.title, head.name),
                _ => write!(text, "| {} at {speed} m/s | {} |", scene.title, head.name),
            };
            for setting in &columns {
                let cell = of(setting).map_or("–".into(), |t| cell(t, i, head));
                let _ = write!(text, " {cell} |");
            }
            text.push('\n');
        }
    }
}

/// Figure `i` of a scene. The first figure is followed by the time per step.
fn cell(told: &Told, i: usize, head: &Head) -> String {
    let figure = told.figures.get(i).copied().unwrap_or(f64::NAN);
    let figure = tell(figure, head.unit);
    if i > 0 {
        return figure;
    }
    format!("{figure} · {:.1} µs", 1e6 * told.times.mean)
}

fn tell(x: f64, unit: Unit) -> String {
    if !x.is_finite() {
        return "diverges".into();
    }
    match unit {
        Unit::Ratio if x.abs() < 10.0 => format!("{x:.3}"),
        Unit::Ratio => digits(x),
        Unit::Joule if x.abs() < 100.0 => format!("{x:+.2} J"),
        Unit::Joule => format!("{x:+.0} J"),
        Unit::Metre => format!("{} mm", digits(1e3 * x)),
        Unit::Count => format!("{x:.0}"),
        Unit::MetrePerSecond => format!("{} m/s", digits(x)),
    }
}

#[cfg(test)]
mod tests {
    use super::{Unit, tell};

    #[test]
    fn figures_have_units() {
        let told = [
            tell(1.0, Unit::Ratio),
            tell(-0.1, Unit::Joule),
            tell(1e-3, Unit::Metre),
            tell(f64::NAN, Unit::Ratio),
        ];
        assert_eq!(told, ["1.000", "-0.10 J", "1.0 mm", "diverges"]);
    }
}
