//! After the engine's step: what each element shows.

use super::body::Bodies;
use crate::backend::Worlds;
use crate::element::{Spring, SpringDamper, SpringTuning, TorsionSpring, TorsionSpringDamper};
use crate::input::parts::{Acts, IsElement};
use crate::readout::SpringReadout;
use crate::scene::observe::Look;
use crate::scene::report::report;
use crate::scene::rows::ElementRow;
use crate::scene::state::Scene;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::RigidBodySet;

/// What a captured rest length or angle is written into.
type Springs<'a> = (
    Option<&'a mut Spring>,
    Option<&'a mut SpringDamper>,
    Option<&'a mut TorsionSpring>,
    Option<&'a mut TorsionSpringDamper>,
    Option<&'a SpringTuning>,
);

/// Writes readouts, captured rest lengths, and faults found while solving.
pub(crate) fn measure(
    mut scene: ResMut<Scene>,
    sets: Query<&'static RapierRigidBodySet>,
    mut readouts: Query<(Entity, &mut SpringReadout), Acts>,
    mut springs: Query<Springs, IsElement>,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    if scene.time <= 0.0 {
        return;
    }
    if !(scene.delivered || scene.immovable) {
        // All asleep.
        return;
    }
    let time = scene.time;
    let worlds = Sets(&sets);
    let mut look = Look::new(&worlds);
    let mut show = |row: &mut ElementRow, readout: Option<&mut Mut<SpringReadout>>| {
        let led = row.moves() == 0 && row.memory.places[0].is_some();
        let Some(points) = row.see(time, &mut scene.bodies, &mut look) else {
            return;
        };
        tell(row, &mut springs, &mut commands);
        let seen = row.seen(points, time, &mut look);
        if led {
            row.account_for_moved(seen, time);
        }
        row.memory.length = seen.0;
        if let Some(readout) = readout {
            readout.set_if_neq(row.read_out(seen, time));
        }
    };
    // The rows stand in the query's order; if something came, went or got other components since they were
    // made, from there on each is looked up, and the rows are made anew.
    let mut unordered = false;
    let mut rows = scene.elements.iter_mut();
    for (entity, mut readout) in &mut readouts {
        let next = rows.as_slice().first();
        unordered = next.is_none_or(|row| row.entity != entity);
        if unordered {
            break;
        }
        if let Some(row) = rows.next() {
            show(row, Some(&mut readout));
        }
    }
    for row in rows {
        let mut readout = readouts.get_mut(row.entity).ok();
        show(row, readout.as_mut().map(|(_, readout)| readout));
    }
    if scene.renewed {
        scene.unordered = unordered;
    }
    scene.stale |= look.stale || (unordered && !scene.unordered);
}

/// Tells what was found in this tick: faults, captured rest lengths, coefficients that were worked out.
#[inline(always)]
fn tell(row: &mut ElementRow, springs: &mut Query<Springs, IsElement>, commands: &mut Commands) {
    report(row, commands);
    let tuned = std::mem::take(&mut row.tuned);
    if (std::mem::take(&mut row.captured) && row.trouble.passing().is_none()) || tuned {
        write_back(row, tuned, springs);
    }
    if tuned && !row.tuned_again {
        commands.entity(row.entity).try_remove::<SpringTuning>();
    }
}

/// Writes a captured rest length into the element's component, and coefficients that were worked out.
fn write_back(row: &ElementRow, tuned: bool, springs: &mut Query<Springs, IsElement>) {
    let Ok((spring, pair, torsion, torsion_pair, tuning)) = springs.get_mut(row.entity) else {
        return;
    };
    let p = &row.parameters;
    // What a sag makes of the rest length is found anew with the stiffness.
    let passing = tuned && row.tuned_again && matches!(tuning, Some(SpringTuning::Sag { .. }));
    let write = |rest: &mut Option<f32>, stiffness: &mut f32, damping: Option<&mut f32>| {
        if !passing {
            *rest = p.rest_length;
        }
        if tuned {
            *stiffness = p.stiffness;
            if let Some(damping) = damping {
                *damping = p.damping;
            }
        }
    };
    if let Some(mut s) = spring {
        let s = &mut *s;
        write(&mut s.rest_length, &mut s.stiffness, None);
    }
    if let Some(mut s) = pair {
        let s = &mut *s;
        write(&mut s.rest_length, &mut s.stiffness, Some(&mut s.damping));
    }
    if let Some(mut s) = torsion {
        let s = &mut *s;
        write(&mut s.rest_angle, &mut s.stiffness, None);
    }
    if let Some(mut s) = torsion_pair {
        let s = &mut *s;
        write(&mut s.rest_angle, &mut s.stiffness, Some(&mut s.damping));
    }
}

/// The bodies of all contexts, after the step.
struct Sets<'a, 'w, 's>(&'a Query<'w, 's, &'static RapierRigidBodySet>);

impl<'a> Worlds for Sets<'a, '_, '_> {
    type Sight = Bodies<&'a RigidBodySet>;

    #[inline(always)]
    fn of(&self, context: Entity) -> Option<Bodies<&'a RigidBodySet>> {
        let set = self.0.get(context).ok()?;
        Some(Bodies {
            set: &set.bodies,
            gravity: Vec3::ZERO,
        })
    }
}
