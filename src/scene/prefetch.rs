//! What lone elements need next comes from memory at once.

use crate::backend::Sight;
use crate::scene::group::{Group, Groups};
use crate::scene::lone::BATCH;
use crate::scene::rows::{BodyRow, ElementRow};
use std::hint::black_box;

/// Prefetches what the next batch needs: it is looked at in every line of memory where it lies, so that all of it
/// comes at once. Read one after the other, each would be waited for.
pub(crate) fn prefetch(
    groups: &Groups,
    next: usize,
    elements: &[ElementRow],
    bodies: &[BodyRow],
    sight: &impl Sight,
) {
    let mut seen = 0;
    let awake = |group: &&Group| group.assembly.is_none() && group.dozing.is_none();
    for group in groups.list()[next..].iter().take(BATCH).filter(awake) {
        let members = groups.members(group);
        for row in members.bodies.iter().map(|b| &bodies[*b]) {
            seen ^= row.user.force.x.to_bits();
            if let Some(body) = sight.see(row.id) {
                seen ^= body.origin.x.to_bits() ^ body.velocity.x.to_bits();
                seen ^= body.spin.x.to_bits() ^ body.inverse_mass.to_bits();
                seen ^= u32::from(body.is_locked) ^ u32::from(body.is_asleep);
                seen ^= body.more_substeps as u32;
            }
        }
        for row in members.elements.iter().map(|e| &elements[*e]) {
            seen ^= row.parameters.stiffness.to_bits() ^ row.outcome.microsteps;
            seen ^= row.memory.length.to_bits() as u32 ^ u32::from(row.on[0].is_some());
        }
    }
    // Or else the compiler would see that nobody asks for it.
    black_box(seen);
}
