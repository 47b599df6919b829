//! Reads the bodies and elements of a held component and computes what Rapier's solver needs. `write` writes it.

use crate::backend::Sight;
use crate::backend::rapier::body::handle;
use crate::backend::rapier::held::linkage::{Holding, inverse_mass};
use crate::backend::rapier::held::order::Order;
use crate::dynamics::body::Body;
use crate::dynamics::guide::Guide;
use crate::dynamics::line::Line;
use crate::dynamics::pieces::Pieces;
use crate::input::check::Fault;
use crate::scene::held::{Leeway, Turn};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Held, Members};
use crate::scene::step::Step;
use crate::scene::to_element::element;
use bevy::math::DVec3;

/// A held component before its step.
#[derive(Default)]
pub(crate) struct Plan {
    pub group: usize,
    pub bodies: Vec<Body>,
    pub orders: Vec<Order>,
    /// Upper bound on the frequency of the stiffest mode, rad/s.
    pub omega: f64,
    /// Whether something about the component has changed, so that it must not sleep.
    pub disturbed: bool,
    /// For each body, the sum over its elements of stiffness times inverse mass, 1/s².
    sums: Vec<f64>,
    /// For each body, the sum over its elements of damping times the root of the inverse mass along the element.
    pub(super) drags: Vec<f64>,
    /// For each order, the damping with which it acts, N s/m or N m s/rad.
    pub(super) dampings: Vec<f64>,
    /// For each body, the effect of springs and external forces.
    pulls: Vec<Pull>,
    /// Whether a joint of the game holds some body of the component.
    pub(super) jointed: bool,
    /// Whether springs pull some body with far more than its weight while contacts press on the component; see [`TENSE`].
    pub(super) tense: bool,
}

/// Effect of springs and external forces on a body.
struct Pull {
    /// Total acceleration, m/s².
    net: DVec3,
    /// Sum of the magnitudes of the accelerations, m/s².
    all: f64,
    /// Speed that these forces can add in the step, m/s. A fast spring reverses within the step, so it counts only for 1/ω.
    gain: f64,
}

/// Sum of the forces on a body, in units of its weight, above which one sweep over all joints per substep leaves the body
/// trembling on its support. Examples are a tensegrity of struts and a bridge of springs under boxes. Pinned by the check of
/// the example `tensegrity` and by `ground::play`.
const TENSE: f64 = 100.0;

/// Net force on a body, as a share of the sum of all forces on it, below which the forces count as balanced. Pinned by
/// `ground::heap`.
const BALANCE: f64 = 5e-3;

/// Greatest creep speed at which a body on a joint counts as carried along, as a multiple of the creep speed of the fastest
/// body that contacts press. Pinned by `ground::ragdoll`.
const ALONG: f32 = 2.0;

/// Change of length for which an element is prepared, as a multiple of the distance that its ends can move in the step.
/// Pinned by `ground::ropes`.
const FAR: f64 = 2.0;

/// Why Rapier cannot solve such an element: on links it pushes both bodies at the same point, which turns one of them.
const ON_LINK: &str = "does not act on a link of a multibody while the other end can move too; take SpringAxis::BodyA, or \
                       ImpulseJoint in place of MultibodyJoint";

impl Plan {
    /// Reads a component. Returns whether all its bodies can be moved.
    pub(crate) fn read(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        all: Holding,
        stale: &mut bool,
    ) -> bool {
        let sight = &all.sight();
        self.bodies.clear();
        self.orders.clear();
        self.disturbed = false;
        for b in members.bodies {
            let row = &bodies[*b as usize];
            if step.movable(sight, row.id, stale).is_none() {
                return false;
            }
            self.bodies.extend(sight.body(row.id, &row.user(), true));
        }
        let time = step.plan.time;
        self.jointed = members.bodies.iter().any(|b| {
            let row = &bodies[*b as usize];
            row.has(BodyFlags::JOINTED)
        });
        for e in members.elements {
            self.read_element(*e as usize, step, members, elements, bodies, all);
        }
        self.balance(members, elements, bodies, time);
        for at in 0..self.orders.len() {
            self.act(at, elements, time);
        }
        self.bound(members, bodies);
        true
    }

    /// Reads an element and adds its order. Its bodies must have been read before.
    fn read_element(
        &mut self,
        e: usize,
        step: &Step,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &[BodyRow],
        all: Holding,
    ) {
        let (sight, time) = (&all.sight(), step.plan.time);
        let row = &mut elements[e];
        let has_moved = step.has_moved(row, sight);
        self.disturbed |= row.has(ElementFlags::CHANGED) || has_moved;
        row.flags.remove(ElementFlags::REFITTED);
        let ends = [0, 1].map(|end| step.end(row, end, bodies, sight));
        let is_twist = row.rare.guide.is_twist();
        let found = element(row, ends, &self.bodies).and_then(|element| {
            let line = element.line(&self.bodies)?;
            let turn = Turn::of(&element, &line, &self.bodies, time);
            (turn.is_some() || !is_twist).then_some((element, line, turn))
        });
        let is_linked = row.rare.held.iter().any(|held| match *held {
            Held::Body { body, .. } => all.is_link(body),
            Held::Path { .. } => false,
        });
        if is_linked && row.moves() == 2 && matches!(row.rare.guide, Guide::World(_)) {
            row.trouble
                .set_passing(Some(Fault::new("SpringAxis::World", ON_LINK)));
            return;
        }
        let Some((element, line, turn)) = found else {
            if let Some(inside) = &mut row.inside {
                // While the twist is undefined, the element keeps its last twist.
                inside.slipped = is_twist;
            }
            return;
        };
        if has_moved {
            let slipped = row.inside.as_ref().is_some_and(|inside| inside.slipped);
            row.account_for_leap(if slipped {
                element.angle
            } else {
                line.distance()
            });
        }
        let is_touched = |b: usize| bodies[b].has(BodyFlags::TOUCHED);
        let touched = row.all_movable().any(is_touched);
        self.find_leeway(row, &line, members, bodies, all);
        let inside = row.inside.get_or_insert_default();
        inside.context = members
            .bodies
            .first()
            .map(|b| bodies[*b as usize].rare.context);
        let mut order = Order::new(
            e,
            inside,
            (element, line, turn),
            &self.bodies,
            is_linked,
            time,
        );
        order.apart = self.jointed && !touched;
        self.orders.push(order);
    }

    /// Finds how far joints and contacts let an element move its ends, where they hold one.
    fn find_leeway(
        &self,
        row: &mut ElementRow,
        line: &Line,
        members: &Members,
        bodies: &[BodyRow],
        all: Holding,
    ) {
        let by = [0, 1].map(|end| {
            row.movable(end).map_or((false, false), |b| {
                let body = &bodies[b];
                let is = |flag| body.has(flag);
                (is(BodyFlags::JOINTED), is(BodyFlags::PRESSED))
            })
        });
        if by == [(false, false); 2] {
            if let Some(inside) = &mut row.inside {
                inside.leeway = Leeway::default();
            }
            return;
        }
        let inside = row.inside.get_or_insert_default();
        // The engine finds contacts only within a step, so the result before the first step is provisional.
        let masses = line.holds.map(|hold| {
            let body = hold.body.map(|body| &self.bodies[body]);
            body.map_or(0.0, |body| (body.inverse_mass + body.inertia).element_sum())
        });
        if inside.leeway.is_due(by, masses, inside.rates.is_some()) {
            let on = |body: usize| handle(bodies[members.bodies[body] as usize].id);
            inside.leeway.left = inverse_mass(line, on, all);
            inside.leeway.jointed = if by[0].0 || by[1].0 {
                let contacts = false;
                inverse_mass(line, on, Holding { contacts, ..all }) / line.inverse_mass
            } else {
                1.0
            };
        }
        row.inverse_mass = inside.leeway.left;
    }

    /// Marks bodies that may creep: bodies that contacts press, that hang in balance, or that joints carry along. A body of the
    /// last two kinds only follows the motion of others. Also finds whether the component is tense.
    fn balance(
        &mut self,
        members: &Members,
        elements: &[ElementRow],
        bodies: &mut [BodyRow],
        time: f64,
    ) {
        self.pulls.clear();
        self.pulls.extend(self.bodies.iter().map(|body| {
            let all = body.acceleration.length();
            Pull {
                net: body.acceleration,
                all,
                gain: time * all,
            }
        }));
        for order in &self.orders {
            let elastic = elements[order.row].elastic(order.from);
            let omega = (elastic.stiffness * order.line.inverse_mass).sqrt();
            for (hold, sign) in order.line.holds.iter().zip([1.0, -1.0]) {
                if let Some(body) = hold.body.filter(|_| !hold.twist) {
                    let pull = hold.inverse_mass * (sign * elastic.force * order.line.direction);
                    let on = &mut self.pulls[body];
                    on.net += pull;
                    on.all += pull.length();
                    on.gain += pull.length() * time.min(omega.recip());
                }
            }
        }
        let pressed = members.bodies.iter().map(|b| &bodies[*b as usize]);
        let pressed = pressed.filter(|row| row.has(BodyFlags::PRESSED));
        // Creep speed of the fastest body that contacts press; none if there is no such body.
        let creeping = pressed.map(|row| row.rare.rest.rate).reduce(f32::max);
        let pulled = self.bodies.iter().zip(&self.pulls);
        self.tense = creeping.is_some()
            && pulled.into_iter().any(|(body, pull)| {
                let weight = body.acceleration.length();
                weight > 0.0 && pull.all > TENSE * weight
            });
        for (b, pull) in members.bodies.iter().zip(&self.pulls) {
            let row = &mut bodies[*b as usize];
            let taken_along = creeping.is_some_and(|rate| {
                pull.net.length() < BALANCE * pull.all
                    || (row.has(BodyFlags::JOINTED) && row.rare.rest.rate <= ALONG * rate)
            });
            let creeps = row.has(BodyFlags::PRESSED) || taken_along;
            row.flags.set(BodyFlags::CREEPS, creeps);
        }
    }

    /// Computes the force of an element over the step from the speeds and forces at its ends.
    fn act(&mut self, at: usize, elements: &mut [ElementRow], time: f64) {
        let Self {
            bodies,
            pulls,
            orders,
            ..
        } = self;
        let order = &mut orders[at];
        let (element, line) = (&order.element, &order.line);
        for hold in &line.holds {
            let Some(body) = hold.body else { continue };
            let spin = bodies[body].angular_velocity().length();
            order.reach.speed += if hold.twist {
                spin
            } else {
                bodies[body].velocity.length() + spin * hold.arm.length()
            };
            order.reach.speed += pulls[body].gain;
        }
        order.reach.change = FAR * time * order.reach.speed;
        if element.guide.is_twist() {
            // The torques of springs are not in `pulls`, so allow for one radian more.
            order.reach.change += 1.0;
        }
        order.pieces = match &element.law {
            None => Pieces::linear(element.stiffness, element.damping, element.rest_length),
            Some(law) => Pieces::of(law, element.rest_length, order.reach),
        };
        let Some(inside) = &mut elements[order.row].inside else {
            return;
        };
        let last = inside.rates.map_or(0.0, |rates| rates[0]);
        if inside.debt > 0.0 && last != 0.0 && line.inverse_mass > 0.0 {
            // At most the damping that stops the motion within the step.
            let most = 1.0 / (line.inverse_mass * time);
            order.pieces.spring().damping += (inside.debt / (last * last * time)).min(most);
        }
        inside.begin(order.from, order.pieces, line, order.facings);
    }

    /// Computes upper bounds on the frequency of the stiffest mode. For each body, add stiffness over mass of its elements; ω² is
    /// at most the greatest sum of both bodies of an element, as for a graph's Laplacian (W. Anderson and T. Morley, 1985).
    fn bound(&mut self, members: &Members, bodies: &[BodyRow]) {
        self.sums.clear();
        self.sums.resize(self.bodies.len(), 0.0);
        for order in &self.orders {
            for hold in &order.line.holds {
                if let Some(body) = hold.body {
                    let inverse_mass = hold.most_inverse_mass(&self.bodies);
                    self.sums[body] += order.stiffness().abs() * inverse_mass;
                }
            }
        }
        self.omega = 0.0;
        for order in &mut self.orders {
            let ends = order.line.holds.iter().filter_map(|hold| hold.body);
            order.omega = ends.clone().map(|body| self.sums[body]).sum::<f64>().sqrt();
            let lifted = ends.filter(|body| {
                let row = &bodies[members.bodies[*body] as usize];
                !row.has(BodyFlags::PRESSED)
            });
            order.lively = lifted.map(|body| self.sums[body]).sum::<f64>().sqrt();
            self.omega = self.omega.max(order.omega);
        }
    }

    /// Upper bound on the stiffest mode of the elements with too little damping for substeps of `substep` seconds, rad/s.
    pub(crate) fn undamped(&self, substep: f64) -> f64 {
        let orders = self.orders.iter();
        orders
            .filter(|order| {
                let mut pieces = order.pieces.iter();
                pieces.any(|piece| piece.tangent.is_undamped(substep))
            })
            .map(|order| order.lively)
            .fold(0.0, f64::max)
    }

    /// Whether joints made for substeps of `substep` seconds still have positive damping in finer ones of `finest` seconds.
    pub(crate) fn stands_finer(&self, substep: f64, finest: f64) -> bool {
        let mut pieces = self.orders.iter().flat_map(|order| order.pieces.iter());
        pieces.all(|piece| piece.tangent.damping > (substep - finest) * piece.tangent.stiffness)
    }
}
