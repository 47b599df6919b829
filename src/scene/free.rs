//! The components of a context that nothing but elements holds, through the step.

use crate::backend::Engine;
use crate::scene::assembly::Assembly;
use crate::scene::lone::{BATCH, Batch, Route};
use crate::scene::prefetch::prefetch;
use crate::scene::state::Scene;
use crate::scene::step::Step;
use bevy::prelude::Entity;
use bevy::tasks::ComputeTaskPool;
use std::num::NonZeroUsize;
use std::sync::LazyLock;
use std::thread::available_parallelism;

/// Elements in networks that are about to be solved, above which it is worth waking other threads, and the few
/// allocations that this takes: the only ones of a warm step.
const WORTH_SHARING: usize = 256;

/// More threads than these would only wait for each other.
static CORES: LazyLock<usize> =
    LazyLock::new(|| available_parallelism().map_or(1, NonZeroUsize::get));

/// Room for the work of a step.
#[derive(Default)]
pub(crate) struct Spare {
    batch: Batch,
    /// What lone elements are assembled in that need the general solver.
    assembly: Assembly,
    /// Groups that need the general solver in this step.
    general_once: Vec<usize>,
    /// Groups that need it for as long as can be seen.
    general: Vec<usize>,
}

impl Scene {
    /// Takes every component of a context that is not held through the step; says whether all of them are asleep.
    pub(crate) fn step_free(
        &mut self,
        context: Entity,
        step: &Step,
        engine: &mut impl Engine,
        spare: &mut Spare,
    ) -> bool {
        // First, so that what touches them is read as the engine has left it, whatever lone elements there are.
        let networks_asleep = self.gather_networks(context, step, engine);
        let lone_asleep = self.step_lone(context, step, engine, spare);
        self.step_general(step, engine, spare);
        advance(&mut self.assemblies, step);
        self.deliver_networks(context, step, engine);
        for group in spare.general.drain(..) {
            self.groups.promote(group, &mut self.assemblies);
        }
        networks_asleep && lone_asleep
    }

    /// Reads what is solved in an assembly of its own; says whether all of that is asleep.
    fn gather_networks(&mut self, context: Entity, step: &Step, engine: &mut impl Engine) -> bool {
        let mut all_asleep = true;
        for group in self.groups.list().iter().filter(|g| g.is_free(context)) {
            if let Some(index) = group.assembly {
                let (members, assembly) = (self.groups.members(group), &mut self.assemblies[index]);
                let (elements, bodies) = (&mut self.elements, &mut self.bodies);
                assembly.gather(step, &members, elements, bodies, engine, &mut self.stale);
                all_asleep &= assembly.is_asleep();
            }
        }
        all_asleep
    }

    /// Takes lone elements through the step, a batch at a time; says whether all of them are asleep.
    fn step_lone(
        &mut self,
        context: Entity,
        step: &Step,
        engine: &mut impl Engine,
        spare: &mut Spare,
    ) -> bool {
        let Self {
            elements,
            bodies,
            groups,
            stale,
            ..
        } = self;
        let Spare {
            batch,
            general_once,
            general,
            ..
        } = spare;
        let mut all_asleep = true;
        for g in 0..groups.list().len() {
            if g % BATCH == 0 {
                prefetch(groups, g, elements, bodies, engine);
            }
            let group = &groups.list()[g];
            if group.assembly.is_some() || !group.is_free(context) {
                continue;
            }
            let sleeps = |body| engine.see(body).is_some_and(|body| body.is_asleep);
            if let (true, Some(handles)) = (step.quiet, group.dozing)
                && handles.into_iter().all(sleeps)
            {
                continue;
            }
            let members = groups.members(group);
            let route = step.gather_lone(batch, g, &members, elements, bodies, engine, stale);
            let mut dozing = None;
            all_asleep &= matches!(route, Route::Asleep(_));
            match route {
                Route::Asleep(handles) => dozing = handles,
                Route::GeneralOnce => general_once.push(g),
                Route::General => general.push(g),
                Route::Batched | Route::Gone => {}
            }
            groups.at(g).dozing = dozing;
            if batch.is_full() {
                step.scatter(batch, elements, bodies, engine, general_once);
            }
        }
        step.scatter(batch, elements, bodies, engine, general_once);
        all_asleep
    }

    /// Takes lone elements through the step that need the general solver.
    fn step_general(&mut self, step: &Step, engine: &mut impl Engine, spare: &mut Spare) {
        let all = spare.general_once.len() + spare.general.len();
        let accuracy = step.accuracy.shared(all);
        let once = spare.general_once.drain(..);
        for g in once.chain(spare.general.iter().copied()) {
            let members = self.groups.members(&self.groups.list()[g]);
            let (elements, bodies) = (&mut self.elements, &mut self.bodies);
            let assembly = &mut spare.assembly;
            assembly.gather(step, &members, elements, bodies, engine, &mut self.stale);
            assembly.advance(step, accuracy);
            assembly.deliver(step, &members, elements, bodies, engine);
            assembly.forget();
        }
    }

    /// Gives the engine what takes the bodies of networks on.
    fn deliver_networks(&mut self, context: Entity, step: &Step, engine: &mut impl Engine) {
        for group in self.groups.list().iter().filter(|g| g.is_free(context)) {
            if let Some(index) = group.assembly {
                let (elements, bodies) = (&mut self.elements, &mut self.bodies);
                let members = self.groups.members(group);
                self.assemblies[index].deliver(step, &members, elements, bodies, engine);
            }
        }
    }
}

/// Integrates all assemblies, on several threads where that is worth it; each is on its own, so the
/// result is the same.
fn advance(assemblies: &mut [Assembly], step: &Step) {
    let load: usize = assemblies.iter().map(Assembly::load).sum();
    let accuracy = step.accuracy.shared(load);
    // The one that waits for the pool works too: on two cores the pool has just one.
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    let threads = CORES.min(pool + 1);
    let ready = assemblies.iter().filter(|a| a.load() > 0).count();
    let advance = |assemblies: &mut [Assembly]| {
        for assembly in assemblies {
            assembly.advance(step, accuracy);
        }
    };
    if threads < 2 || ready < 2 || load < WORTH_SHARING {
        return advance(assemblies);
    }
    let chunk = assemblies.len().div_ceil(4 * threads);
    let advance = &advance;
    ComputeTaskPool::get().scope(|scope| {
        for chunk in assemblies.chunks_mut(chunk) {
            scope.spawn(async move { advance(chunk) });
        }
    });
}
