//! Formats measurements and settings for the report.

use crate::method::{Dial, Setting};
use crate::table::Row;

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
    format!("{:.1} µs", 1e6 * row.times.mean)
}

/// A setting with its time step.
pub fn name(setting: Setting) -> String {
    name_at(setting, &setting.rate.to_string())
}

/// A setting with a list of tick rates.
pub fn name_at(setting: Setting, rates: &str) -> String {
    let title = setting.method.title();
    match setting.dial {
        Dial::None => format!("{title} at {rates} Hz"),
        dial => format!("{title}, {dial}, at {rates} Hz"),
    }
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
