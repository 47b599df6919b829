//! Writes what an element remembers back into its row.

use crate::scene::kept::Memory;
use crate::scene::rows::ElementRow;

impl Memory {
    pub(crate) fn put(&self, row: &mut ElementRow) {
        row.set_direction(self.direction);
        row.length = self.length;
        let rare = &mut *row.rare;
        rare.serial = self.serial;
        rare.set_controller(self.controller);
        rare.places = self.places;
        rare.leapt = self.leapt;
        rare.angle = self.angle;
        rare.set_facings(self.facings);
        rare.scales = self.scales.map(|scale| Some(scale?.as_vec3()));
        rare.jump = self.jump;
    }
}
