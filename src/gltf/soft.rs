//! Turns soft limits and drives of joints into elements.

use super::physics_joint::{Drive, Limit};
use crate::element::*;
use bevy::prelude::*;
use std::f32::consts::TAU;

/// The two attachment frames of a joint.
pub(super) struct Frames {
    /// The joint's node and its connected node.
    pub(super) nodes: [Entity; 2],
    /// Transforms of the two nodes in the world.
    pub(super) places: [Transform; 2],
    /// Transforms of the two bodies in the world.
    pub(super) bodies: [Transform; 2],
}

impl Frames {
    fn linear(&self, stiffness: f32, damping: f32) -> SpringDamper {
        let [a, b] = self.nodes;
        SpringDamper::new(a, b)
            .with_stiffness(stiffness)
            .with_damping(damping)
    }

    /// Returns an axis of the joint, in the frame of body A.
    fn axis(&self, index: usize) -> Vec3 {
        self.bodies[0].rotation.inverse() * (self.places[0].rotation * Vec3::AXES[index])
    }

    fn torsion(&self, index: usize, stiffness: f32, damping: f32) -> TorsionSpringDamper {
        let [a, b] = self.nodes;
        TorsionSpringDamper::new(a, b, self.axis(index))
            .with_stiffness(stiffness)
            .with_damping(damping)
    }

    /// Returns the angle between the bodies less the angle between the joint's frames, rad. The file counts angles
    /// between the joint's frames; elements count them between the bodies.
    fn offset(&self, index: usize) -> f32 {
        let between = |frames: &[Transform; 2], axis: Vec3| {
            twist(frames[0].rotation.inverse() * frames[1].rotation, axis)
        };
        between(&self.bodies, self.axis(index)) - between(&self.places, Vec3::AXES[index])
    }

    /// Spawns an element as a child of the joint's node, so that it is despawned with the scene.
    fn spawn(&self, world: &mut World, element: impl Bundle) -> Entity {
        world.spawn((element, ChildOf(self.nodes[0]))).id()
    }
}

/// Returns the angle of a rotation about an axis, from -π to π, rad.
fn twist(rotation: Quat, axis: Vec3) -> f32 {
    let along = Vec3::new(rotation.x, rotation.y, rotation.z).dot(axis.normalize_or_zero());
    let angle = 2.0 * along.atan2(rotation.w);
    (angle + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0
}

/// Adds a soft limit as elements between the joint's nodes. The error says why that is not possible.
pub(super) fn add_limit(
    world: &mut World,
    frames: &Frames,
    limit: &Limit,
    stiffness: f32,
) -> Result<(), &'static str> {
    let axes: Vec<_> = (0..3).filter(|i| limit.axes[*i]).collect();
    let damping = limit.damping;
    let (min, max) = (limit.min, limit.max);
    if min.is_none() && max.is_none() {
        return Ok(());
    }
    let same = if axes.len() > 1 && min.is_none() && max == Some(0.0) {
        // On several axes the limit is that of a distance, which is never negative.
        Some(0.0)
    } else {
        min.filter(|min| Some(*min) == max)
    };
    // Stops at both ends of a range, without force in between.
    let stops = |none: f32| {
        SpringTravel::new(min.unwrap_or(none), max.unwrap_or(f32::INFINITY), stiffness)
            .with_stop_damping(damping)
    };
    if limit.linear && axes.len() == 3 {
        let spring = frames.linear(stiffness, damping);
        match (min, max) {
            _ if same.is_some() => {
                let length = same.unwrap_or_default();
                frames.spawn(world, spring.with_rest_length(length));
            }
            (None | Some(0.0), Some(max)) => {
                frames.spawn(world, (spring.with_rest_length(max), SpringAction::Pull));
            }
            (Some(min), None) => {
                frames.spawn(world, (spring.with_rest_length(min), SpringAction::Push));
            }
            _ => {
                frames.spawn(world, (frames.linear(0.0, 0.0), stops(0.0)));
            }
        }
        return Ok(());
    }
    if axes.len() > 1 && same != Some(0.0) {
        return Err(
            "a soft limit on two axes, or on three angles, is honoured for min = max = 0 alone",
        );
    }
    for index in axes {
        if limit.linear {
            let axis = SpringAxis::BodyA(frames.axis(index));
            match same {
                Some(length) => {
                    let spring = frames.linear(stiffness, damping).with_rest_length(length);
                    frames.spawn(world, (spring, axis));
                }
                None => {
                    let travel = stops(f32::NEG_INFINITY);
                    frames.spawn(world, (frames.linear(0.0, 0.0), axis, travel));
                }
            }
        } else {
            let offset = frames.offset(index);
            match same {
                Some(angle) => {
                    let spring = frames.torsion(index, stiffness, damping);
                    frames.spawn(world, spring.with_rest_angle(angle + offset));
                }
                None => {
                    let mut travel = stops(f32::NEG_INFINITY);
                    travel.min_length += offset;
                    travel.max_length += offset;
                    frames.spawn(world, (frames.torsion(index, 0.0, 0.0), travel));
                }
            }
        }
    }
    Ok(())
}

/// Whether a drive becomes an element. A drive in acceleration mode does so only if it has a stiffness, from which
/// the element can be tuned, and no target velocity.
pub(super) fn is_ours(drive: &Drive) -> bool {
    !drive.acceleration || (drive.stiffness > 0.0 && drive.velocity == 0.0)
}

/// Adds a drive as an element: tension = stiffness · (x − target) + damping · (rate − target rate).
pub(super) fn add_drive(world: &mut World, frames: &Frames, drive: &Drive) {
    let (stiffness, damping) = (drive.stiffness, drive.damping);
    if stiffness == 0.0 && damping == 0.0 {
        return;
    }
    let element = if drive.linear {
        let spring = frames.linear(stiffness, damping);
        let axis = SpringAxis::BodyA(frames.axis(drive.axis));
        frames.spawn(world, (spring.with_rest_length(drive.position), axis))
    } else {
        let spring = frames.torsion(drive.axis, stiffness, damping);
        let angle = drive.position + frames.offset(drive.axis);
        frames.spawn(world, spring.with_rest_angle(angle))
    };
    let mut element = world.entity_mut(element);
    if drive.velocity != 0.0 {
        element.insert(Preload(-damping * drive.velocity));
    }
    if let Some(most) = drive.max_force {
        element.insert(MaxForce(most));
    }
    if drive.acceleration {
        // Stiffness and damping are given for 1 kg. The effective mass is only known at the first step.
        let root = stiffness.sqrt();
        element.insert(SpringTuning::frequency(root / TAU, 0.5 * damping / root));
    }
}
