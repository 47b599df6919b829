//! The system before the step. It checks whether the known scene is still valid. Usually it is, and then the system reads only
//! ends that can move; otherwise it rebuilds all rows.

use crate::backend::Wrench;
use crate::backend::rapier::body::handle;
use crate::backend::rapier::find::RapierFinder;
use crate::backend::rapier::forces::{self, Handles, Loads, SpringLoad, wrench};
use crate::backend::rapier::watch::Watch;
use crate::input::companions::Companions;
use crate::input::parts::{Acts, ChangedParts, Parts};
use crate::scene::refresh::{refresh, still_computed, still_faulty};
use crate::scene::rows::BodyFlags;
use crate::scene::state::Scene;
use bevy::ecs::bundle::NoBundleEffect;
use bevy::ecs::system::SystemState;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// What is read and written to prepare a step.
type Sources<'w, 's> = (
    ResMut<'w, Scene>,
    Query<'w, 's, Parts, Acts>,
    Query<'w, 's, Entity, ChangedParts>,
    RapierFinder<'w, 's>,
    ParamSet<'w, 's, (Entering<'w, 's>, Loads<'w, 's>)>,
    Handles<'w, 's>,
    Watch<'w, 's>,
    Companions<'w, 's>,
    Commands<'w, 's>,
);

/// Finds elements, their ends, and the bodies on which they act.
pub(crate) fn prepare(world: &mut World, sources: &mut SystemState<Sources>) {
    if let Ok((scene, elements, changed, finder, loads, handles, watch, companions, commands)) =
        sources.get_mut(world)
    {
        look(
            scene, elements, changed, finder, loads, handles, watch, companions, commands,
        );
    }
    sources.apply(world);
}

fn look(
    mut scene: ResMut<Scene>,
    elements: Query<Parts, Acts>,
    changed: Query<Entity, ChangedParts>,
    mut finder: RapierFinder,
    mut loads: ParamSet<(Entering, Loads)>,
    handles: Handles,
    mut watch: Watch,
    mut companions: Companions,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    *scene.news.get_mut() = false;
    let mut same = !watch.saw_change(scene);
    same &= !std::mem::replace(&mut scene.stale, std::mem::take(&mut scene.wall_changed));
    companions.look(scene.since.take(), scene.touched.drain(..));
    // `Watch` sees entities that appear and disappear. The count covers other ways in which elements may disappear.
    same &= elements.iter().len() == scene.elements.len();
    let is_new = |entity: &Entity| {
        let parts = elements.get(*entity);
        parts.is_ok_and(|parts| companions.is_new(&parts))
    };
    let changed = changed.iter().filter(is_new);
    same = same && refresh(scene, &elements, changed, &companions, &finder);
    let modified = &watch.mass_modified;
    let awaits_step = scene.awaits_step();
    let Scene {
        elements: rows,
        faulty,
        ..
    } = scene;
    same = same
        && faulty.iter().all(|index| {
            let row = &mut rows[*index as usize];
            still_faulty(row, &companions, &mut finder, modified, &mut commands)
        });
    if same && awaits_step {
        let mut awaiting = rows.iter_mut().filter(|row| row.awaits_step());
        same =
            awaiting.all(|row| still_computed(row, &elements, &companions, &mut finder, modified));
    }
    scene.renewed = !same || (scene.renewed && scene.time <= 0.0);
    if !same {
        scene.renew(&elements, &companions, &mut finder, modified, &mut commands);
        enter_loads(scene, &mut loads.p0(), &finder, &mut commands);
    }
    if scene.renewed {
        let sets = &mut finder.sets;
        forces::release(scene, &mut loads.p1(), &handles, sets, &mut commands);
    }
}

/// Loads and forces of bodies in the engine.
type Entering<'w, 's> = Query<
    'w,
    's,
    (
        Option<&'static mut SpringLoad>,
        Option<&'static ExternalForce>,
    ),
    With<RapierRigidBodyHandle>,
>;

/// Gives each body on which elements act its `SpringLoad` and `ExternalForce`, and reads the user's share of the force.
fn enter_loads(
    scene: &mut Scene,
    loads: &mut Entering,
    finder: &RapierFinder,
    commands: &mut Commands,
) {
    let tick = scene.tick;
    let (mut new, mut new_loads) = (Vec::new(), Vec::new());
    for (slot, row) in scene.bodies.iter_mut().enumerate() {
        let Ok((load, force)) = loads.get_mut(row.entity) else {
            continue;
        };
        let known = load.map(|mut load| {
            let load = load.bypass_change_detection();
            load.slot = slot;
            load.mend();
            if row.has(BodyFlags::NEW) {
                // A new body in the engine began with the sum of both shares.
                row.carry(&wrench(&load.elements));
            }
            load.user
        });
        if let (Some(user), true) = (known, force.is_some()) {
            row.set_user(wrench(&user));
            continue;
        }
        let engine = finder
            .sets
            .get(row.rare.context)
            .ok()
            .and_then(|(set, ..)| {
                let body = set.bodies.get(handle(row.id))?;
                Some(ExternalForce {
                    force: body.user_force(),
                    torque: body.user_torque(),
                })
            });
        // A force written directly to the engine belongs to the user too.
        let mut present = force.copied().or(engine).unwrap_or_default();
        if let Some(share) = row.share(tick).filter(|_| known.is_none()) {
            // Its load was removed. The force still contains the share of elements; without it, the user's is that of the last step.
            let Wrench { force, torque } = force.map_or(row.user(), |sum| Wrench {
                force: sum.force - share.force,
                torque: sum.torque - share.torque,
            });
            present = ExternalForce { force, torque };
        }
        row.set_user(wrench(&known.unwrap_or(present)));
        let load = SpringLoad::new(present, slot);
        match (known, force) {
            (None, None) => new.push((row.entity, (present, load))),
            (None, Some(_)) => new_loads.push((row.entity, load)),
            (Some(_), None) => {
                commands.entity(row.entity).try_insert(present);
            }
            (Some(_), Some(_)) => {}
        }
    }
    insert_all(new, commands);
    insert_all(new_loads, commands);
}

/// Inserts components into many entities with one command. One command per entity would enlarge the command queue for good;
/// one component at a time would leave unused room in a table for each component.
fn insert_all<B: Bundle<Effect: NoBundleEffect>>(all: Vec<(Entity, B)>, commands: &mut Commands) {
    if !all.is_empty() {
        commands.queue(|world: &mut World| {
            // Entities that no longer exist need none.
            _ = world.try_insert_batch(all);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CoiloverPlugin, HoldPose, SpringDamper, SpringTuning};
    use bevy::time::TimeUpdateStrategy;
    use std::time::Duration;

    /// A world that is not stepped, and in it a load of 1 kg one metre below a hook, with an element between them.
    fn paused<B: Bundle>(element: impl FnOnce(SpringDamper) -> B) -> (App, Entity) {
        let tick = Duration::from_secs_f32(1.0 / 60.0);
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            TransformPlugin,
            RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
            CoiloverPlugin::default(),
        ))
        .insert_resource(TimestepMode::Fixed {
            dt: tick.as_secs_f32(),
            substeps: 1,
        })
        .insert_resource(Time::<Fixed>::from_duration(tick))
        .insert_resource(TimeUpdateStrategy::ManualDuration(tick));
        app.finish();
        app.cleanup();
        app.update();
        let world = app.world_mut();
        let mut engines = world.query::<&mut RapierConfiguration>();
        for mut engine in engines.iter_mut(world) {
            engine.physics_pipeline_active = false;
        }
        let hook = world.spawn(Transform::from_xyz(0.0, 1.0, 0.0)).id();
        let mass = AdditionalMassProperties::Mass(1.0);
        let load = (RigidBody::Dynamic, Transform::default(), mass);
        let load = world.spawn(load).id();
        let element = element(SpringDamper::new(hook, load));
        world.spawn(element);
        (app, load)
    }

    /// Runs a tick. Returns whether it made the rows anew: then they forget how they were solved.
    fn renews(app: &mut App) -> bool {
        const MARK: u32 = 7;
        let mut scene = app.world_mut().resource_mut::<Scene>();
        scene.elements[0].solved.microsteps = MARK;
        app.update();
        let scene = app.world().resource::<Scene>();
        scene.elements[0].solved.microsteps != MARK
    }

    #[test]
    fn numbers_that_wait_for_a_step_make_the_rows_anew_only_if_the_load_is_put_elsewhere() {
        let sag = |pair: SpringDamper| (pair, SpringTuning::sag(0.1, 0.3));
        let pose = |pair: SpringDamper| (pair.with_rest_length(0.9), HoldPose::new());
        for (mut app, load) in [paused(sag), paused(pose)] {
            for _ in 0..4 {
                app.update();
            }
            for _ in 0..3 {
                assert!(!renews(&mut app), "nothing has changed");
            }
            let mut at = app.world_mut().get_mut::<Transform>(load);
            at.as_mut().expect("a place").translation.y = -0.5;
            // The engine may learn of it one tick later.
            let renewed = (0..2).any(|_| renews(&mut app));
            assert!(renewed, "the load is elsewhere");
        }
    }
}
