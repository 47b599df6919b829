use crate::compat::{Curve, Interval};
use bevy::prelude::*;

/// Forces (N, tension positive) as a test bench measures them: over stretch (m) in a
/// [`SpringLaw`](crate::SpringLaw), over the rate of the length (m/s) in a
/// [`DampingLaw`](crate::DampingLaw).
///
/// Between the points it is a monotone cubic (Fritsch and Carlson 1980), which never overshoots; beyond them it
/// goes straight on as the last two points show. Two points or more, x strictly rising, forces never falling.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone)]
pub struct ForceTable {
    /// x: stretch or rate; y: force.
    pub points: Vec<Vec2>,
}

impl ForceTable {
    /// Through points (stretch or rate, force).
    pub fn new(points: impl IntoIterator<Item = (f32, f32)>) -> Self {
        Self {
            points: points.into_iter().map(Vec2::from).collect(),
        }
    }

    /// Through so many points of a curve, its ends among them; without a point where its domain has no end.
    pub fn from_curve(curve: &impl Curve<f32>, points: usize) -> Self {
        let domain: Interval = curve.domain();
        let Ok(places) = domain.spaced_points(points) else {
            return Self::default();
        };
        Self::new(places.filter_map(|x| Some((x, curve.sample(x)?))))
    }
}
