//! State shared by model and view: what is shown, and the requests of the view.

use super::model::facts::Subject;
use super::model::history::{Edit, History};
use super::model::like::is_like;
use super::model::preset;
use super::model::record::{Record, Sample};
use super::model::rows::Rows;
use super::model::snapshot::Snapshot;
use bevy::prelude::*;

/// A request of the view that the view cannot carry out itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ask {
    Pause(bool),
    Step,
    Speed(f32),
    /// Copies a text to the clipboard. The second field names its format for the message.
    Copy(String, &'static str),
    /// Pastes the clipboard into the chosen element.
    Paste,
    /// Writes a table of the record to a file.
    Csv(String),
    Picture,
    /// Saves a preset: its name and its text.
    Save(String, String),
    Load(String),
}

/// Which plots are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Plots {
    #[default]
    Time,
    Law,
}

/// State of the game's virtual clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    pub paused: bool,
    pub speed: f32,
    /// Whether the springs are in a schedule of fixed ticks, one of which can be run alone.
    pub steps: bool,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            paused: false,
            speed: 1.0,
            steps: true,
        }
    }
}

/// Everything that the view shows or changes.
#[derive(Resource, Default)]
pub(crate) struct Bench {
    pub rows: Rows,
    pub selected: Option<Entity>,
    /// Element that was clicked in the scene in this frame.
    pub picked: Option<Entity>,
    pub subject: Option<Subject>,
    pub history: History,
    pub record: Record,
    pub clock: Clock,
    /// Key with which the mouse pulls bodies; `None` for no pulling.
    pub grab: Option<KeyCode>,
    /// Time in the record that is shown, s; `None` for the present.
    pub scrub: Option<f64>,
    pub plots: Plots,
    /// Name for the next preset to save.
    pub preset_name: String,
    /// Names of the saved presets.
    pub presets: Vec<String>,
    /// Result of the last command, for the user.
    pub message: Option<String>,
    pub asks: Vec<Ask>,
    /// Edits that wait for the next tick: the element, its numbers before and its numbers after. Only numbers that
    /// differ between the two are written.
    pub pending: Vec<(Entity, Snapshot, Snapshot)>,
}

impl Bench {
    /// Chooses an element, or none. A new choice clears the record.
    pub fn select(&mut self, entity: Option<Entity>) {
        if self.selected != entity {
            self.selected = entity;
            self.subject = None;
            self.record.clear();
            self.scrub = None;
            self.history.close();
        }
    }

    /// Changes the chosen element. `what` names the change for the undo button.
    pub fn edit(&mut self, what: &'static str, after: Snapshot) {
        let Some(subject) = &self.subject else {
            return;
        };
        if is_like(&subject.now, &after) {
            return;
        }
        let (entity, before) = (subject.entity, subject.now.clone());
        let title = subject.title.clone();
        self.carry(entity, before.clone(), after.clone());
        self.history.note(Edit {
            entity,
            title,
            what,
            before,
            after,
        });
    }

    /// Undoes the last edit.
    pub fn undo(&mut self) {
        if let Some(edit) = self.history.undo() {
            self.message = Some(format!("{}: {} is as before", edit.title, edit.what));
            self.carry(edit.entity, edit.after, edit.before);
        }
    }

    /// Redoes the edit that was undone last.
    pub fn redo(&mut self) {
        if let Some(edit) = self.history.redo() {
            self.message = Some(format!("{}: {} is changed again", edit.title, edit.what));
            self.carry(edit.entity, edit.before, edit.after);
        }
    }

    /// Resets the chosen element: takes back all of its edits that are kept. What the game itself changed meanwhile stays.
    pub fn reset(&mut self) {
        let Some(subject) = &self.subject else {
            return;
        };
        if let Some(original) = self.history.without(subject.entity, &subject.now) {
            self.history.close();
            self.edit("all numbers", original);
            self.history.close();
        }
    }

    /// Loads a preset into the chosen element.
    pub fn load(&mut self, name: &str, text: &str) {
        let Some(subject) = &self.subject else {
            return;
        };
        match preset::apply(text, &subject.now) {
            Ok(after) => {
                self.history.close();
                self.edit("all numbers", after);
                self.history.close();
                self.message = Some(format!("loaded {name}"));
            }
            Err(wrong) => self.message = Some(format!("{name}: {wrong}")),
        }
    }

    fn carry(&mut self, entity: Entity, from: Snapshot, to: Snapshot) {
        if let Some(subject) = &mut self.subject
            && subject.entity == entity
        {
            subject.now.carry(&from, &to);
        }
        // A drag makes one change per frame. While the game is paused the changes would pile up, so they are merged.
        if let Some((last, _, until)) = self.pending.last_mut()
            && *last == entity
            && is_like(&*until, &from)
        {
            *until = to;
        } else {
            self.pending.push((entity, from, to));
        }
    }

    /// Returns the numbers of an element as they will be after all pending edits.
    pub fn with_pending(&self, entity: Entity, mut snapshot: Snapshot) -> Snapshot {
        for (of, from, to) in &self.pending {
            if *of == entity {
                snapshot.carry(from, to);
            }
        }
        snapshot
    }

    /// Returns the sample that is shown: at the chosen time of the record, or the present one.
    pub fn sample(&self) -> Option<Sample> {
        if let Some(time) = self.scrub {
            return self.record.at(time).copied();
        }
        let readout = self.subject.as_ref()?.facts.readout;
        let time = self.record.span().map_or(0.0, |[_, last]| last);
        Some(Sample { time, readout })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workbench::model::verdict::tests::scene;

    #[test]
    fn edits_of_an_element_with_a_nan_do_not_pile_up_while_the_game_is_paused() {
        let (mut now, facts) = scene();
        if let Some(stiffness) = now.part.stiffness_mut() {
            *stiffness = f32::NAN;
        }
        let subject = Subject {
            entity: Entity::PLACEHOLDER,
            title: String::new(),
            now: now.clone(),
            facts,
        };
        let mut bench = Bench {
            subject: Some(subject),
            ..Bench::default()
        };
        // The view does this in a frame without user input.
        bench.edit("a number", now.clone());
        assert_eq!(bench.history.next(), [None, None]);
        assert!(bench.pending.is_empty());
        // One drag over ten frames.
        for step in 1..=10 {
            if let Some(damping) = now.part.damping_mut() {
                *damping = 10.0 * step as f32;
            }
            bench.edit("a number", now.clone());
        }
        assert_eq!(bench.pending.len(), 1);
        bench.undo();
        assert_eq!(bench.history.next(), [None, Some("a number")]);
        let damping = |bench: &Bench| bench.subject.as_ref()?.now.part.damping();
        assert_eq!(damping(&bench), Some(5.0));
    }
}
