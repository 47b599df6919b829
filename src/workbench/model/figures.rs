//! Stiffness and damping by what one sees of them, both ways.

use crate::SpringTuning;
use std::f32::consts::TAU;

/// What an element carries, and under which gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Load {
    /// kg, or kg m² of a torsion element.
    pub mass: f32,
    /// m/s².
    pub gravity: f32,
}

impl Load {
    /// Whether anything follows from it.
    pub fn is_sound(&self) -> bool {
        self.mass.is_finite() && self.mass > 0.0
    }

    /// Undamped natural frequency, Hz.
    pub fn frequency(&self, stiffness: f32) -> f32 {
        (stiffness / self.mass).sqrt() / TAU
    }

    /// How far the load sags, m.
    pub fn sag(&self, stiffness: f32) -> f32 {
        self.mass * self.gravity / stiffness
    }

    /// Damping without overshoot, N s/m.
    pub fn critical(&self, stiffness: f32) -> f32 {
        2.0 * (stiffness * self.mass).sqrt()
    }

    /// c/(2 √(k m)).
    pub fn ratio(&self, stiffness: f32, damping: f32) -> f32 {
        damping / self.critical(stiffness)
    }

    /// The stiffness that has a frequency, N/m.
    pub fn stiffness_for_frequency(&self, frequency: f32) -> f32 {
        let tuning = SpringTuning::frequency(frequency, 0.0);
        tuning.coefficients(self.mass, self.gravity).0
    }

    /// The stiffness that sags so far, N/m.
    pub fn stiffness_for_sag(&self, sag: f32) -> f32 {
        let tuning = SpringTuning::sag(sag, 0.0);
        tuning.coefficients(self.mass, self.gravity).0
    }

    /// The damping that has a damping ratio, N s/m.
    pub fn damping_for_ratio(&self, stiffness: f32, ratio: f32) -> f32 {
        let tuning = SpringTuning::frequency(self.frequency(stiffness), ratio);
        tuning.coefficients(self.mass, self.gravity).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_agree() {
        let load = Load {
            mass: 300.0,
            gravity: 9.81,
        };
        let stiffness = load.stiffness_for_sag(0.1);
        assert!((stiffness - 29_430.0).abs() < 1.0);
        assert!((load.sag(stiffness) - 0.1).abs() < 1e-6);
        let frequency = load.frequency(stiffness);
        assert!((load.stiffness_for_frequency(frequency) / stiffness - 1.0).abs() < 1e-5);
        let damping = load.damping_for_ratio(stiffness, 0.3);
        assert!((damping - 1_783.0).abs() < 1.0);
        assert!((load.ratio(stiffness, damping) - 0.3).abs() < 1e-6);
    }
}
