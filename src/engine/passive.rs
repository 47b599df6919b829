//! Landing and lifting off give nothing.
//!
//! Where contacts begin and end, elements act for a motion that does not come: the wheel that was to fly on
//! is stopped, the one that was to stand is let go. Their work is then off by a little, either way. Fixed
//! ground takes energy and gives none, so what a step with such a contact has gained is an error, and is
//! taken out of the motion along the elements (a passivity controller, after Hannaford and Ryu, 2002).

use super::held::Support;
use super::scene::BodyRow;
use crate::dynamics::body::Body;
use crate::dynamics::element::{Element, End};
use crate::dynamics::energy::{Energy, take};
use bevy::math::DVec3;

/// (ω h)² up to which an element's energy at the ends of steps says something about the motion between.
const RESOLVED: f64 = 4.0;

/// Share of the energy in motion that is rounding.
const ROUNDING: f64 = 1e-6;

/// What a component had at the start of the last step.
#[derive(Clone, Debug, Default)]
pub(super) struct Ledger {
    energy: Option<f64>,
    /// What was gained and could not be taken yet, for want of motion.
    debt: f64,
    /// Whether a contact held some body then.
    held: bool,
}

impl Ledger {
    /// Forgets what was: something else than the elements and fixed ground has acted.
    pub(super) fn clear(&mut self) {
        self.energy = None;
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
        let (mut held, mut known) = (false, true);
        for row in rows {
            match row.support {
                Support::None | Support::Unknown => {}
                Support::Contact { on_fixed, .. } => {
                    held = true;
                    known &= on_fixed;
                }
                Support::Joint | Support::Tied(_) => known = false,
            }
        }
        let touched = std::mem::replace(&mut self.held, held) || held;
        known &= elements.iter().all(|element| {
            let line = element.line(bodies);
            line.is_some_and(|l| {
                element.elastic(l.length).stiffness * l.inverse_mass * time * time < RESOLVED
            })
        });
        known &= bodies.iter().all(|body| body.torque == DVec3::ZERO)
            && elements
                .iter()
                .flat_map(|element| element.ends)
                .all(|end| !matches!(end, End::Path(path) if path.velocity != DVec3::ZERO || path.turning != DVec3::ZERO));
        if !known {
            return self.clear();
        }
        let state = Energy::of(elements, bodies);
        let (energy, motion) = (state.sum(), state.motion);
        if let Some(before) = self.energy.filter(|_| touched) {
            self.debt = (self.debt + energy - before).max(0.0);
        }
        let taken = if self.debt > ROUNDING * motion {
            take(elements, bodies, self.debt)
        } else {
            0.0
        };
        for body in bodies {
            body.given = (DVec3::ZERO, DVec3::ZERO);
        }
        self.debt -= taken;
        self.energy = Some(energy - taken);
    }
}
