//! Recording of the last seconds of the chosen element.

use crate::readout::SpringReadout;
use std::collections::VecDeque;
use std::fmt::Write;

/// Length of the record, s.
pub(crate) const SECONDS: f64 = 20.0;

/// Greatest number of samples, for very short steps.
const MOST: usize = 100_000;

/// State of the element after one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    /// Time of the game, s.
    pub time: f64,
    pub readout: SpringReadout,
}

/// A quantity that can be plotted over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Length,
    Rate,
    SpringForce,
    DamperForce,
    Stored,
    Dissipated,
}

impl Quantity {
    pub fn of(self, sample: &Sample) -> f64 {
        let readout = &sample.readout;
        f64::from(match self {
            Self::Length => readout.length,
            Self::Rate => readout.rate,
            Self::SpringForce => readout.spring_force,
            Self::DamperForce => readout.damper_force,
            Self::Stored => readout.stored_energy,
            Self::Dissipated => readout.dissipated_energy,
        })
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Rate => "rate",
            Self::SpringForce => "spring",
            Self::DamperForce => "damper",
            Self::Stored => "stored",
            Self::Dissipated => "dissipated",
        }
    }
}

/// A ring buffer of samples.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    samples: VecDeque<Sample>,
}

impl Record {
    pub fn add(&mut self, sample: Sample) {
        // Time goes back with a saved state, and stands still in a pause of a game whose springs are in no fixed schedule.
        while self
            .samples
            .back()
            .is_some_and(|last| last.time >= sample.time)
        {
            self.samples.pop_back();
        }
        self.samples.push_back(sample);
        while self.samples.len() > MOST
            || self
                .samples
                .front()
                .is_some_and(|first| first.time < sample.time - SECONDS)
        {
            self.samples.pop_front();
        }
    }

    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// Returns the first and last time of the record, s.
    pub fn span(&self) -> Option<[f64; 2]> {
        Some([self.samples.front()?.time, self.samples.back()?.time])
    }

    /// Returns the last sample at or before a time, or else the first sample.
    pub fn at(&self, time: f64) -> Option<&Sample> {
        let after = self.samples.partition_point(|sample| sample.time <= time);
        self.samples.get(after.saturating_sub(1))
    }

    pub fn iter(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter()
    }

    /// Returns points for a plot. If there are many samples, they are divided into at most `pieces` pieces, and the
    /// least and greatest value of each piece are returned, so that no peak is lost.
    pub fn curve(&self, quantity: Quantity, pieces: usize) -> Vec<[f64; 2]> {
        let point = |sample: &Sample| [sample.time, quantity.of(sample)];
        let each = self.samples.len().div_ceil(pieces.max(1)).max(1);
        if each <= 2 {
            return self.iter().map(point).collect();
        }
        let mut out = Vec::with_capacity(2 * pieces);
        let mut piece = Vec::with_capacity(each);
        // Pieces are counted from the oldest sample. While samples are only added, old peaks do not flicker.
        for sample in &self.samples {
            piece.push(point(sample));
            if piece.len() == each {
                extremes(&mut piece, &mut out);
            }
        }
        extremes(&mut piece, &mut out);
        out
    }

    /// Returns the record as comma-separated values. For a torsion element, the columns are angles and moments.
    pub fn csv(&self, is_torsion: bool) -> String {
        let [motion, mass] = if is_torsion {
            [
                "angle_rad,rate_rad_per_s,spring_moment_N_m,damper_moment_N_m",
                "effective_inertia_kg_m2",
            ]
        } else {
            [
                "length_m,rate_m_per_s,spring_force_N,damper_force_N",
                "effective_mass_kg",
            ]
        };
        let mut out = format!(
            "time_s,{motion},stored_energy_J,dissipated_power_W,dissipated_energy_J,work_J,omega_dt,{mass},microsteps,error_m,capped\n"
        );
        for Sample { time, readout } in &self.samples {
            // Writing to a string cannot fail.
            let _ = writeln!(
                out,
                "{time},{},{},{},{},{},{},{},{},{},{},{},{},{}",
                readout.length,
                readout.rate,
                readout.spring_force,
                readout.damper_force,
                readout.stored_energy,
                readout.dissipated_power,
                readout.dissipated_energy,
                readout.work,
                readout.omega_dt,
                readout.effective_mass,
                readout.microsteps,
                readout.error,
                readout.capped,
            );
        }
        out
    }
}

/// Appends the least and greatest point of a piece to `out`, in order of time, and clears the piece.
fn extremes(piece: &mut Vec<[f64; 2]>, out: &mut Vec<[f64; 2]>) {
    let by_value = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
    let least = piece.iter().min_by(by_value).copied();
    let greatest = piece.iter().max_by(by_value).copied();
    if let (Some(least), Some(greatest)) = (least, greatest) {
        let order = if least[0] <= greatest[0] {
            [least, greatest]
        } else {
            [greatest, least]
        };
        out.extend(order);
    }
    piece.clear();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(samples: u32, dt: f64) -> Record {
        let mut record = Record::default();
        for i in 0..samples {
            let time = f64::from(i) * dt;
            let readout = SpringReadout {
                length: time as f32,
                ..SpringReadout::default()
            };
            record.add(Sample { time, readout });
        }
        record
    }

    #[test]
    fn it_keeps_twenty_seconds() {
        let record = record(3_000, 1.0 / 60.0);
        let [first, last] = record.span().expect("samples");
        assert!((last - first - SECONDS).abs() < 0.02);
        assert!((record.at(last - 1.0).expect("a sample").time - last + 1.0).abs() < 0.02);
        assert_eq!(record.at(-5.0).map(|sample| sample.time), Some(first));
    }

    #[test]
    fn time_that_goes_back_is_recorded_anew_from_there() {
        let mut record = record(100, 0.1);
        let [first, last] = record.span().expect("samples");
        record.add(Sample {
            time: last - 0.25,
            ..Sample::default()
        });
        assert_eq!(record.iter().count(), 98);
        record.add(Sample::default());
        assert_eq!((record.iter().count(), first), (1, 0.0));
    }

    #[test]
    fn a_pause_adds_no_samples() {
        let mut record = record(100, 0.1);
        let last = record.iter().last().copied().expect("samples");
        for _ in 0..1_000 {
            record.add(last);
        }
        assert_eq!(record.iter().count(), 100);
    }

    #[test]
    fn a_peak_is_seen_among_many_samples() {
        let mut record = record(15_000, 0.001);
        let readout = SpringReadout {
            length: 1e3,
            ..SpringReadout::default()
        };
        record.add(Sample {
            time: 15.0,
            readout,
        });
        let curve = record.curve(Quantity::Length, 300);
        assert!(curve.len() <= 602, "{}", curve.len());
        assert!(curve.iter().any(|point| point[1] == 1e3));
        assert!(curve.windows(2).all(|p| p[0][0] <= p[1][0]));
    }

    #[test]
    fn a_table_has_a_line_for_each_sample() {
        for is_torsion in [false, true] {
            let csv = record(10, 0.1).csv(is_torsion);
            let lines: Vec<_> = csv.lines().collect();
            assert_eq!(lines.len(), 11);
            let columns = lines[0].split(',').count();
            assert!(lines.iter().all(|line| line.split(',').count() == columns));
        }
    }

    #[test]
    fn a_table_has_the_units_of_what_was_measured() {
        let head = |is_torsion: bool| {
            let csv = record(1, 0.1).csv(is_torsion);
            csv.lines().next().map(String::from)
        };
        let linear = "time_s,length_m,rate_m_per_s,spring_force_N,damper_force_N,stored_energy_J,\
                      dissipated_power_W,dissipated_energy_J,work_J,omega_dt,effective_mass_kg,microsteps,error_m,capped";
        assert_eq!(head(false).as_deref(), Some(linear));
        let torsion = "time_s,angle_rad,rate_rad_per_s,spring_moment_N_m,damper_moment_N_m,stored_energy_J,\
                       dissipated_power_W,dissipated_energy_J,work_J,omega_dt,effective_inertia_kg_m2,microsteps,error_m,capped";
        assert_eq!(head(true).as_deref(), Some(torsion));
    }
}
