//! Springs and Rapier under GGRS: a snapshot of each frame is kept, and restored when GGRS goes back.

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_ggrs::{
    GgrsSchedule, GgrsSnapshots, LoadWorld, LoadWorldSystems, RollbackFrameCount, SaveWorld,
    SaveWorldSystems,
};
use bevy_rapier3d::prelude::*;
use std::time::{Duration, Instant};

/// Schedule of one tick of Rapier and springs. It runs as often as GGRS asks for a frame.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Physics;

/// Set of the physics tick in `GgrsSchedule`. Systems that apply inputs run before it.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tick;

/// Runs Rapier and springs in GGRS's frames and makes them go back with it. Add it after `GgrsPlugin`.
#[derive(Clone, Copy, Debug)]
pub struct RollbackPhysicsPlugin {
    /// Whether springs are restored too. Without that the future differs: a test shows it.
    pub springs: bool,
    /// Frames per second.
    pub rate: u16,
}

/// Snapshots of a frame.
struct Kept {
    engine: RapierSnapshot,
    springs: CoiloverSnapshot,
}

/// Counts and total times of snapshots and ticks.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Cost {
    /// Number of snapshots taken.
    pub saved: u32,
    /// Total time of taking snapshots.
    pub saving: Duration,
    /// Number of snapshots restored.
    pub loaded: u32,
    /// Total time of restoring snapshots.
    pub loading: Duration,
    /// Number of ticks.
    pub ticked: u32,
    /// Total time of ticks.
    pub ticking: Duration,
}

/// Whether springs are restored.
#[derive(Resource, Clone, Copy)]
struct WithSprings(bool);

impl Default for RollbackPhysicsPlugin {
    fn default() -> Self {
        Self {
            springs: true,
            rate: 60,
        }
    }
}

impl Plugin for RollbackPhysicsPlugin {
    fn build(&self, app: &mut App) {
        app.init_schedule(Physics)
            .insert_resource(TimestepMode::Fixed {
                dt: f32::from(self.rate).recip(),
                substeps: 1,
            })
            .insert_resource(WithSprings(self.springs))
            .init_resource::<Cost>()
            .add_plugins((
                RapierPhysicsPlugin::<NoUserData>::default().in_schedule(Physics),
                CoiloverPlugin::new(Physics),
            ))
            // A tick before the first frame, because Rapier creates bodies in its first tick. Without it, that frame's
            // snapshot has no bodies.
            .add_systems(PostStartup, tick)
            .add_systems(GgrsSchedule, tick.in_set(Tick))
            .init_resource::<GgrsSnapshots<Kept>>()
            .add_systems(
                SaveWorld,
                (
                    GgrsSnapshots::<Kept>::sync_depth,
                    GgrsSnapshots::<Kept>::discard_old_snapshots,
                    save,
                )
                    .chain()
                    .in_set(SaveWorldSystems::Snapshot),
            )
            // After the game's own components, which springs read.
            .add_systems(LoadWorld, load.after(LoadWorldSystems::Mapping));
    }
}

fn tick(world: &mut World) {
    let start = Instant::now();
    world.run_schedule(Physics);
    let mut cost = world.resource_mut::<Cost>();
    cost.ticked += 1;
    cost.ticking += start.elapsed();
}

fn save(world: &mut World) {
    let start = Instant::now();
    let frame = world.resource::<RollbackFrameCount>().0;
    let kept = Kept {
        engine: RapierSnapshot::take(world),
        springs: CoiloverSnapshot::take(world),
    };
    world
        .resource_mut::<GgrsSnapshots<Kept>>()
        .push(frame, kept);
    let mut cost = world.resource_mut::<Cost>();
    cost.saved += 1;
    cost.saving += start.elapsed();
}

fn load(world: &mut World) -> Result {
    let start = Instant::now();
    let frame = world.resource::<RollbackFrameCount>().0;
    let with_springs = world.resource::<WithSprings>().0;
    world.resource_scope(|world, mut snapshots: Mut<GgrsSnapshots<Kept>>| {
        let kept = snapshots.rollback(frame).get();
        kept.engine.restore(world)?;
        match with_springs {
            true => kept.springs.restore(world),
            false => Ok(()),
        }
    })?;
    let mut cost = world.resource_mut::<Cost>();
    cost.loaded += 1;
    cost.loading += start.elapsed();
    Ok(())
}
