//! Number of sweeps over all joints and contacts that Rapier's solver takes in each substep. A sweep solves one joint after the
//! other (Gauss–Seidel), so a damper sees bodies that some joints have pushed already and others not yet.

use crate::backend::rapier::held::plan::Plan;
use crate::dynamics::pieces::Piece;

/// Number of sweeps per substep for a tense component without joints of the game, or a component with joints in which a one-sided
/// force acts. With two sweeps the bridge of `ground::play` still trembles. With one, stiff ropes that fall on the ground gain
/// energy (`ground::ropes`). Sweeps cost little compared with the set-up of joints in each substep.
const TENSE_SWEEPS: usize = 4;
/// Number of sweeps per substep for a component without joints of the game in which a one-sided force acts. With four, a chain of
/// all but rigid stops that falls on the ground reaches 16 m/s (`ground::ropes`).
const ONE_SIDED_SWEEPS: usize = 8;

/// Error that the sweeps of a substep may leave, as a share of what a damper changes. Pinned by `ground::dampers`: with 0.01, a
/// quarter of the weight of one of 16 sliders is missing.
const SMALL: f64 = 3e-3;
/// As [`SMALL`], for a component with joints of the game in a world with contacts. Pinned by `ground::fitted_cars`: with 0.15, the
/// springs of a parked car with knuckles carry 2 % too little.
const ROUGH: f64 = 0.03;
/// Greatest number of sweeps for such a component. With more, Rapier holds contacts worse there: with four, a parked car on cylinders
/// sags 0.6 % too little, a rolling one 2 %, and a bridge on hinges under boxes does not come to rest. Pinned by `ground::drive` and
/// `ground::play`.
const ROUGH_SWEEPS: f64 = 2.0;
/// Greatest number of sweeps for dampers. With 32, the bridge of `ground::dampers` comes no closer to statics.
const MOST_SWEEPS: f64 = 16.0;

impl Plan {
    /// Number of sweeps over joints and contacts that a substep of `substep` seconds needs. With too few, a damper does not see
    /// what joints leave of an impulse, or what other dampers do. `touching` tells whether something in the world touches something
    /// else.
    pub(crate) fn sweeps(&mut self, substep: f64, touching: bool) -> usize {
        let others = match (self.is_any_one_sided(), self.jointed) {
            (true, false) => ONE_SIDED_SWEEPS,
            (true, true) => TENSE_SWEEPS,
            (false, false) if self.tense => TENSE_SWEEPS,
            _ => 1,
        };
        others.max(self.damper_sweeps(substep, touching))
    }

    /// Whether a one-sided force acts in this step, as far as the rates predict. Stops that are out of reach do not count: with more
    /// sweeps Rapier carries a rolling wheel worse.
    fn is_any_one_sided(&self) -> bool {
        self.orders.iter().any(|order| {
            let acts = |piece: &Piece| {
                let tension = |length: &f64| piece.tension(*length, 0.0) != 0.0;
                piece.ends() && order.reach.way.iter().any(tension)
            };
            order.pieces.iter().any(acts)
        })
    }

    /// Number of sweeps that dampers need. A sweep solves one element after the other. So a damper sees bodies that some springs
    /// have pushed already and others not yet, and that the joints of the game have not held back yet. It resists that motion too,
    /// so at rest its force would be wrong. Each further sweep (Gauss–Seidel) multiplies that error by about the square of the
    /// damper's coupling: what the others change of its rate in a substep, as a share of what it changes itself.
    fn damper_sweeps(&mut self, substep: f64, touching: bool) -> usize {
        let dampings = self
            .orders
            .iter()
            .map(|order| order.acting_damping(substep));
        self.dampings.clear();
        self.dampings.extend(dampings);
        self.drags.clear();
        self.drags.resize(self.bodies.len(), 0.0);
        for (order, damping) in self.orders.iter().zip(&self.dampings) {
            for (body, root) in order.mobilities() {
                self.drags[body] += damping * root;
            }
        }
        let each = self.orders.iter().zip(&self.dampings);
        let coupling = each.map(|(order, damping)| {
            let others = order.mobilities();
            let others: f64 = others
                .map(|(body, root)| root * (self.drags[body] - damping * root))
                .sum();
            let own = damping * order.line.inverse_mass * substep;
            // Where something touches, the engine's warm start already contains the reaction of joints and contacts.
            let joints = if order.apart {
                1.0 - order.jointed
            } else {
                0.0
            };
            let joints = joints.max(0.0) * own / (1.0 + own);
            others * substep / (1.0 + own) + joints.sqrt()
        });
        let coupling = coupling.fold(0.0, f64::max);
        let (left, most) = if self.jointed && touching {
            (ROUGH, ROUGH_SWEEPS)
        } else {
            (SMALL, MOST_SWEEPS)
        };
        if coupling >= 1.0 {
            return most as usize;
        }
        // Without any coupling, the number is zero.
        let sweeps = left.ln() / (2.0 * coupling.ln());
        sweeps.ceil().clamp(1.0, most) as usize
    }
}
