//! Runs a planned scene and returns what is wrong with it.

use crate::fault::{Fault, caught};
use crate::left::nothing_is_left;
use crate::numbers::{NOT_FINITE, are_finite};
use crate::plan::{Deed, Plan, Shape, TICKS};
use crate::springs::Springs;
use crate::stage::Stage;
use bevy_coilover::prelude::*;

/// Result of a scene.
#[derive(Debug, PartialEq)]
pub enum Verdict {
    /// Nothing is wrong.
    Sound,
    /// Something is wrong, and the engine fails in the same way without this crate, or fails because of the game's joints.
    Engines(Fault),
    /// Something is wrong only with this crate: a fault of this crate.
    Ours(Fault),
}

/// What runs with springs have met so far. Each tick counts again. A search that never meets one of these shows nothing
/// about it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Met {
    /// Elements that were solved.
    pub solved: u64,
    /// Joints of springs in the engine's solver.
    pub joints: u64,
    /// Bodies in the engine that stand for ends without a body.
    pub stand_ins: u64,
    /// Snapshots of the engine that were restored.
    pub engines_restored: u64,
    /// Snapshots of springs that were restored.
    pub springs_restored: u64,
}

impl Met {
    /// Names what was never met.
    pub fn missing(&self) -> Vec<&'static str> {
        let all = [
            (self.solved, "no element was solved"),
            (self.joints, "no spring was in the engine's solver"),
            (self.stand_ins, "no body stood for an end without one"),
            (self.engines_restored, "no snapshot of the engine fitted"),
            (self.springs_restored, "no snapshot of springs fitted"),
        ];
        let missing = all.into_iter().filter(|(met, _)| *met == 0);
        missing.map(|(_, name)| name).collect()
    }
}

/// Runs a scene. If something is wrong that the engine may have by itself, runs it in other ways that tell whose fault it is.
pub fn judge(plan: &Plan, met: &mut Met) -> Verdict {
    let Err(fault) = caught(|| play(plan, Springs::Ours, met)) else {
        return Verdict::Sound;
    };
    if fault.is_ours || !is_the_engines(plan, &fault) {
        return Verdict::Ours(fault);
    }
    Verdict::Engines(fault)
}

/// Whether the engine fails in the same way without this crate, or fails because of the game's joints (see docs/limits.md).
fn is_the_engines(plan: &Plan, fault: &Fault) -> bool {
    let is_alike = |plan: &Plan, springs| {
        let other = caught(|| play(plan, springs, &mut Met::default()));
        // Another fault does not explain this one.
        other.is_err_and(|other| other.kind == fault.kind)
    };
    // Snapshots are part of this crate, too: what they break is no fault of the engine.
    let without = Plan {
        goes_back: Vec::new(),
        ..plan.clone()
    };
    if is_alike(&without, Springs::None) || is_alike(&without, Springs::Engines) {
        return true;
    }
    let mut mended = plan.clone();
    let is_join = |deed: &Deed| matches!(deed, Deed::Join(..));
    let takes_collider =
        |deed: &Deed| matches!(deed, Deed::DespawnBody(_) | Deed::Reshape(_, Shape::None));
    if fault.kind == NOT_FINITE && plan.deeds.iter().any(|(_, deed)| is_join(deed)) {
        // A joint beside locked axes: the engine's equations for what both lock are rounding, and grow without bound.
        mended.bodies.iter_mut().for_each(|body| body.locks = 0);
    } else if fault.is_in_the_engine("interaction_groups.rs") {
        // A joint between bodies that cannot move, beside one that can. Joints of springs always hold one that can.
        mended.deeds.retain(|(_, deed)| !is_join(deed));
    } else if fault.is_in_the_engine("ccd/sweeps.rs") {
        // A fast body sweeps over a collider that is gone. Springs have no colliders.
        mended.deeds.retain(|(_, deed)| !takes_collider(deed));
    } else {
        return false;
    }
    !is_alike(&mended, Springs::Ours)
}

fn play(plan: &Plan, springs: Springs, met: &mut Met) -> Result<(), Fault> {
    let mut stage = Stage::new(plan, springs);
    let mut deeds = plan.deeds.clone();
    deeds.sort_by_key(|(tick, _)| *tick);
    let mut deeds = deeds.iter().peekable();
    let mut kept = vec![None; plan.goes_back.len()];
    let is_push = |(_, deed): &(u8, Deed)| matches!(deed, Deed::Push(..));
    // Whether all forces on bodies are of springs.
    let mut unpushed = !plan.deeds.iter().any(is_push);
    for tick in 0..TICKS {
        for ([_, back], kept) in plan.goes_back.iter().zip(&kept) {
            if *back == tick {
                unpushed &= go_back(&mut stage, kept, met);
            }
        }
        while let Some((_, deed)) = deeds.next_if(|(at, _)| *at == tick) {
            stage.act(deed);
        }
        stage.app.update();
        let finite = are_finite(stage.app.world_mut(), met);
        finite.map_err(|fault| fault.at(&format!("tick {tick}")))?;
        for ([taken, _], kept) in plan.goes_back.iter().zip(&mut kept) {
            if *taken == tick {
                *kept = Some(keep(&stage));
            }
        }
    }
    // Done without springs as well: a paused engine continues here, and may show its own faults only then.
    nothing_is_left(&mut stage, unpushed).map_err(|fault| fault.at("at the end"))
}

type Kept = (RapierSnapshot, CoiloverSnapshot);

fn keep(stage: &Stage) -> Kept {
    let world = stage.app.world();
    (RapierSnapshot::take(world), CoiloverSnapshot::take(world))
}

/// Restores a snapshot if it fits. Changes since it was taken may forbid that, and then nothing changes. Returns whether the
/// springs did not go back alone: then the forces of their later bodies stay in the engine, as in a jump by the game.
fn go_back(stage: &mut Stage, kept: &Option<Kept>, met: &mut Met) -> bool {
    let Some((engine, springs)) = kept else {
        return true;
    };
    let world = stage.app.world_mut();
    let [engine, springs] = [
        engine.restore(world).is_ok(),
        springs.restore(world).is_ok(),
    ];
    met.engines_restored += u64::from(engine);
    met.springs_restored += u64::from(springs);
    engine || !springs
}
