//! The surface of the jelly, outside the hull of the points by the radius of their ball colliders.

use super::lattice::{PITCH, RADIUS, SIDE, all, index};
use bevy::prelude::*;
use stage::{Paint, Skin, Vertex};
use std::collections::HashMap;

/// Number of parts that a cell's edge is divided into.
const PARTS: usize = 4;
/// Last index of the lattice along an axis.
const LAST: f32 = (SIDE - 1) as f32;
/// Distance of the surface from the points' hull, in cells.
const OUT: f32 = RADIUS / PITCH;

pub fn skin(points: &[Entity]) -> Skin {
    let steps = PARTS * (SIDE - 1);
    let mut along = vec![-OUT, -0.5 * OUT];
    along.extend((0..=steps).map(|i| i as f32 / PARTS as f32));
    along.extend([LAST + 0.5 * OUT, LAST + OUT]);
    let mut vertices = Vec::new();
    let mut known = HashMap::new();
    let mut triangles = Vec::new();
    let count = along.len();
    for face in 0..6 {
        let (axis, far) = (face / 2, face % 2 == 1);
        let mut number = |i: usize, j: usize| {
            let mut at = Vec3::ZERO;
            at[axis] = if far { LAST + OUT } else { -OUT };
            at[(axis + 1) % 3] = along[i];
            at[(axis + 2) % 3] = along[j];
            let at = rounded(at);
            let key = (at * 1e4).round().as_ivec3();
            *known.entry(key).or_insert_with(|| {
                vertices.push(Vertex {
                    follows: follows(at, points),
                    ..default()
                });
                vertices.len() as u32 - 1
            })
        };
        for i in 1..count {
            for j in 1..count {
                let [a, b] = [number(i - 1, j - 1), number(i, j - 1)];
                let [c, d] = [number(i - 1, j), number(i, j)];
                triangles.extend(if far {
                    [[a, b, c], [c, b, d]]
                } else {
                    [[a, c, b], [c, d, b]]
                });
            }
        }
    }
    Skin {
        vertices,
        triangles,
        paint: Paint::Jelly,
    }
}

/// Returns the nearest position at that distance from the points' hull.
fn rounded(at: Vec3) -> Vec3 {
    let inner = at.clamp(Vec3::ZERO, Vec3::splat(LAST));
    inner + OUT * (at - inner).normalize_or_zero()
}

/// Returns the points to follow, with the weights whose weighted mean gives this position in the lattice.
fn follows(at: Vec3, points: &[Entity]) -> Vec<(Entity, f32)> {
    let weights = at.to_array().map(weights);
    let each = all().map(|p| {
        let weight = weights[0][p[0]] * weights[1][p[1]] * weights[2][p[2]];
        (points[index(p)], weight)
    });
    each.filter(|(_, weight)| *weight != 0.0).collect()
}

/// Returns the weights of a Catmull-Rom curve through a row of points, extended straight beyond its ends.
fn weights(t: f32) -> [f32; SIDE] {
    let mut weights = [0.0; SIDE];
    let cell = (t.floor().max(0.0) as usize).min(SIDE - 2);
    let s = t - cell as f32;
    let mut add = |place: usize, weight: f32| {
        // Extrapolates straight before the first and after the last point.
        if place == 0 {
            weights[0] += 2.0 * weight;
            weights[1] -= weight;
        } else if place == SIDE + 1 {
            weights[SIDE - 1] += 2.0 * weight;
            weights[SIDE - 2] -= weight;
        } else {
            weights[place - 1] += weight;
        }
    };
    if !(0.0..=1.0).contains(&s) {
        add(cell + 1, 1.0 - s);
        add(cell + 2, s);
        return weights;
    }
    add(cell, 0.5 * s * (-1.0 + s * (2.0 - s)));
    add(cell + 1, 0.5 * (2.0 + s * s * (-5.0 + 3.0 * s)));
    add(cell + 2, 0.5 * s * (1.0 + s * (4.0 - 3.0 * s)));
    add(cell + 3, 0.5 * s * s * (s - 1.0));
    weights
}
