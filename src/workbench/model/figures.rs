//! Converts stiffness and damping to visible figures (frequency, damping ratio, sag) and back.

use crate::SpringTuning;
use std::f32::consts::TAU;

/// Load of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Load {
    /// Effective mass, kg; for a torsion element the moment of inertia, kg m².
    pub mass: f32,
    /// Gravity, m/s².
    pub gravity: f32,
}

impl Load {
    /// Whether the mass is finite and above zero, so that figures can be computed.
    pub fn is_sound(&self) -> bool {
        self.mass.is_finite() && self.mass > 0.0
    }

    /// Returns the undamped natural frequency, Hz.
    pub fn frequency(&self, stiffness: f32) -> f32 {
        (stiffness / self.mass).sqrt() / TAU
    }

    /// Returns the sag under gravity, m.
    pub fn sag(&self, stiffness: f32) -> f32 {
        self.mass * self.gravity / stiffness
    }

    /// Returns the critical damping, N s/m.
    pub fn critical(&self, stiffness: f32) -> f32 {
        2.0 * (stiffness * self.mass).sqrt()
    }

    /// Returns the damping ratio c/(2 √(k m)).
    pub fn ratio(&self, stiffness: f32, damping: f32) -> f32 {
        damping / self.critical(stiffness)
    }

    /// Returns the stiffness for a natural frequency (Hz), N/m.
    pub fn stiffness_for_frequency(&self, frequency: f32) -> f32 {
        let tuning = SpringTuning::frequency(frequency, 0.0);
        tuning.coefficients(self.mass, self.gravity).0
    }

    /// Returns the stiffness for a sag (m), N/m.
    pub fn stiffness_for_sag(&self, sag: f32) -> f32 {
        let tuning = SpringTuning::sag(sag, 0.0);
        tuning.coefficients(self.mass, self.gravity).0
    }

    /// Returns the damping for a damping ratio, N s/m.
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
