//! The edits, for undo and redo.

use super::snapshot::Snapshot;
use bevy::prelude::Entity;

/// Greatest number of edits that are kept.
const MOST: usize = 200;

/// One edit of one element.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edit {
    pub entity: Entity,
    /// Title of the element, for messages.
    pub title: String,
    pub what: &'static str,
    pub before: Snapshot,
    pub after: Snapshot,
}

/// Edits that were done, and edits that were undone.
#[derive(Debug, Default)]
pub(crate) struct History {
    done: Vec<Edit>,
    undone: Vec<Edit>,
    /// Whether the last edit is still in progress, as while a number is dragged.
    open: bool,
}

impl History {
    /// Adds an edit. While a drag is in progress, its changes are merged into one edit. What the game itself changed
    /// meanwhile is no part of that edit.
    pub fn note(&mut self, edit: Edit) {
        self.undone.clear();
        if self.open
            && let Some(last) = self.done.last_mut()
            && last.entity == edit.entity
            && last.what == edit.what
        {
            last.after.carry(&edit.before, &edit.after);
            return;
        }
        if self.done.len() == MOST {
            self.done.remove(0);
        }
        self.done.push(edit);
        self.open = true;
    }

    /// Ends the edit in progress: the next change is a new edit.
    pub fn close(&mut self) {
        self.open = false;
    }

    /// Moves the last edit to the undone ones, and returns it.
    pub fn undo(&mut self) -> Option<Edit> {
        self.open = false;
        let edit = self.done.pop()?;
        self.undone.push(edit.clone());
        Some(edit)
    }

    /// Moves the last undone edit back, and returns it.
    pub fn redo(&mut self) -> Option<Edit> {
        self.open = false;
        let edit = self.undone.pop()?;
        self.done.push(edit.clone());
        Some(edit)
    }

    /// Returns the names of the edits that the next undo and the next redo affect.
    pub fn next(&self) -> [Option<&'static str>; 2] {
        [&self.done, &self.undone].map(|edits| edits.last().map(|edit| edit.what))
    }

    /// Whether there is an edit of an element.
    pub fn has(&self, entity: Entity) -> bool {
        self.done.iter().any(|edit| edit.entity == entity)
    }

    /// Returns the numbers that an element would have without its edits. `now` are its present numbers. `None` if it has no
    /// edits.
    pub fn without(&self, entity: Entity, now: &Snapshot) -> Option<Snapshot> {
        self.has(entity).then(|| {
            let mut out = now.clone();
            for edit in self.done.iter().rev().filter(|edit| edit.entity == entity) {
                out.carry(&edit.after, &edit.before);
            }
            out
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Preload, Spring};
    use crate::workbench::model::snapshot::Part;

    fn of(stiffness: f32) -> Snapshot {
        let [a, b] = [1, 2].map(|i| Entity::from_raw_u32(i).expect("a number of an entity"));
        Snapshot::new(Part::Spring(Spring::new(a, b).with_stiffness(stiffness)))
    }

    fn edit(before: f32, after: f32) -> Edit {
        Edit {
            entity: Entity::PLACEHOLDER,
            title: String::new(),
            what: "stiffness",
            before: of(before),
            after: of(after),
        }
    }

    #[test]
    fn a_drag_is_one_edit() {
        let mut history = History::default();
        history.note(edit(1.0, 2.0));
        history.note(edit(2.0, 3.0));
        history.close();
        history.note(edit(3.0, 4.0));
        let original = history.without(Entity::PLACEHOLDER, &of(4.0));
        assert_eq!(original, Some(of(1.0)));
        assert_eq!(history.undo(), Some(edit(3.0, 4.0)));
        assert_eq!(history.undo(), Some(edit(1.0, 3.0)));
        assert_eq!(history.undo(), None);
        assert_eq!(history.redo(), Some(edit(1.0, 3.0)));
        history.note(edit(3.0, 9.0));
        assert_eq!(history.next(), [Some("stiffness"), None]);
    }

    #[test]
    fn what_the_game_changes_during_a_drag_is_neither_undone_nor_redone() {
        let preloaded = |stiffness| Snapshot {
            preload: Some(Preload(5.0)),
            ..of(stiffness)
        };
        let mut history = History::default();
        history.note(edit(1.0, 2.0));
        // The game has added a preload.
        history.note(Edit {
            before: preloaded(2.0),
            after: preloaded(3.0),
            ..edit(2.0, 3.0)
        });
        let mut now = preloaded(3.0);
        let original = history.without(Entity::PLACEHOLDER, &now);
        assert_eq!(original, Some(preloaded(1.0)));
        let undone = history.undo().expect("an edit");
        now.carry(&undone.after, &undone.before);
        assert_eq!(now, preloaded(1.0));
        // And now it has removed it.
        now.preload = None;
        let redone = history.redo().expect("an edit");
        now.carry(&redone.before, &redone.after);
        assert_eq!(now, of(3.0));
    }

    #[test]
    fn it_does_not_grow_for_ever() {
        let mut history = History::default();
        for i in 0..1_000 {
            history.note(edit(i as f32, i as f32 + 1.0));
            history.close();
        }
        assert_eq!(std::iter::from_fn(|| history.undo()).count(), MOST);
    }
}
