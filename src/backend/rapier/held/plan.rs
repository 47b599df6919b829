//! What the engine's solver is to be given for a component: read from its bodies and elements, before anything is written.

use crate::backend::Sight;
use crate::backend::rapier::body::handle;
use crate::backend::rapier::held::linkage::{Holding, inverse_mass};
use crate::backend::rapier::held::order::Order;
use crate::dynamics::body::Body;
use crate::dynamics::element::Element;
use crate::dynamics::line::Line;
use crate::dynamics::pieces::{Outreach, Piece, Pieces};
use crate::scene::element::element;
use crate::scene::held::{Inside, Turn};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Members};
use crate::scene::step::Step;
use bevy::math::DVec3;

/// A component before its step.
#[derive(Default)]
pub(crate) struct Plan {
    pub group: usize,
    pub bodies: Vec<Body>,
    pub orders: Vec<Order>,
    /// Bound on its stiffest mode, rad/s.
    pub omega: f64,
    /// Something about it is new: it must not sleep.
    pub disturbed: bool,
    /// For each body, the stiffness of its elements over its mass,
    sums: Vec<f64>,
    /// and what springs and outside forces do to it.
    pulls: Vec<Pull>,
    /// Joints of the game's hold some body of it.
    jointed: bool,
    /// Springs pull some body to and fro by far more than its weight, while the component rests on something.
    tense: bool,
}

/// What springs and outside forces do to a body.
struct Pull {
    /// Acceleration by all of them, m/s²,
    net: DVec3,
    /// and the sum of their sizes.
    all: f64,
    /// Speed that they can give it over the step, m/s: a spring that swings faster than that turns round before.
    gain: f64,
}

/// Sum of what springs pull at a body, in units of its weight, above which one sweep over all joints leaves it trembling
/// on what it stands on: a tensegrity of struts does, and a bridge of springs under boxes. Pinned by the check of the
/// example `tensegrity` and by `ground::play`.
const TENSE: f64 = 100.0;

/// Sweeps over all joints and contacts in a substep of what is tense, or has forces that end on one side: with two, the
/// bridge still trembles; with one, stiff ropes that fall on the ground win energy (`ground::ropes`). They cost little beside
/// the making of joints in each substep.
const TENSE_SWEEPS: usize = 4;

/// Share of all forces on a body that may be left of them where they are in balance. Pinned by `ground::heap`.
const BALANCE: f64 = 5e-3;

/// How many times as fast as what is pressed a body goes that joints take along. Pinned by `ground::ragdoll`.
const ALONG: f32 = 2.0;

/// Share that joints leave of a damper's inverse mass below which a substep's one sweep over all joints is not enough,
/// where without joints it would take more than such a share of its ends' speed in one substep. Pinned by
/// `ground::hinge`.
const LIGHT: f64 = 0.7;
const DAMPED: f64 = 0.02;

/// Sweeps in a substep there: with one, a lamp's arm rests where its damper still pushes; with four, a bridge on hinges
/// does not come to rest. Pinned by `ground::hinge` and `ground::play`.
const LIGHT_SWEEPS: usize = 2;

/// Times as far as its ends can come at their speed and with what pushes them that an element is ready for. Pinned by
/// `ground::ropes`.
const FAR: f64 = 2.0;

/// (ω·dt)² above which an element that only pulls or only pushes is softened to that: it gives way under the weight of its
/// ends by a thousandth of a millimetre then. Pinned by `ground::ropes`: with 10⁴ it wins energy.
const FIRMEST: f64 = 2.5e3;

/// The same for its damping · dt over mass: its ends creep by 8 mm/s under their weight then. Pinned by `ground::ropes`: with
/// 50 a rope whose damper is firmer than that reaches 20 m/s in its fall.
const DAMPEST: f64 = 20.0;

impl Plan {
    /// Reads a component; says whether all its bodies can be moved.
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

    /// Reads an element, whose bodies have been read: what is to be ordered of the engine for it.
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
        let Some((element, line, turn)) = found else {
            if let Some(inside) = &mut row.inside {
                // Where a twist has no meaning, it keeps the one that it had.
                inside.slipped = is_twist;
            }
            return;
        };
        if has_moved {
            row.account_for_leap(line.distance());
        }
        let is_touched = |b: usize| bodies[b].has(BodyFlags::TOUCHED);
        let touched = row.all_movable().any(is_touched);
        let by = [0, 1].map(|end| {
            row.movable(end).map_or((false, false), |b| {
                let body = &bodies[b];
                let is = |flag| body.has(flag);
                (is(BodyFlags::JOINTED), is(BodyFlags::PRESSED))
            })
        });
        let inside = row.inside.get_or_insert_default();
        inside.context = members
            .bodies
            .first()
            .map(|b| bodies[*b as usize].rare.context);
        if by != [(false, false); 2] {
            // Before its first step the engine knows no contacts.
            if inside.leeway.is_due(by, inside.rates.is_some()) {
                let on = |body: usize| handle(bodies[members.bodies[body] as usize].id);
                inside.leeway.left = inverse_mass(&line, on, all);
                inside.leeway.jointed = if by[0].0 || by[1].0 {
                    let contacts = false;
                    inverse_mass(&line, on, Holding { contacts, ..all }) / line.inverse_mass
                } else {
                    1.0
                };
            }
            row.inverse_mass = inside.leeway.left;
        }
        let mut order = self.order(e, inside, (element, line, turn), touched, time);
        order.apart = self.jointed && !touched;
        self.orders.push(order);
    }

    /// Finds which bodies are pressed, hang in balance, or are taken along by joints: where they go, others take them.
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
        // How fast what lies on something goes, if there is any such body.
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

    /// What an element does over the step.
    fn order(
        &self,
        row: usize,
        inside: &Inside,
        (element, line, turn): (Element, Line, Option<Turn>),
        touched: bool,
        time: f64,
    ) -> Order {
        // A torsion element that has slipped is wound up otherwise than its bodies show.
        let from = if inside.slipped {
            element.angle
        } else {
            line.distance()
        };
        let rate = line.motion(&element, &self.bodies, 0.0).axial;
        // As the last steps went on: the engine's own velocities are those of its last substep.
        let [last, before] = inside.rates.unwrap_or([rate; 2]);
        let ahead = 2.0 * last - before;
        let facings = element
            .ends
            .each_ref()
            .map(|end| end.rotation(&self.bodies));
        let spins = element
            .ends
            .each_ref()
            .map(|end| end.angular_velocity(&self.bodies));
        Order {
            row,
            from,
            facings,
            spins,
            element,
            line,
            pieces: Pieces::default(),
            reach: Outreach {
                way: [from, from + time * ahead],
                rate: ahead,
                change: 0.0,
                speed: rate.abs(),
                firmest: [FIRMEST / (time * time), DAMPEST / time]
                    .map(|most| most / line.inverse_mass),
            },
            omega: 0.0,
            lively: 0.0,
            touched,
            apart: false,
            turn,
            jointed: inside.leeway.jointed,
        }
    }

    /// Finds with what force an element acts over the step, now that it is known what may push its ends.
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
            // What springs turn a body with is not looked at.
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
            // At most what stops the motion within the step.
            let most = 1.0 / (line.inverse_mass * time);
            order.pieces.spring().damping += (inside.debt / (last * last * time)).min(most);
        }
        inside.begin(order.from, order.pieces, line, order.facings);
    }

    /// Bounds on the stiffest mode: ω² is at most the sum over both ends of an element of their elements' stiffness over
    /// mass, as for the Laplacian of a graph (W. Anderson and T. Morley, 1985).
    fn bound(&mut self, members: &Members, bodies: &[BodyRow]) {
        self.sums.clear();
        self.sums.resize(self.bodies.len(), 0.0);
        for order in &self.orders {
            for hold in &order.line.holds {
                if let Some(body) = hold.body {
                    self.sums[body] += order.stiffness().abs() * hold.most_inverse_mass();
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

    /// Bound on the stiffest mode of those elements that have too little damping for substeps of so long, rad/s.
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

    /// How often joints and contacts are to be solved in a substep of so long, for a damper to know what joints leave of a
    /// push, or what other springs do.
    pub(crate) fn sweeps(&self, substep: f64) -> usize {
        let light = |order: &Order| {
            let damping = order.pieces.iter().map(|piece| piece.tangent.damping);
            let damped = damping.sum::<f64>() * order.line.inverse_mass * substep;
            // Where contacts press, the engine's warm start has brought their answer already.
            order.jointed < LIGHT && damped > DAMPED && !order.touched
        };
        let mut pieces = self.orders.iter().flat_map(|order| order.pieces.iter());
        if pieces.any(Piece::ends) || (self.tense && !self.jointed) {
            TENSE_SWEEPS
        } else if self.orders.iter().any(light) {
            LIGHT_SWEEPS
        } else {
            1
        }
    }

    /// Whether its joints may be solved in finer substeps than they are made for.
    pub(crate) fn stands_finer(&self, substep: f64, finest: f64) -> bool {
        let mut pieces = self.orders.iter().flat_map(|order| order.pieces.iter());
        pieces.all(|piece| piece.tangent.damping > (substep - finest) * piece.tangent.stiffness)
    }
}
