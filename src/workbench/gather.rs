//! Reads from the world what the view shows. Runs in `PostUpdate`; the record gets a sample after each tick.

use super::CoiloverWorkbench;
use super::bench::{Bench, Clock};
use super::model::facts::{End, EndKind, Facts, Stepping, Subject};
use super::model::record::Sample;
use super::model::rows::Row;
use super::model::snapshot::Snapshot;
use crate::element::{CustomDampingLaw, CustomSpringLaw, SpringAxis, SpringFault};
use crate::input::companions::Beside;
use crate::input::curve::Curve;
use crate::input::named_ends::and_above;
use crate::input::parts::{IsElement, Parts};
use crate::readout::SpringReadout;
use crate::settings::CoiloverSettings;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::ecs::system::{SystemParam, SystemState};
use bevy::prelude::*;
use bevy_rapier3d::prelude::{
    GravityScale, RapierConfiguration, RapierContextEntityLink, RigidBody, Sleeping, TimestepMode,
};

/// Number of frames over which the numbers in the list are refreshed once.
const FRAMES: usize = 16;

/// Time between two sortings of the list, s. Changes of elements and names are taken up at the same times.
const SORT: f32 = 0.25;

/// Components that are read of a body: its kind, whether it sleeps, its Rapier context, and its gravity scale.
type Body<'a> = (
    &'a RigidBody,
    Option<&'a Sleeping>,
    Option<&'a RapierContextEntityLink>,
    Option<&'a GravityScale>,
);

/// Parameters that read the world. The chosen element may be disabled; the panel says so.
#[derive(SystemParam)]
pub(super) struct Look<'w, 's> {
    readouts: Query<'w, 's, (Entity, &'static SpringReadout), IsElement>,
    new: Query<'w, 's, (), (IsElement, Added<SpringReadout>)>,
    renamed: Query<'w, 's, (), Changed<Name>>,
    names: Query<'w, 's, &'static Name, Allow<Disabled>>,
    laws: Query<'w, 's, (Parts, Beside)>,
    faults: Query<'w, 's, &'static SpringFault>,
    custom: Query<'w, 's, (Has<CustomSpringLaw>, Has<CustomDampingLaw>), Allow<Disabled>>,
    disabled: Query<'w, 's, (), With<Disabled>>,
    bodies: Query<'w, 's, Body<'static>>,
    parents: Query<'w, 's, &'static ChildOf>,
    globals: Query<'w, 's, &'static GlobalTransform>,
    configurations: Query<'w, 's, &'static RapierConfiguration>,
    settings: Option<Res<'w, CoiloverSettings>>,
    timestep: Option<Res<'w, TimestepMode>>,
    clock: Option<Res<'w, Time<Virtual>>>,
    real: Res<'w, Time<Real>>,
    buttons: Option<Res<'w, ButtonInput<MouseButton>>>,
}

/// State of the list between frames: the time of its last sorting, s, and whether its elements or names have changed.
#[derive(Default)]
pub(super) struct Looked {
    at: Option<f32>,
    stale: bool,
}

/// Reads everything that is shown in this frame.
pub(super) fn gather(world: &mut World, state: &mut SystemState<Look>, mut looked: Local<Looked>) {
    world.resource_scope(|world, mut bench: Mut<Bench>| {
        let bench = &mut *bench;
        let settings = world.resource::<CoiloverWorkbench>();
        bench.grab = settings.grab;
        bench.select(settings.selected);
        let chosen = bench.selected.and_then(|entity| {
            let snapshot = Snapshot::read(world.get_entity(entity).ok()?)?;
            Some((entity, snapshot))
        });
        if chosen.is_none() && bench.selected.is_some() {
            bench.select(None);
            world.resource_mut::<CoiloverWorkbench>().selected = None;
            bench.message = Some("the element is gone".into());
        }
        let Ok(look) = state.get_mut(world) else {
            return;
        };
        look.list(bench, &mut looked);
        if let Some(clock) = &look.clock {
            bench.clock = Clock {
                paused: clock.is_paused(),
                speed: clock.relative_speed(),
                steps: look.is_fixed(),
            };
        }
        bench.subject = chosen.map(|(entity, snapshot)| {
            let now = bench.with_pending(entity, snapshot);
            Subject {
                entity,
                title: look.label(entity, Some(now.part.ends())),
                facts: look.facts(entity, &now),
                now,
            }
        });
    });
}

impl Look<'_, '_> {
    /// Whether springs are solved in a schedule of fixed ticks.
    fn is_fixed(&self) -> bool {
        let settings = self.settings.as_ref();
        let fixed = [
            FixedFirst.intern(),
            FixedPreUpdate.intern(),
            FixedUpdate.intern(),
            FixedPostUpdate.intern(),
            FixedLast.intern(),
        ];
        settings.is_some_and(|settings| fixed.contains(&settings.schedule))
    }

    /// Updates the list of elements. Its order stays while a button is down, so that a click chooses the row that was pressed.
    fn list(&self, bench: &mut Bench, looked: &mut Looked) {
        let rows = &mut bench.rows;
        looked.stale |= self.readouts.iter().len() != rows.total()
            || !self.new.is_empty()
            || !self.renamed.is_empty();
        let now = self.real.elapsed_secs();
        let due = looked.at.is_none_or(|at| now - at >= SORT);
        if due && looked.stale {
            looked.stale = false;
            let new = self.readouts.iter().map(|(entity, readout)| {
                let law = self.laws.get(entity).ok();
                let ends = law.and_then(|(parts, _)| parts.ends());
                let mut row = Row::new(entity, self.label(entity, ends));
                row.read(readout);
                row
            });
            rows.replace(new.collect());
        }
        for row in rows.due(FRAMES) {
            if let Ok((_, readout)) = self.readouts.get(row.entity) {
                row.read(readout);
            }
        }
        let pressed = self.buttons.as_ref();
        let pressed = pressed.is_some_and(|buttons| buttons.pressed(MouseButton::Left));
        if due && !pressed {
            looked.at = Some(now);
            rows.arrange();
        }
    }

    /// Returns the name of an element, or a name made of the names of its ends.
    fn label(&self, element: Entity, ends: Option<[Entity; 2]>) -> String {
        if let Ok(name) = self.names.get(element) {
            return name.as_str().into();
        }
        let named = ends.map(|ends| ends.map(|end| self.named(end)));
        match named {
            Some([Some(a), Some(b)]) => format!("{a} – {b}"),
            Some([Some(one), None] | [None, Some(one)]) => format!("{one} – {element}"),
            _ => format!("{element}"),
        }
    }

    /// Returns the name of an entity, or of its nearest ancestor that has one.
    fn named(&self, entity: Entity) -> Option<&str> {
        let mut up = and_above(entity, &self.parents);
        let name = up.find_map(|entity| self.names.get(entity).ok());
        name.map(Name::as_str)
    }

    fn facts(&self, entity: Entity, now: &Snapshot) -> Facts {
        let readout = self.readouts.get(entity).map(|(_, readout)| *readout);
        let custom = self.custom.get(entity).unwrap_or_default();
        let ends = now.part.ends();
        let anchors = now.anchors.unwrap_or_default();
        let dt = match self.timestep.as_deref() {
            Some(TimestepMode::Fixed { dt, .. } | TimestepMode::Interpolated { dt, .. }) => *dt,
            Some(TimestepMode::Variable { max_dt, .. }) => *max_dt,
            None => 1.0 / 60.0,
        };
        let settings = self.settings.as_deref();
        let gravity = self.gravity(ends);
        let anchored = [self.end(ends[0], anchors.a), self.end(ends[1], anchors.b)];
        Facts {
            readout: readout.unwrap_or_default(),
            is_disabled: self.disabled.contains(entity),
            fault: self
                .faults
                .get(entity)
                .ok()
                .map(|fault| format!("It does not act: {} {}.", fault.field, fault.reason)),
            slope: self.slope(now, &anchored, gravity),
            ends: anchored,
            gravity: gravity.length(),
            stepping: Stepping {
                dt,
                microsteps: settings.map_or(1, |settings| settings.microsteps.max(1)),
                tolerance: settings.and_then(|settings| settings.tolerance),
            },
            custom: [custom.0, custom.1],
            curve: Curve::of(&self.laws, entity),
        }
    }

    /// Returns the cosine between gravity and the direction from the end that is not dynamic to the dynamic end,
    /// which is the load. `None` if not exactly one end is dynamic.
    fn slope(&self, now: &Snapshot, ends: &[End; 2], gravity: Vec3) -> Option<f32> {
        let [a, b] = ends;
        let to_load = match [a, b].map(|end| end.kind == EndKind::Dynamic) {
            [false, true] => 1.0,
            [true, false] => -1.0,
            _ => return None,
        };
        let along = match now.axis {
            None => b.at? - a.at?,
            Some(SpringAxis::World(axis)) => axis,
            Some(SpringAxis::BodyA(axis)) => {
                let end = now.part.ends()[0];
                let frame = self.bearer(end).unwrap_or(end);
                self.globals.get(frame).ok()?.rotation() * axis
            }
        };
        let slope = to_load * along.try_normalize()?.dot(gravity.try_normalize()?);
        Some(slope).filter(|slope| slope.is_finite())
    }

    /// Returns the entity of the body that an entity belongs to: itself or its nearest ancestor that is a body.
    fn bearer(&self, entity: Entity) -> Option<Entity> {
        and_above(entity, &self.parents).find(|entity| self.bodies.contains(*entity))
    }

    /// Returns the body that an entity belongs to.
    fn body(&self, entity: Entity) -> Option<Body<'_>> {
        self.bodies.get(self.bearer(entity)?).ok()
    }

    /// Returns gravity on the ends' bodies, m/s²: that of their Rapier context times their gravity scale, as for a
    /// `SpringTuning` the greater one if two scales differ. Zero if no end is a body.
    fn gravity(&self, ends: [Entity; 2]) -> Vec3 {
        let context = |end| self.body(end)?.2;
        let context = ends.into_iter().find_map(context);
        let configuration = context.and_then(|link| self.configurations.get(link.0).ok());
        let gravity = configuration.map_or(Vec3::ZERO, |configuration| configuration.gravity);
        let bodies = ends.into_iter().filter_map(|end| self.body(end));
        let movable = bodies.filter(|(kind, ..)| **kind == RigidBody::Dynamic);
        let scales = movable.map(|(.., scale)| scale.map_or(1.0, |scale| scale.0));
        let greatest = scales.max_by(|a, b| a.abs().total_cmp(&b.abs()));
        gravity * greatest.unwrap_or(1.0)
    }

    fn end(&self, entity: Entity, anchor: Vec3) -> End {
        let Ok(at) = self.globals.get(entity) else {
            return End {
                name: format!("{entity}"),
                ..End::default()
            };
        };
        let body = self.body(entity);
        let kind = match body {
            None => EndKind::Point,
            Some((RigidBody::Dynamic, ..)) => EndKind::Dynamic,
            Some((RigidBody::Fixed, ..)) => EndKind::Fixed,
            Some(_) => EndKind::Kinematic,
        };
        let asleep = body.and_then(|(_, sleeping, ..)| sleeping);
        let name = self.named(entity);
        End {
            name: name.map_or_else(|| format!("{entity}"), Into::into),
            kind,
            asleep: asleep.is_some_and(|sleeping| sleeping.sleeping),
            at: Some(at.transform_point(anchor)).filter(|at| at.is_finite()),
        }
    }
}

/// Records the readout of the chosen element after a tick.
pub(super) fn record(mut bench: ResMut<Bench>, readouts: Query<&SpringReadout>, time: Res<Time>) {
    let selected = bench.selected;
    if let Some(readout) = selected.and_then(|entity| readouts.get(entity).ok()) {
        bench.record.add(Sample {
            time: time.elapsed_secs_f64(),
            readout: *readout,
        });
    }
}
