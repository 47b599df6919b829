//! Formats measurements for the report and writes sentences that compare the methods.

use crate::front::{find, unbeaten, unbeaten_at_their_step};
use crate::method::{Dial, Method, Setting};
use crate::table::Row;
use std::fmt::Write;

/// Rounds to two significant digits, but keeps all three digits from 100 to 999 and only one digit below 0.001.
pub fn digits(x: f64) -> String {
    if !x.is_finite() {
        return "–".into();
    }
    if x == 0.0 {
        return "0".into();
    }
    let size = x.abs().log10().floor();
    if size >= 3.0 {
        let unit = 10.0_f64.powf(size - 1.0);
        format!("{:.0}", (x / unit).round() * unit)
    } else if size >= 1.0 {
        format!("{x:.0}")
    } else if size >= -3.0 {
        format!("{:.*}", (1.0 - size) as usize, x)
    } else {
        format!("{x:.0e}")
    }
}

/// Error of a row in mm, or "diverges".
pub fn length(row: &Row) -> String {
    if row.strayed.diverged {
        "diverges".into()
    } else {
        format!("{} mm", digits(1e3 * row.strayed.error))
    }
}

/// Time per step in µs.
pub fn time(row: &Row) -> String {
    format!("{:.1} µs", 1e6 * row.times.median)
}

fn name(setting: Setting) -> String {
    let title = setting.method.title();
    match setting.dial {
        Dial::None => format!("{title} at {} Hz", setting.rate),
        dial => format!("{title}, {dial}, at {} Hz", setting.rate),
    }
}

/// Sentences that sum up a scene's table.
pub fn verdict(rows: &[Row]) -> String {
    let peers: Vec<&Row> = rows
        .iter()
        .filter(|r| r.setting.method != Method::Ours)
        .collect();
    let ours: Vec<&Row> = rows
        .iter()
        .filter(|r| r.setting.method == Method::Ours)
        .collect();
    if peers.is_empty() || ours.is_empty() {
        return String::new();
    }
    let mut text = String::new();
    let lost = peers.iter().filter(|r| r.strayed.diverged).count();
    let left = unbeaten(rows);
    let sum = peers.len();
    if left.is_empty() {
        let _ = write!(
            text,
            "**Our error is below that of all {sum} settings of the others, in no more computing time.**"
        );
    } else {
        let _ = write!(
            text,
            "**Our error is below that of {} of the {sum} settings of the others, in no more computing time.**",
            sum - left.len()
        );
        let cheapest = ours.iter().map(|o| o.work()).fold(f64::INFINITY, f64::min);
        let (cheap, close): (Vec<Row>, Vec<Row>) =
            left.into_iter().partition(|r| r.work() < cheapest);
        if !cheap.is_empty() {
            let _ = write!(
                text,
                " Cheaper than every setting of ours: {}.",
                list(&cheap)
            );
        }
        if !close.is_empty() {
            let _ = write!(
                text,
                " No less exact than ours in the same time: {}.",
                list(&close)
            );
        }
    }
    let left = unbeaten_at_their_step(rows).len();
    let _ = write!(
        text,
        " With the same time step as theirs, our error is below that of {} of {sum}.",
        sum - left
    );
    match lost {
        0 => {}
        1 => text.push_str(" One setting of the others diverges."),
        _ => {
            let _ = write!(text, " {lost} settings of the others diverge.");
        }
    }
    for method in [Method::Joint, Method::Force, Method::Avian] {
        text.push_str(&against(rows, method));
    }
    text
}

/// Compares the default of bevy_coilover with the default of another method, at 60 steps per second.
fn against(rows: &[Row], method: Method) -> String {
    let ours = find(rows, Setting::default_of(Method::Ours, 60));
    let (Some(ours), Some(peer)) = (ours, best_of(rows, method)) else {
        return String::new();
    };
    let ratio = ours.times.median / peer.times.median;
    let errors = if peer.strayed.diverged {
        "it diverges".into()
    } else {
        format!(
            "the error {} times smaller",
            digits(peer.strayed.error / ours.strayed.error)
        )
    };
    format!(
        " Our default step takes {ratio:.2} times as long as {}: {errors}.",
        name(peer.setting)
    )
}

/// The row of a method's default at 60 steps per second. For Avian, the variant with the smaller error.
pub fn best_of(rows: &[Row], method: Method) -> Option<Row> {
    let one = find(rows, Setting::default_of(method, 60));
    if method != Method::Avian {
        return one;
    }
    let other = find(rows, Setting::default_of(Method::AvianBare, 60));
    match (one, other) {
        (Some(a), Some(b)) if a.strayed.error.is_nan() || b.strayed.error < a.strayed.error => {
            Some(b)
        }
        (one, other) => one.or(other),
    }
}

fn list(rows: &[Row]) -> String {
    const MOST: usize = 5;
    let mut parts: Vec<String> = rows
        .iter()
        .take(MOST)
        .map(|r| format!("{} ({})", name(r.setting), length(r)))
        .collect();
    if rows.len() > MOST {
        parts.push(format!("and {} more", rows.len() - MOST));
    }
    parts.join("; ")
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn two_digits() {
        let told = [0.0, 1234.0, 606.2, 12.34, 1.24, 0.0567, 0.00123, 4.2e-5].map(digits);
        let wanted = ["0", "1200", "606", "12", "1.2", "0.057", "0.0012", "4e-5"];
        assert_eq!(told, wanted.map(String::from));
    }
}
