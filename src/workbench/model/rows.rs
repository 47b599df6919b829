//! The list of all elements, with search and order. It stays cheap with thousands of elements.

use crate::readout::SpringReadout;
use bevy::prelude::Entity;

/// Order of the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Order {
    #[default]
    Name,
    Force,
    OmegaDt,
    Energy,
}

/// One element in the list.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub entity: Entity,
    pub label: String,
    /// Label in lower case, for the search.
    lower: String,
    /// Force of spring and damper, N; for a torsion element the moment, N m.
    pub force: f32,
    /// Phase per engine step, rad.
    pub omega_dt: f32,
    /// Stored energy, J.
    pub energy: f32,
}

impl Row {
    pub fn new(entity: Entity, label: String) -> Self {
        Self {
            entity,
            lower: label.to_lowercase(),
            label,
            force: 0.0,
            omega_dt: 0.0,
            energy: 0.0,
        }
    }

    pub fn read(&mut self, readout: &SpringReadout) {
        self.force = readout.force();
        self.omega_dt = readout.omega_dt;
        self.energy = readout.stored_energy;
    }

    fn key(&self, order: Order) -> f32 {
        match order {
            Order::Name => 0.0,
            Order::Force => self.force.abs(),
            Order::OmegaDt => self.omega_dt,
            Order::Energy => self.energy,
        }
    }
}

/// All elements, and the selection that is shown.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    all: Vec<Row>,
    /// Indices into `all` of the rows that are shown, in their order.
    shown: Vec<u32>,
    pub search: String,
    pub order: Order,
    /// Index in `all` at which the next refresh continues.
    next: usize,
}

impl Rows {
    /// Replaces the set of elements.
    pub fn replace(&mut self, mut all: Vec<Row>) {
        all.sort_by(|a, b| a.lower.cmp(&b.lower).then(a.entity.cmp(&b.entity)));
        self.all = all;
        self.next = 0;
        self.arrange();
    }

    /// Applies search and order.
    pub fn arrange(&mut self) {
        let sought = self.search.trim().to_lowercase();
        let all = &self.all;
        let fits = |row: &Row| sought.is_empty() || row.lower.contains(&sought);
        // Rows that were shown before come first, in their old order: sorting a nearly sorted list is cheap.
        let mut is_shown = vec![false; all.len()];
        self.shown.retain(|i| {
            let there = all.get(*i as usize).is_some_and(fits);
            if there {
                is_shown[*i as usize] = true;
            }
            there
        });
        let new = all.iter().zip(0..).filter(|(row, _)| fits(row));
        self.shown
            .extend(new.map(|(_, i)| i).filter(|i| !is_shown[*i as usize]));
        if self.order == Order::Name {
            self.shown.sort_unstable();
        } else {
            let key = |i: &u32| all[*i as usize].key(self.order);
            self.shown
                .sort_by(|a, b| key(b).total_cmp(&key(a)).then(a.cmp(b)));
        }
    }

    /// Returns the rows to refresh in this call. Every row has its turn within `calls` calls.
    pub fn due(&mut self, calls: usize) -> &mut [Row] {
        let count = self.all.len().div_ceil(calls.max(1));
        let from = if self.next < self.all.len() {
            self.next
        } else {
            0
        };
        let to = (from + count).min(self.all.len());
        self.next = to;
        &mut self.all[from..to]
    }

    pub fn len(&self) -> usize {
        self.shown.len()
    }

    pub fn total(&self) -> usize {
        self.all.len()
    }

    /// Returns a row by its position among the shown rows.
    pub fn get(&self, shown: usize) -> Option<&Row> {
        self.all.get(*self.shown.get(shown)? as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Rows {
        let mut rows = Rows::default();
        let names = ["Left wheel", "Right wheel", "Lamp"];
        rows.replace(
            names
                .into_iter()
                .zip(1..)
                .map(|(name, i)| {
                    let entity = Entity::from_raw_u32(i).expect("a number of an entity");
                    let mut row = Row::new(entity, name.into());
                    row.force = -(i as f32);
                    row
                })
                .collect(),
        );
        rows
    }

    fn labels(rows: &Rows) -> Vec<&str> {
        (0..rows.len())
            .filter_map(|i| Some(rows.get(i)?.label.as_str()))
            .collect()
    }

    #[test]
    fn it_is_searched_whatever_the_case() {
        let mut rows = rows();
        assert_eq!(labels(&rows), ["Lamp", "Left wheel", "Right wheel"]);
        rows.search = " WHEEL".into();
        rows.arrange();
        assert_eq!(labels(&rows), ["Left wheel", "Right wheel"]);
        rows.search.clear();
        rows.arrange();
        assert_eq!(labels(&rows), ["Lamp", "Left wheel", "Right wheel"]);
    }

    #[test]
    fn the_strongest_comes_first() {
        let mut rows = rows();
        rows.order = Order::Force;
        rows.arrange();
        assert_eq!(labels(&rows), ["Lamp", "Right wheel", "Left wheel"]);
    }

    #[test]
    fn all_have_their_turn() {
        let mut rows = rows();
        let seen: usize = (0..2).map(|_| rows.due(2).len()).sum();
        assert_eq!(seen, 3);
        assert_eq!(rows.due(2).len(), 2);
        assert!(Rows::default().due(4).is_empty());
    }
}
