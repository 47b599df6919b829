//! Finds the row of a body by its handle in the engine.

use crate::backend::BodyId;
use crate::scene::rows::BodyRow;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::Entity;

/// Index that stands for no row.
const NONE: u32 = u32::MAX;

/// For each context, a list of row indices: that of a body is at the index of the body in the engine. An engine numbers its bodies
/// from zero and fills gaps, so the list takes a tenth of the memory of a hash map.
#[derive(Default)]
pub(crate) struct Handles(EntityHashMap<Vec<u32>>);

impl Handles {
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// Notes the row index of a body.
    pub(crate) fn insert(&mut self, context: Entity, body: BodyId, row: u32) {
        let rows = self.0.entry(context).or_default();
        let index = body.index as usize;
        if rows.len() <= index {
            rows.resize(index + 1, NONE);
        }
        rows[index] = row;
    }

    /// The row of a body among `rows`.
    pub(crate) fn row<'a>(
        &self,
        context: Entity,
        body: BodyId,
        rows: &'a [BodyRow],
    ) -> Option<&'a BodyRow> {
        let row = *self.0.get(&context)?.get(body.index as usize)?;
        // An earlier body may have had the same index.
        rows.get(row as usize).filter(|row| row.id == body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_found_in_its_own_context_and_generation() {
        let ids = [4, 1].map(|index| BodyId {
            index,
            generation: 7,
        });
        let context = Entity::PLACEHOLDER;
        let rows = ids.map(|id| BodyRow::new(Entity::PLACEHOLDER, id, context));
        let mut handles = Handles::default();
        for (row, id) in ids.into_iter().enumerate() {
            handles.insert(context, id, row as u32);
        }
        for id in ids {
            let found = handles.row(context, id, &rows);
            assert_eq!(found.map(|row| row.id), Some(id));
            let later = BodyId {
                generation: 8,
                ..id
            };
            assert!(handles.row(context, later, &rows).is_none());
        }
        let between = BodyId { index: 2, ..ids[0] };
        assert!(handles.row(context, between, &rows).is_none());
        handles.clear();
        assert!(handles.row(context, ids[0], &rows).is_none());
    }
}
