//! Takes the free components of a context through the step: those that neither contacts nor joints hold. The engine is written to
//! only after all of them are read and solved.

use crate::backend::{Engine, Sight};
use crate::dynamics::step::Copies;
use crate::scene::assembly::Assembly;
use crate::scene::lone::{self, Lone, Piece, Route, Way, Worker};
use crate::scene::rows::Cut;
use crate::scene::runs::{Runs, WORTH_SHARING};
use crate::scene::state::Scene;
use crate::scene::step::Step;
use crate::threads;
use bevy::prelude::Entity;
use std::mem::take;

/// Buffers that are reused from step to step.
#[derive(Default)]
pub(crate) struct Spare {
    workers: Vec<Worker>,
    /// Result of each lone element.
    ways: Vec<Way>,
    /// Assemblies of the lone elements that need the general solver in this step.
    general: Vec<Assembly>,
    /// Group index of each assembly in `general` that is in use.
    groups: Vec<u32>,
    runs: Runs,
    /// For each piece of work, memory that its assemblies share.
    copies: Vec<Copies>,
    /// Memory that the assemblies in `general` share.
    general_copies: Copies,
}

impl Scene {
    /// Takes all free components of a context through the step. Returns whether all of them are asleep.
    pub(crate) fn step_free(
        &mut self,
        context: Entity,
        step: &Step,
        engine: &mut impl Engine,
        spare: &mut Spare,
    ) -> bool {
        let lone = self.lone.iter().position(|lone| lone.context == context);
        // Read. Lone elements are solved here, too.
        let networks_asleep = self.gather_networks(context, step, engine, &mut spare.runs);
        let lone_asleep = lone.is_none_or(|lone| self.solve_lone(lone, step, engine, spare));
        let general = self.gather_general(lone, step, engine, spare);
        // Solve.
        self.noting |= general > 0 || !self.assemblies.is_empty();
        let accuracy = step.accuracy.shared(general);
        for assembly in &mut spare.general[..general] {
            assembly.advance(step, accuracy, &mut spare.general_copies);
        }
        advance(&mut self.assemblies, step, &mut spare.copies);
        // Write.
        let (elements, bodies) = (&mut self.elements, &mut self.bodies);
        if let Some(lone) = lone {
            let lone = &self.lone[lone];
            self.touch_changed |= lone.deliver(step, &spare.ways, elements, bodies, engine);
        }
        let groups = &self.groups;
        for (group, assembly) in spare.groups.iter().zip(&mut spare.general) {
            let members = groups.members(&groups.list()[*group as usize]);
            assembly.deliver(step, &members, elements, bodies, engine);
            assembly.forget();
        }
        for assembly in &mut self.assemblies {
            let group = &groups.list()[assembly.group];
            if group.is_free(context) {
                let members = groups.members(group);
                assembly.deliver(step, &members, elements, bodies, engine);
            }
        }
        self.promote(lone, &spare.ways);
        networks_asleep && lone_asleep
    }

    /// Reads the components that have an assembly. Returns whether all of them are asleep.
    fn gather_networks(
        &mut self,
        context: Entity,
        step: &Step,
        sight: &impl Sight,
        runs: &mut Runs,
    ) -> bool {
        let groups = &self.groups;
        runs.find(&self.assemblies, groups);
        let (elements, bodies) = (&mut self.elements, &mut self.bodies);
        let pieces = runs.cut(&mut self.assemblies, Cut::all(elements), Cut::all(bodies));
        threads::share(pieces, |(assemblies, mut elements, mut bodies)| {
            for assembly in assemblies {
                let group = &groups.list()[assembly.group];
                if group.is_free(context) {
                    let members = groups.members(group);
                    assembly.gather(step, &members, &mut elements, &mut bodies, sight);
                }
            }
        });
        let mut all_asleep = true;
        for assembly in &mut self.assemblies {
            if groups.list()[assembly.group].is_free(context) {
                all_asleep &= assembly.is_asleep();
                self.touch_changed |= take(&mut assembly.touch_changed);
                self.stale |= take(&mut assembly.stale);
            }
        }
        all_asleep
    }

    /// Reads and solves lone elements. Returns whether all of them are asleep.
    fn solve_lone(
        &mut self,
        lone: usize,
        step: &Step,
        sight: &impl Sight,
        spare: &mut Spare,
    ) -> bool {
        let lone = &self.lone[lone].pairs;
        // Every entry gets a new route below.
        spare.ways.resize(lone.len(), Way::default());
        let each = threads::piece_of(lone.len(), lone.len() >= lone::WORTH_SHARING);
        let count = lone.len().div_ceil(each).max(1);
        spare.workers.resize_with(count, Worker::default);
        let bodies = &self.bodies;
        let mut rows = Cut::all(&mut self.elements);
        let parts = lone.chunks(each).zip(spare.ways.chunks_mut(each));
        let parts = parts.zip(&mut spare.workers).map(|((lone, ways), worker)| {
            let end = lone.last().map_or(0, |last| last.element as usize + 1);
            let piece = Piece {
                lone,
                rows: rows.take_before(end),
                bodies,
                ways,
                sight,
            };
            (worker, piece)
        });
        threads::share(parts, |(worker, piece)| worker.solve(step, piece));
        self.stale |= spare.workers.iter().any(|worker| worker.stale);
        let mut routes = spare.ways.iter().map(|way| way.route);
        routes.all(|route| matches!(route, Route::Asleep | Route::None))
    }

    /// Reads the lone elements that need the general solver in this step. Returns their number.
    fn gather_general(
        &mut self,
        lone: Option<usize>,
        step: &Step,
        sight: &impl Sight,
        spare: &mut Spare,
    ) -> usize {
        spare.groups.clear();
        let Some(lone) = lone.map(|lone| &self.lone[lone].pairs) else {
            return 0;
        };
        let general = |way: &Way| matches!(way.route, Route::General | Route::GeneralOnce);
        let ways = lone.iter().zip(&spare.ways);
        for (pair, _) in ways.filter(|(_, way)| general(way)) {
            let Some(group) = pair.group(&self.bodies) else {
                continue;
            };
            let at = spare.groups.len();
            spare.groups.push(group);
            if spare.general.len() == at {
                spare.general.push(Assembly::default());
            }
            let members = self.groups.members(&self.groups.list()[group as usize]);
            let (elements, bodies) = (&mut self.elements, &mut self.bodies);
            let assembly = &mut spare.general[at];
            let (elements, bodies) = (&mut Cut::all(elements), &mut Cut::all(bodies));
            assembly.gather(step, &members, elements, bodies, sight);
            self.touch_changed |= take(&mut assembly.touch_changed);
            self.stale |= take(&mut assembly.stale);
        }
        spare.groups.len()
    }

    /// Gives an assembly to each lone element that will need the general solver in later steps, too.
    fn promote(&mut self, lone: Option<usize>, ways: &[Way]) {
        let Some(Lone { pairs, .. }) = lone.map(|lone| &mut self.lone[lone]) else {
            return;
        };
        if ways.iter().all(|way| way.route != Route::General) {
            return;
        }
        let mut ways = ways.iter();
        pairs.retain(|pair| {
            let stays = ways.next().is_none_or(|way| way.route != Route::General);
            if !stays && let Some(group) = pair.group(&self.bodies) {
                self.groups.promote(group as usize, &mut self.assemblies);
            }
            stays
        });
    }
}

/// Integrates all assemblies, on several threads if there is enough work. They share no data, so the number
/// of threads does not change the result.
fn advance(assemblies: &mut [Assembly], step: &Step, copies: &mut Vec<Copies>) {
    if assemblies.is_empty() {
        return;
    }
    let load: usize = assemblies.iter().map(Assembly::load).sum();
    let accuracy = step.accuracy.shared(load);
    let ready = assemblies.iter().filter(|a| a.load() > 0).count();
    let is_worth_it = ready > 1 && load >= WORTH_SHARING;
    let each = threads::piece_of(assemblies.len(), is_worth_it);
    let pieces = assemblies.chunks_mut(each);
    copies.resize_with(copies.len().max(pieces.len()), Copies::default);
    threads::share(pieces.zip(copies), |(assemblies, copies)| {
        // Several threads must not write to neighbours in memory again and again.
        let mut own = take(copies);
        for assembly in assemblies {
            assembly.advance(step, accuracy, &mut own);
        }
        *copies = own;
    });
}
