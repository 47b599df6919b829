//! Companions, the components beside an element that change its law: read, checked and combined into one law.

use crate::backend::Allowance;
use crate::dynamics::guide::Guide;
use crate::dynamics::law::{DragLaw, Function, Law, Recipe, SpringForce, Stop, Table};
use crate::element::*;
use crate::input::check::{Fault, MOST, Names, Parameters, direction, finite, number};
use crate::input::lists::with_companions;
use crate::input::parts::PartsItem;
use crate::input::stamps::{Stamps, StampsItem};
use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::prelude::*;
use std::sync::Arc;

macro_rules! beside {
    ([$($law:ident: $kind:ident),*] [$($other:ident: $other_kind:ident),*]) => {
        /// All components that can stand beside an element.
        #[derive(QueryData)]
        pub(crate) struct Beside {
            $($law: Option<&'static $kind>,)*
            $($other: Option<&'static $other_kind>,)*
        }

        type AnyBeside = Or<($(With<$kind>,)* $(With<$other_kind>,)*)>;

        /// Filter: some component beside the element changed.
        pub(crate) type ChangedBeside = Or<($(Changed<$kind>,)* $(Changed<$other_kind>,)*)>;
    };
}
with_companions!(beside);

/// Finds the companions of elements, and which companions changed or were removed.
#[derive(SystemParam)]
pub(crate) struct Companions<'w, 's> {
    pub(crate) all: Query<'w, 's, Beside, AnyBeside>,
    changed: Query<'w, 's, (Entity, Stamps), ChangedBeside>,
    /// Entities on which a companion changed or was removed since the last run.
    pub(crate) touched: Local<'s, EntityHashSet>,
    /// Only changes after this tick count; `None` for all changes since the last run.
    since: Local<'s, Option<Tick>>,
    ticks: SystemChangeTick,
}

/// What the companions make of an element: its law, and the guide along or about which it acts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Companion {
    pub law: Option<Arc<Law>>,
    pub guide: Guide,
}

impl Companions<'_, '_> {
    /// Collects the entities whose companions changed, since the last run or only after the tick `since`. `lost` are
    /// the entities that lost a companion.
    pub(crate) fn look(&mut self, since: Option<Tick>, lost: impl Iterator<Item = Entity>) {
        *self.since = since;
        let now = self.ticks.this_run();
        let is_new = |stamps: &StampsItem| since.is_none_or(|since| stamps.is_after(since, now));
        let changed = self.changed.iter().filter(|(_, stamps)| is_new(stamps));
        self.touched.clear();
        self.touched.extend(changed.map(|(entity, _)| entity));
        self.touched.extend(lost);
    }

    /// Whether some part of an element changed since the last run, or after the tick of the last [look](Self::look).
    pub(crate) fn is_new(&self, parts: &PartsItem) -> bool {
        match *self.since {
            Some(since) => parts.is_changed_after(since, self.ticks.this_run()),
            None => parts.is_changed(),
        }
    }

    /// Returns the tuning of an element that is still to be applied, if there is one.
    pub(crate) fn tuning(&self, entity: Entity) -> Option<SpringTuning> {
        self.all.get(entity).ok()?.tuning.copied()
    }

    /// Returns what the companions of an element make of its tension. A preload that a [`HoldPose`] will replace does not count.
    pub(crate) fn allowance(&self, entity: Entity) -> Allowance {
        let beside = self.all.get(entity).ok();
        let limits = beside.as_ref().and_then(|beside| beside.limits().ok());
        let beside = beside.filter(|beside| beside.pose.is_none());
        let preload = beside.and_then(|beside| beside.preload);
        Allowance {
            preload: preload.map_or(0.0, |preload| f64::from(preload.0)),
            limits: limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
        }
    }

    /// Returns the [`Preload`] beside an element, N, whoever wrote it.
    pub(crate) fn written_preload(&self, entity: Entity) -> Option<f32> {
        self.all.get(entity).ok()?.preload.map(|preload| preload.0)
    }

    /// Returns the [`HoldPose`] of an element that still has to find its preload.
    pub(crate) fn pose(&self, entity: Entity) -> Option<HoldPose> {
        self.all.get(entity).ok()?.pose.copied()
    }

    /// Combines the companions of an element.
    pub(crate) fn of(&self, entity: Entity, p: &Parameters) -> Result<Companion, Fault> {
        match self.all.get(entity) {
            Ok(beside) => beside.companion(p),
            Err(_) => {
                let guide = p.guide();
                p.check_rest(guide)?;
                Ok(Companion { law: None, guide })
            }
        }
    }
}

impl BesideItem<'_, '_> {
    /// Combines the companions of an element.
    pub(crate) fn companion(&self, p: &Parameters) -> Result<Companion, Fault> {
        let mut guide = p.guide();
        if let Some(limit) = self.breakable {
            check_limit(limit.force, "Breakable::force")?;
            check_limit(limit.length, "Breakable::length")?;
        }
        if let Some(axis) = self.axis {
            if guide != Guide::Centres {
                return Err(Fault::new("SpringAxis", "stands on a torsion element"));
            }
            guide = match *axis {
                SpringAxis::World(axis) => Guide::World(direction(axis, "SpringAxis::World")?),
                SpringAxis::BodyA(axis) => Guide::OfA(direction(axis, "SpringAxis::BodyA")?),
            };
        }
        p.check_rest(guide)?;
        self.check_parts(p.ties.names)?;
        let law = if self.is_linear() {
            None
        } else {
            Some(Arc::new(Law::new(self.recipe(p, guide)?)))
        };
        Ok(Companion { law, guide })
    }

    /// Checks that the element has the part whose law is given.
    fn check_parts(&self, names: &Names) -> Result<(), Fault> {
        let own = self.own_spring.map(|_| "CustomSpringLaw");
        let law = self.spring.map(|_| "SpringLaw").or(own);
        if let Some(law) = law.filter(|_| names.stiffness.is_empty()) {
            return Err(Fault::new(law, "stands on a damper without a spring"));
        }
        let own = self.own_damping.map(|_| "CustomDampingLaw");
        let law = self.damping.map(|_| "DampingLaw").or(own);
        if let Some(law) = law.filter(|_| names.damping.is_empty()) {
            return Err(Fault::new(law, "stands on a spring without a damper"));
        }
        Ok(())
    }

    /// Whether the companions leave the law linear: nothing but an axis counts.
    pub(crate) fn is_linear(&self) -> bool {
        matches!(self.spring, None | Some(SpringLaw::Linear))
            && matches!(self.damping, None | Some(DampingLaw::Linear))
            && matches!(self.action, None | Some(SpringAction::Both))
            && self.preload.is_none_or(|preload| preload.0 == 0.0)
            && self.own_spring.is_none()
            && self.own_damping.is_none()
            && self.travel.is_none()
            && self.max_force.is_none()
    }

    pub(crate) fn recipe(&self, p: &Parameters, guide: Guide) -> Result<Recipe, Fault> {
        let (travel, stop) = match self.travel {
            Some(travel) => check_travel(travel, guide)?,
            None => ([f64::NEG_INFINITY, f64::INFINITY], Stop::default()),
        };
        let preload = self.preload.copied().unwrap_or_default().0;
        Ok(Recipe {
            spring: self.spring_force(p)?,
            drag: self.drag(p)?,
            preload: finite(preload, "Preload")?,
            limits: self.limits()?,
            most: self.most()?,
            travel,
            stop,
        })
    }

    /// Greatest magnitude of the force of spring and damper together, N.
    fn most(&self) -> Result<f64, Fault> {
        self.max_force
            .map_or(Ok(f64::INFINITY), |most| check_most(*most))
    }

    /// Least and greatest tension of the spring, N.
    fn limits(&self) -> Result<[f64; 2], Fault> {
        let most = self.most()?;
        Ok(match self.action {
            None | Some(SpringAction::Both) => [-most, most],
            Some(SpringAction::Pull) => [0.0, most],
            Some(SpringAction::Push) => [-most, 0.0],
        })
    }

    fn spring_force(&self, p: &Parameters) -> Result<SpringForce, Fault> {
        const ALIKE: &str = "stands together with CustomSpringLaw; use one of them";
        let both = |coefficients: [f64; 3]| SpringForce::Polynomial {
            pull: coefficients,
            push: coefficients,
        };
        let stiffness = f64::from(p.numbers.stiffness);
        match (self.spring, self.own_spring) {
            (Some(_), Some(_)) => Err(Fault::new("SpringLaw", ALIKE)),
            (None, Some(own)) => Ok(SpringForce::Custom(Arc::new(Theirs(own.0.clone())))),
            (None | Some(SpringLaw::Linear), None) => Ok(both([stiffness, 0.0, 0.0])),
            (Some(SpringLaw::Cubic), None) => Ok(both([0.0, 0.0, stiffness])),
            (Some(SpringLaw::Polynomial { pull, push }), None) => Ok(SpringForce::Polynomial {
                pull: coefficients(pull)?,
                push: coefficients(push)?,
            }),
            (Some(SpringLaw::Table(points)), None) => {
                let table = table(points, "SpringLaw::Table")?;
                Ok(SpringForce::Table(Arc::new(table)))
            }
        }
    }

    fn drag(&self, p: &Parameters) -> Result<DragLaw, Fault> {
        match (self.damping, self.own_damping) {
            (Some(_), Some(_)) => Err(Fault::new(
                "DampingLaw",
                "stands together with CustomDampingLaw; use one of them",
            )),
            (None, Some(own)) => {
                let law = Theirs(own.0.clone());
                if law.force(0.0).abs() > 0.0 {
                    return Err(Fault::new("CustomDampingLaw", "has a force at rest"));
                }
                Ok(DragLaw::Custom(Arc::new(law)))
            }
            (None | Some(DampingLaw::Linear), None) => {
                Ok(DragLaw::Linear(f64::from(p.numbers.damping)))
            }
            (Some(DampingLaw::Sided { bump, rebound }), None) => Ok(DragLaw::Sided {
                bump: number(*bump, "DampingLaw::Sided::bump")?,
                rebound: number(*rebound, "DampingLaw::Sided::rebound")?,
            }),
            (Some(DampingLaw::Quadratic { linear, quadratic }), None) => Ok(DragLaw::Quadratic {
                linear: number(*linear, "DampingLaw::Quadratic::linear")?,
                quadratic: number(*quadratic, "DampingLaw::Quadratic::quadratic")?,
            }),
            (
                Some(DampingLaw::BlowOff {
                    damping,
                    knee,
                    beyond,
                }),
                None,
            ) => Ok(DragLaw::BlowOff {
                damping: number(*damping, "DampingLaw::BlowOff::damping")?,
                knee: number(*knee, "DampingLaw::BlowOff::knee")?,
                beyond: number(*beyond, "DampingLaw::BlowOff::beyond")?,
            }),
            (Some(DampingLaw::Table(points)), None) => {
                const FIELD: &str = "DampingLaw::Table";
                let table = table(points, FIELD)?;
                let most = points.points.iter().fold(0.0, |m, p| p.y.abs().max(m));
                if table.at(0.0)[0].abs() > 1e-5 * f64::from(most) {
                    return Err(Fault::new(FIELD, "has a force at rest"));
                }
                Ok(DragLaw::Table(Arc::new(table)))
            }
        }
    }
}

fn coefficients(p: &Polynomial) -> Result<[f64; 3], Fault> {
    Ok([
        number(p.linear, "Polynomial::linear")?,
        number(p.quadratic, "Polynomial::quadratic")?,
        number(p.cubic, "Polynomial::cubic")?,
    ])
}

fn table(table: &ForceTable, field: &'static str) -> Result<Table, Fault> {
    let fault = |reason| Err(Fault::new(field, reason));
    let points = &table.points;
    if points.len() < 2 {
        return fault("has fewer than two points");
    }
    if points.iter().any(|p| !p.is_finite()) {
        return fault("has a point that is not finite");
    }
    if points.windows(2).any(|p| p[0].x >= p[1].x) {
        return fault("has points whose x does not rise strictly");
    }
    if points.windows(2).any(|p| p[0].y > p[1].y) {
        return fault("has a force that falls as x rises");
    }
    let points: Vec<_> = points
        .iter()
        .map(|p| (f64::from(p.x), f64::from(p.y)))
        .collect();
    let steep = |p: &[(f64, f64)]| p[1].1 - p[0].1 > f64::from(MOST) * (p[1].0 - p[0].0);
    if points
        .iter()
        .any(|(x, y)| x.abs().max(y.abs()) > f64::from(MOST))
    {
        return fault("has a point larger than 1e12");
    }
    if points.windows(2).any(steep) {
        return fault("has a slope larger than 1e12");
    }
    Ok(Table::new(&points))
}

/// Checks a limit of [`Breakable`]. A magnitude is never below zero, so a negative limit would break the element at once.
fn check_limit(limit: f32, field: &'static str) -> Result<(), Fault> {
    if limit.is_nan() {
        Err(Fault::new(field, "is NaN"))
    } else if limit < 0.0 {
        Err(Fault::new(field, "is negative"))
    } else {
        Ok(())
    }
}

fn check_most(MaxForce(most): MaxForce) -> Result<f64, Fault> {
    if most > 0.0 {
        Ok(f64::from(most))
    } else {
        Err(Fault::new("MaxForce", "is not above zero"))
    }
}

fn check_travel(travel: &SpringTravel, guide: Guide) -> Result<([f64; 2], Stop), Fault> {
    let stop = Stop {
        stiffness: number(travel.stop_stiffness, "SpringTravel::stop_stiffness")?,
        progression: number(travel.progression, "SpringTravel::progression")?,
        damping: number(travel.stop_damping, "SpringTravel::stop_damping")?,
    };
    let (min, max) = (travel.min_length, travel.max_length);
    if min.is_nan() || min == f32::INFINITY || (guide == Guide::Centres && min < 0.0) {
        return Err(Fault::new(
            "SpringTravel::min_length",
            "is negative or not a number",
        ));
    }
    if max.is_nan() || max <= min {
        return Err(Fault::new(
            "SpringTravel::max_length",
            "is not above min_length",
        ));
    }
    // The distance between two points is never below zero, so a stop at zero is no stop.
    let none = guide == Guide::Centres && min == 0.0;
    let least = if none {
        f64::NEG_INFINITY
    } else {
        f64::from(min)
    };
    Ok(([least, f64::from(max)], stop))
}
