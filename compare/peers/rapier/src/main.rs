//! Runs the scenes that `compare --describe` writes with Rapier's soft bodies, and prints rows of `peers.csv`.
//!
//! `cargo run --release -- FOLDER`. A spring is an edge of a soft body of particles. Rapier takes its frequency and damping
//! ratio, which are computed from the stiffness, the damping and the two point masses.

use rapier3d::prelude::*;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

/// Numbers of substeps per step: Rapier's default, and more.
const SUBSTEPS: [usize; 3] = [4, 16, 64];
const RATES: [u32; 3] = [60, 240, 960];

/// A scene of point masses.
#[derive(Default)]
struct Scene {
    gravity: Vector,
    seconds: f32,
    size: f32,
    /// Mass (kg, 0 if fixed), position (m) and velocity (m/s) of each body.
    bodies: Vec<(f32, Vector, Vector)>,
    links: Vec<Link>,
    watched: Vec<usize>,
    /// True positions of the watched bodies. The key is the time in units of 1/240 s.
    truth: BTreeMap<u32, Vec<Vector>>,
}

struct Link {
    ends: [u32; 2],
    stiffness: f32,
    damping: f32,
    rest_length: f32,
}

fn vector(words: &[f64]) -> Vector {
    Vector::new(words[0] as f32, words[1] as f32, words[2] as f32)
}

fn read(path: &Path) -> Result<Scene, Box<dyn Error>> {
    let mut scene = Scene::default();
    for line in std::fs::read_to_string(path)?.lines() {
        let mut words = line.split_whitespace();
        let key = words.next().unwrap_or_default();
        let numbers = words.map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        match key {
            "gravity" => scene.gravity = vector(&numbers),
            "seconds" => scene.seconds = numbers[0] as f32,
            "size" => scene.size = numbers[0] as f32,
            "body" => {
                let body = (numbers[0] as f32, vector(&numbers[1..]), vector(&numbers[4..]));
                scene.bodies.push(body);
            }
            "link" => scene.links.push(Link {
                ends: [numbers[0] as u32, numbers[1] as u32],
                stiffness: numbers[2] as f32,
                damping: numbers[3] as f32,
                rest_length: numbers[4] as f32,
            }),
            "watched" => scene.watched = numbers.iter().map(|n| *n as usize).collect(),
            "at" => {
                let places = numbers[1..].chunks_exact(3).map(vector).collect();
                scene.truth.insert((240.0 * numbers[0]).round() as u32, places);
            }
            other => return Err(format!("no key {other:?}").into()),
        }
    }
    Ok(scene)
}

impl Scene {
    fn inverse_mass(&self, body: u32) -> f32 {
        match self.bodies[body as usize].0 {
            0.0 => 0.0,
            mass => mass.recip(),
        }
    }

    /// Positions at which every edge has its rest length: a soft body takes the rest lengths from its initial positions.
    /// `None` if walking from link to link finds no such positions.
    fn places_at_rest(&self) -> Option<Vec<Vector>> {
        let mut places: Vec<Vector> = self.bodies.iter().map(|body| body.1).collect();
        let mut set = vec![false; places.len()];
        for link in &self.links {
            let [a, b] = link.ends.map(|end| end as usize);
            // An end that has its position already keeps it.
            let (stays, goes) = if set[b] && !set[a] { (b, a) } else { (a, b) };
            let along = self.bodies[goes].1 - self.bodies[stays].1;
            if !set[goes] {
                places[goes] = places[stays] + along.normalize() * link.rest_length;
            }
            (set[stays], set[goes]) = (true, true);
        }
        let fits = |link: &Link| {
            let [a, b] = link.ends.map(|end| places[end as usize]);
            (a.distance(b) - link.rest_length).abs() < 1e-5 * link.rest_length
        };
        self.links.iter().all(fits).then_some(places)
    }

    fn soft_body(&self) -> Option<SoftBodyBuilder> {
        let mut builder = SoftBodyBuilder::new(self.places_at_rest()?)
            .masses(self.bodies.iter().map(|body| if body.0 > 0.0 { body.0 } else { 1.0 }).collect())
            .pinned_particles((0..self.bodies.len() as u32).filter(|b| self.inverse_mass(*b) == 0.0))
            .edges(self.links.iter().map(|link| link.ends).collect())
            .no_surface_collider()
            .linear_damping(0.0)
            .can_sleep(false);
        builder.edge_softness = (0..).zip(&self.links).map(|(edge, link)| (edge, self.softness(link))).collect();
        Some(builder)
    }

    fn softness(&self, link: &Link) -> SpringCoefficients<f32> {
        let inverse_mass: f32 = link.ends.iter().map(|end| self.inverse_mass(*end)).sum();
        let omega = (link.stiffness * inverse_mass).sqrt();
        SpringCoefficients::new(omega / std::f32::consts::TAU, link.damping * inverse_mass / (2.0 * omega))
    }

    /// Returns the largest error (m), whether the run diverged (an error above ten times the motion's size, or NaN), and the
    /// median time of a step. `None` if there is no soft body for the scene.
    fn follow(&self, substeps: usize, rate: u32) -> Option<(f32, bool, Duration)> {
        let (mut bodies, mut colliders) = (RigidBodySet::new(), ColliderSet::new());
        let (mut joints, mut links) = (ImpulseJointSet::new(), MultibodyJointSet::new());
        let mut soft_bodies = SoftBodySet::new();
        let soft = soft_bodies.insert(self.soft_body()?, &mut bodies, &mut colliders);
        let soft_body = soft_bodies.get_mut(soft)?;
        for (i, (mass, place, velocity)) in self.bodies.iter().enumerate() {
            if *mass > 0.0 {
                soft_body.set_particle_position(i, *place);
                soft_body.set_particle_velocity(i, *velocity);
            }
        }
        let parameters = IntegrationParameters {
            dt: (rate as f32).recip(),
            num_solver_iterations: substeps,
            ..Default::default()
        };
        let mut pipeline = PhysicsPipeline::new();
        let mut islands = IslandManager::new();
        let mut broad = DefaultBroadPhase::new();
        let (mut narrow, mut ccd) = (NarrowPhase::new(), CCDSolver::new());
        let (mut worst, mut spent) = (0.0_f32, Vec::new());
        for step in 1..=(self.seconds * rate as f32).round() as u32 {
            let before = Instant::now();
            pipeline.step(
                self.gravity,
                &parameters,
                &mut islands,
                &mut broad,
                &mut narrow,
                &mut bodies,
                &mut colliders,
                &mut joints,
                &mut links,
                &mut soft_bodies,
                &mut ccd,
                &(),
                &(),
            );
            spent.push(before.elapsed());
            let (row, between) = (step * 240 / rate, (step * 240) % rate);
            let Some(truth) = self.truth.get(&row).filter(|_| between == 0) else {
                continue;
            };
            let now = soft_bodies.get(soft)?;
            for (body, place) in self.watched.iter().zip(truth) {
                let off = now.particle_position(*body).distance(*place);
                if !(off <= worst) {
                    worst = off;
                }
            }
            if !(worst <= 10.0 * self.size) {
                break;
            }
        }
        spent.sort();
        Some((worst, !(worst <= 10.0 * self.size), spent[spent.len() / 2]))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("a folder of scenes is wanted")?;
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        paths.push(entry?.path());
    }
    paths.retain(|path| path.extension().is_some_and(|e| e == "txt"));
    paths.sort();
    for path in paths {
        let (scene, name) = (read(&path)?, path.file_stem().unwrap_or_default().to_string_lossy());
        for substeps in SUBSTEPS {
            for rate in RATES {
                let Some((error, diverged, step)) = scene.follow(substeps, rate) else {
                    eprintln!("{name}: no places at which all edges have their rest length");
                    continue;
                };
                let (diverged, step) = (u8::from(diverged), 1e6 * step.as_secs_f64());
                println!("Rapier 0.36.1 soft body,{substeps} substeps,{name},{rate},{error:.3e},{diverged},{step:.1}");
            }
        }
    }
    Ok(())
}
