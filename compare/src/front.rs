//! Compares rows by error and computing time: Pareto front, and the other methods' rows that bevy_coilover does not beat.

use crate::method::{Method, Setting};
use crate::table::Row;

/// The Pareto front: the rows for which no other row is better in both error and computing time. Cheapest first.
pub fn front(rows: &[Row]) -> Vec<Row> {
    let mut sorted: Vec<Row> = rows
        .iter()
        .filter(|r| !r.strayed.diverged)
        .copied()
        .collect();
    sorted.sort_by(|a, b| a.work().total_cmp(&b.work()));
    let mut front: Vec<Row> = Vec::new();
    for row in sorted {
        if front
            .last()
            .is_none_or(|last| row.strayed.error < last.strayed.error)
        {
            front.push(row);
        }
    }
    front
}

/// The other methods' rows that no bevy_coilover row beats. A row beats another by a smaller error in no more
/// computing time per simulated second. Diverged rows are left out.
pub fn unbeaten(rows: &[Row]) -> Vec<Row> {
    let ours = |r: &&Row| r.setting.method == Method::Ours && !r.strayed.diverged;
    rows.iter()
        .filter(|r| r.setting.method != Method::Ours && !r.strayed.diverged)
        .filter(|peer| {
            !rows
                .iter()
                .filter(ours)
                .any(|o| o.work() <= peer.work() && o.strayed.error < peer.strayed.error)
        })
        .copied()
        .collect()
}

/// The other methods' rows that no bevy_coilover row with the same time step beats.
pub fn unbeaten_at_their_step(rows: &[Row]) -> Vec<Row> {
    let mut left = Vec::new();
    for rate in crate::method::rates(false) {
        let same: Vec<Row> = rows
            .iter()
            .filter(|r| r.setting.rate == *rate)
            .copied()
            .collect();
        left.extend(unbeaten(&same));
    }
    left
}

/// Finds the row of a setting.
pub fn find(rows: &[Row], setting: Setting) -> Option<Row> {
    rows.iter().find(|r| r.setting == setting).copied()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::row;

    #[test]
    fn less_error_in_no_more_time() {
        let rows = [
            row(Method::Ours, 30, 11e-6, 1e-3),
            row(Method::Ours, 60, 11e-6, 1e-4),
            row(Method::Joint, 60, 10e-6, 1e-2),
            row(Method::Force, 30, 9e-6, 1.0),
        ];
        // Per simulated second, bevy_coilover at 30 Hz costs less than the joint at 60 Hz, but more than the force at 30 Hz.
        assert_eq!(unbeaten(&rows), vec![rows[3]]);
        assert_eq!(unbeaten_at_their_step(&rows), vec![rows[3], rows[2]]);
        assert_eq!(front(&rows), vec![rows[3], rows[0], rows[1]]);
    }
}
