//! Hashes that detect changes.

use crate::backend::Seen;
use bevy::math::DVec3;

/// Mixes the bits of an entity, so that different sets of entities have different sums.
pub(crate) fn mix(bits: u64) -> u64 {
    let x = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb)
}

/// Hash of the rotation and angular velocity of a body.
pub(crate) fn turning_mark(body: &Seen) -> u64 {
    let [x, y, z, w] = body.rotation.to_array();
    let [a, b, c] = body.spin.to_array();
    let bits = [x, y, z, w, a, b, c].map(|x| u64::from(x.to_bits()));
    bits.into_iter().fold(0, |sum, bits| mix(sum ^ bits))
}

/// Hash of an acceleration.
pub(crate) fn pull_mark(acceleration: DVec3) -> u64 {
    let bits = acceleration.to_array().map(f64::to_bits);
    bits.into_iter().fold(0, |sum, bits| mix(sum ^ bits))
}
