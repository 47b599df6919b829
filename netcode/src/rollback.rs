//! Springs and Rapier under GGRS: what is kept of each frame, and put back.

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_ggrs::{
    GgrsSchedule, GgrsSnapshots, LoadWorld, LoadWorldSystems, RollbackFrameCount, SaveWorld,
    SaveWorldSystems,
};
use bevy_rapier3d::prelude::*;
use std::time::{Duration, Instant};

/// One tick of Rapier and of springs. GGRS asks for it, as often as it needs.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Physics;

/// Where the tick stands in `GgrsSchedule`: inputs act before it.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tick;

/// Runs Rapier and springs in GGRS's frames, and has them go back with it. Add it after `GgrsPlugin`.
#[derive(Clone, Copy, Debug)]
pub struct RollbackPhysicsPlugin {
    /// Whether springs are put back too. Without it the future is another: a test shows it.
    pub springs: bool,
    /// Frames per second.
    pub rate: u16,
}

/// What is kept of a frame.
struct Kept {
    engine: RapierSnapshot,
    springs: CoiloverSnapshot,
}

/// How often things were done, and how long they took together.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Cost {
    /// Snapshots taken.
    pub saved: u32,
    /// For it.
    pub saving: Duration,
    /// Snapshots put back.
    pub loaded: u32,
    /// For it.
    pub loading: Duration,
    /// Ticks.
    pub ticked: u32,
    /// For them.
    pub ticking: Duration,
}

/// Whether springs are put back.
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
            // Before the first frame, or that would be kept without bodies: Rapier meets them in its first tick.
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
            // After the game's own components, which springs look at.
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
