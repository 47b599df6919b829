use crate::compat::{Curve, Interval};
use bevy::prelude::*;

/// Forces (N, tension positive) as a test bench measures them: over the stretch (m) in a
/// [`SpringLaw`](crate::SpringLaw), or over the rate of the length (m/s) in a [`DampingLaw`](crate::DampingLaw).
///
/// Between the points the curve is a monotone cubic, which never overshoots (F. N. Fritsch and R. E. Carlson, SIAM J.
/// Numer. Anal. 17, 1980). Beyond them it is straight, with the slope between the last two points on that side. There
/// must be at least two points, x must rise strictly, forces must never fall, and no number or slope may be larger than
/// 1e12. Otherwise the element gets a [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone)]
pub struct ForceTable {
    /// Points of the curve: x is the stretch or the rate, y is the force.
    pub points: Vec<Vec2>,
}

impl ForceTable {
    /// From points (stretch or rate, force).
    pub fn new(points: impl IntoIterator<Item = (f32, f32)>) -> Self {
        Self {
            points: points.into_iter().map(Vec2::from).collect(),
        }
    }

    /// From this number of equally spaced points of a curve, both ends included. The table is empty if the domain of
    /// the curve is not bounded.
    pub fn from_curve(curve: &impl Curve<f32>, points: usize) -> Self {
        let domain: Interval = curve.domain();
        let Ok(places) = domain.spaced_points(points) else {
            return Self::default();
        };
        Self::new(places.filter_map(|x| Some((x, curve.sample(x)?))))
    }
}
