//! The points and threads of the flag.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape, Skin, Vertex, floor};
use std::collections::HashSet;

/// Number of points along the flag and down it.
pub const SIZE: [usize; 2] = [19, 13];
/// Distance between neighbouring points, m.
pub const PITCH: f32 = 0.08;
/// Mass of the cloth, kg/m².
const CLOTH: f32 = 0.5;
/// Mass of a point, kg.
pub const MASS: f32 = CLOTH * PITCH * PITCH;
/// Stiffness of the threads along the edges of the cells, across their diagonals, and over two cells, N/m.
const STIFFNESS: [f32; 3] = [1000.0, 150.0, 1.0];
/// Damping over stiffness, s.
const DAMPING: f32 = 6e-4;
/// Force at which a thread breaks, N, with a spread of ±15 %. It is twice that near the pole, where the cloth is
/// doubled. It bears 1.13 times the greatest pull before the gust, when the flag falls at first.
const STRENGTH: f32 = 8.0;
/// Number of point columns in the doubled cloth.
const DOUBLED: usize = 6;
/// Height of the pole, m.
const POLE: f32 = 3.2;

/// State of the flag.
#[derive(Resource)]
pub struct Flag {
    /// Entities of all points, row by row.
    pub points: Vec<Entity>,
    /// Torn edges, as the indices of their points, lower first.
    pub torn: HashSet<[usize; 2]>,
    /// Intact cells, as the indices of their corners. The corner nearest to the pole's top comes first.
    pub cells: Vec<[usize; 4]>,
}

/// On a point: its index.
#[derive(Component)]
pub struct Point(pub usize);

/// On a thread: its points, and the edges it depends on. It is removed when one of those edges tears.
#[derive(Component)]
pub struct Thread {
    pub ends: [usize; 2],
    pub over: Vec<[usize; 2]>,
}

pub fn edges_of([a, b, c, d]: [usize; 4]) -> [[usize; 2]; 4] {
    [[a, b], [c, d], [a, c], [b, d]]
}

pub fn setup(mut commands: Commands) {
    commands.spawn(floor());
    commands.spawn((
        Transform::from_xyz(0.0, 0.5 * POLE, 0.0),
        Shape::Cylinder(0.03, POLE, Paint::Ivory),
    ));
    commands.spawn((
        Transform::from_xyz(0.0, POLE + 0.04, 0.0),
        Shape::Ball(0.06, Paint::Sand),
    ));
    let [long, high] = SIZE;
    let points: Vec<Entity> = (0..long * high)
        .map(|i| {
            let (x, y) = ((i % long) as f32, (i / long) as f32);
            let at = Transform::from_xyz(0.03 + PITCH * x, POLE - 0.05 - PITCH * y, 0.0);
            if i % long == 0 {
                return commands.spawn(at).id();
            }
            let body = (
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(MASS),
                LockedAxes::ROTATION_LOCKED,
                Velocity::default(),
                ExternalForce::default(),
            );
            commands.spawn((body, at, Point(i))).id()
        })
        .collect();
    let mut thread = |a: usize, b: usize, kind: usize, over: Vec<[usize; 2]>| {
        if a.is_multiple_of(long) && b.is_multiple_of(long) {
            return;
        }
        let steps = Vec2::new((b % long) as f32, (b / long) as f32)
            - Vec2::new((a % long) as f32, (a / long) as f32);
        let stiffness = STIFFNESS[kind];
        let spring = SpringDamper::new(points[a], points[b])
            .with_stiffness(stiffness)
            .with_damping(DAMPING * stiffness)
            .with_rest_length(PITCH * steps.length());
        let mut thread = commands.spawn((spring, Thread { ends: [a, b], over }));
        if kind == 0 {
            let sewn = if a % long < DOUBLED { 2.0 } else { 1.0 };
            let strength = sewn * STRENGTH * (1.0 + 0.3 * (uneven(a, b) - 0.5));
            thread.insert(Breakable::at_force(strength));
        }
    };
    let mut cells = Vec::new();
    for a in 0..long * high {
        let (x, y) = (a % long, a / long);
        let [right, down] = [x + 1 < long, y + 1 < high];
        if right {
            thread(a, a + 1, 0, vec![]);
        }
        if down {
            thread(a, a + long, 0, vec![]);
        }
        if right && down {
            let cell = [a, a + 1, a + long, a + long + 1];
            thread(cell[0], cell[3], 1, edges_of(cell).to_vec());
            thread(cell[1], cell[2], 1, edges_of(cell).to_vec());
            cells.push(cell);
        }
        if x + 2 < long {
            thread(a, a + 2, 2, vec![[a, a + 1], [a + 1, a + 2]]);
        }
        if y + 2 < high {
            let (b, c) = (a + long, a + 2 * long);
            thread(a, c, 2, vec![[a, b], [b, c]]);
        }
    }
    let vertices = points.iter().map(|point| Vertex {
        follows: vec![(*point, 1.0)],
        ..default()
    });
    commands.spawn(Skin {
        vertices: vertices.collect(),
        triangles: triangles(&cells),
        paint: Paint::Cloth,
    });
    commands.insert_resource(Flag {
        points,
        torn: default(),
        cells,
    });
}

pub fn triangles(cells: &[[usize; 4]]) -> Vec<[u32; 3]> {
    let halves = |[a, b, c, d]: &[usize; 4]| [[*a, *c, *b], [*b, *c, *d]];
    let all = cells.iter().flat_map(halves);
    all.map(|triangle| triangle.map(|i| i as u32)).collect()
}

/// Returns a fixed pseudo-random number from 0 to 1 for a thread.
fn uneven(a: usize, b: usize) -> f32 {
    let mixed = (a * 7919 + b * 104_729) % 1009;
    mixed as f32 / 1008.0
}
