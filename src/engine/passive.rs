//! Landing and lifting off give nothing.
//!
//! Where contacts begin and end, elements act for a motion that does not come: the wheel that was to fly on
//! is stopped, the one that was to stand is let go. Their work is then off by a little, either way. Fixed
//! ground takes energy and gives none, so what a step with such a contact has gained is an error. Where
//! moving bodies touch, the same is said of the elements alone: what they have done to their bodies cannot
//! be more than what is missing in them; and of each contact, which can only take. Either way the gain is
//! taken out of the motion along the elements (a passivity controller, after Hannaford and Ryu, 2002), and
//! what cannot be had there out of the elements' own energy: see `Component::owed`.

use super::held::Support;
use super::scene::BodyRow;
use crate::dynamics::body::Body;
use crate::dynamics::element::{Element, End};
use crate::dynamics::energy::{Energy, take};
use crate::dynamics::step::Component;
use bevy::math::DVec3;

/// (ω h)² up to which an element's energy at the ends of steps says something about the motion between.
const RESOLVED: f64 = 4.0;

/// Share of the energy in motion that is rounding.
const ROUNDING: f64 = 1e-6;

/// Debt, as a multiple of all motion there is, above which what is seen of contacts is not believed, and the
/// time in which that is forgotten, s.
const SERIOUS: f64 = 3.0;
const FORGOTTEN: f64 = 0.8;

/// Share of the energy in motion by which what elements gave may seem too much, for a while.
const SWAY: f64 = 0.02;

/// What a component had at the start of the last step.
#[derive(Clone, Debug, Default)]
pub(super) struct Ledger {
    /// In all, where only fixed ground touched it.
    energy: Option<f64>,
    /// In its springs.
    stored: Option<f64>,
    /// What was gained and could not be taken yet, for want of motion.
    debt: f64,
    /// How free bodies are believed that moving ones hold, whatever they were seen to be.
    distrust: f64,
    /// Energy in motion, of late.
    motion: f64,
    /// What touched it then.
    touched: Touch,
}

/// What touches a component.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Touch {
    #[default]
    Nothing,
    /// Takes energy and gives none.
    Ground,
    /// Can give energy too, so only what the elements themselves do is known.
    Moving,
    /// Joints, of which nothing is known.
    Tied,
}

impl Ledger {
    /// Forgets what was: something else than the elements and what touches them has acted.
    pub(super) fn clear(&mut self) {
        self.energy = None;
        self.stored = None;
        self.debt = 0.0;
    }

    /// Compares with the last step, and takes a gain out of `bodies` if some of them touched something.
    pub(super) fn settle<'a>(
        &mut self,
        elements: &[Element],
        bodies: &mut [Body],
        rows: impl Iterator<Item = &'a BodyRow>,
        time: f64,
    ) {
        let (mut touch, mut given) = (Touch::Nothing, 0.0);
        let (mut moved, mut driven) = (false, false);
        for row in rows {
            touch = touch.max(match row.support {
                Support::None | Support::Unknown => Touch::Nothing,
                Support::Contact { on_fixed: true, .. } => Touch::Ground,
                Support::Contact { .. } => Touch::Moving,
                Support::Joint | Support::Tied(_) => Touch::Tied,
            });
            moved |= row.displaced;
            driven |= row.driven;
            given += row.given_work + row.contact_work;
        }
        let touch = touch.max(std::mem::replace(&mut self.touched, touch));
        if touch == Touch::Tied || moved {
            return self.clear();
        }
        let state = Energy::of(elements, bodies);
        let last = self.stored.replace(state.stored);
        let steady = elements.iter().flat_map(|element| element.ends).all(|end| {
            !matches!(end, End::Path(path) if path.velocity != DVec3::ZERO || path.turning != DVec3::ZERO)
        });
        let total = state.sum();
        let had = self.energy.take();
        if touch == Touch::Moving {
            // Impulse times mean velocity is the elements' work, whatever else acts on the bodies.
            if let Some(last) = last.filter(|_| steady) {
                let least = -SWAY * state.motion;
                self.debt = (self.debt + given + state.stored - last).max(least);
            }
        } else if self.is_accountable(elements, bodies, time) && steady {
            if let Some(had) = had.filter(|_| touch == Touch::Ground && !driven) {
                self.debt = (self.debt + total - had).max(0.0);
            }
            self.energy = Some(total);
        } else {
            return self.clear();
        }
        if self.debt > ROUNDING * state.motion {
            let taken = take(elements, bodies, self.debt);
            self.debt -= taken;
            self.energy = self.energy.map(|energy| energy - taken);
        }
        if touch == Touch::Nothing && self.debt <= ROUNDING * state.motion {
            self.debt = self.debt.min(0.0);
        }
        for body in bodies {
            body.given = (DVec3::ZERO, DVec3::ZERO);
        }
    }

    /// Whether nothing touches the component and nothing is to be taken from it.
    pub(super) fn is_idle(&self) -> bool {
        self.touched == Touch::Nothing && self.debt <= 0.0
    }

    /// Takes note of a step of one that was idle. `displaced` if something else than the engine has moved it.
    pub(super) fn go_on(&mut self, component: &Component, displaced: bool, time: f64) {
        let (energy, accountable) = component.carried_energy(time, RESOLVED);
        if displaced || !accountable {
            self.clear();
        } else {
            self.stored = Some(energy.stored);
            self.energy = Some(energy.sum());
        }
        self.distrust(energy.motion, time);
    }

    /// What the motion could not pay, J.
    pub(super) fn owed(&self) -> f64 {
        if self.touched == Touch::Moving {
            self.debt.max(0.0)
        } else {
            0.0
        }
    }

    /// Least mobility of bodies that moving ones hold, in a step of so long, where so much energy is in
    /// motion: a hold that comes and goes can win more than can be taken.
    pub(super) fn distrust(&mut self, motion: f64, time: f64) -> f64 {
        let kept = (-time / FORGOTTEN).exp();
        self.motion = motion.max(kept * self.motion);
        self.distrust = if self.owed() > SERIOUS * self.motion {
            1.0
        } else {
            kept * self.distrust
        };
        self.distrust
    }

    /// Whether the energy at the ends of steps says something about the motion between.
    fn is_accountable(&self, elements: &[Element], bodies: &[Body], time: f64) -> bool {
        elements.iter().all(|element| {
            element.line(bodies).is_some_and(|l| {
                element.elastic(l.length).stiffness * l.inverse_mass * time * time < RESOLVED
            })
        }) && bodies.iter().all(|body| body.torque == DVec3::ZERO)
    }
}
