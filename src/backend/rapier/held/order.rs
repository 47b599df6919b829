//! Computes the joints with which one element acts in Rapier's solver in a step. `plan` makes an [`Order`] for each
//! element; `write` puts its joints into Rapier.

use crate::backend::BodyId;
use crate::dynamics::body::Body;
use crate::dynamics::element::Element;
use crate::dynamics::guide::Guide;
use crate::dynamics::line::{Line, Motion};
use crate::dynamics::pieces::{Outreach, Pieces};
use crate::dynamics::single;
use crate::dynamics::soft::{self, Tangent, ramp};
use crate::scene::held::{Along, Inside, SoftJoint, Turn, WantedJoints};
use crate::scene::rows::{ElementRow, Held};
use bevy::math::{DMat3, DQuat, DVec3, Quat, Vec3};

/// Least damping of a joint, in units of mass / substep. It counts as none, but must not be zero because the engine divides by
/// it. Pinned by `joints::a_door_on_its_hinge_swings_as_a_spring_in_tension_makes_it`.
const NOTHING: f64 = 1e-6;

/// Bound on the impulse of an element, as the change of speed of its ends in one substep, m/s or rad/s. It is far above the
/// engine's cap on speed, so that a light hook can carry a heavy load. Without a bound, joints that contradict each other
/// would drive the impulse up until numbers overflow. Pinned by `attack`.
const SWIFTEST: f64 = 1e7;

/// Rotation of body A in a step, rad, above which the joint's axis is fixed to body B if B turns less than half as far.
/// Pinned by `ground::mixed`.
const TURNS: f64 = 1e-3;

/// Share of the step by which a force that is fixed at the start of the step is taken ahead. The first share is that of the
/// midpoint rule, which keeps energy. The last is that of the implicit rule, which damps what a step cannot follow. Pinned by
/// `ground::mixed`: below a half, energy is gained.
const AHEAD: [f64; 2] = [0.5, 1.0];

/// (ω·dt)² up to which a force that is fixed at the start of the step follows the midpoint rule, and from which on it follows the
/// implicit rule. Pinned by `ground::mixed`.
const FOLLOWED: [f64; 2] = [1.0, 4.0];

/// Stiffness · dt² · [`Order::axis_mobility`] up to which a spring along an axis of the world follows the length that Rapier
/// measures within the step, and from which on its force is fixed at the start of the step. The axis turns in Rapier with a body
/// within the step. If elements turn that body and the other end is far away across the axis, Rapier measures a wrong length, and a
/// stiff spring that followed it could throw both bodies off. Pinned by `ground::beside`.
const DRIFTS: [f64; 2] = [0.1, 1.0];

/// Greatest (ω·dt)² of a force that only pulls or only pushes; a stiffer force is softened to it. Then it yields a thousandth
/// of a millimetre under the weight of its ends. Pinned by `ground::ropes`: with 10⁴ a rope gains energy.
const FIRMEST: f64 = 2.5e3;

/// Greatest damping · dt / mass of a force that only pulls or only pushes; more is reduced to it. Pinned by `ground::ropes`: with 50,
/// a rope with a firmer damper reaches 20 m/s in its fall.
const DAMPEST: f64 = 20.0;

/// Least share of its inverse mass that joints leave to an element, for [`FIRMEST`] and [`DAMPEST`]. A rope on a hook of 0.1 kg that
/// carries 15 kg on a joint may be as firm as one on 15 kg. Otherwise it would yield 150 times as far. With this number, that holds
/// for loads up to ten thousand times the mass of the hook. The bound keeps both limits finite where joints leave nothing; any smaller
/// number but zero does so too. Pinned by `order::tests`.
const LIGHTEST: f64 = 1e-4;

/// One element that acts in this step.
pub(crate) struct Order {
    /// Index of the element's row.
    pub row: usize,
    pub element: Element,
    pub line: Line,
    /// Length at the start of the step, m; twist of a torsion element, rad.
    pub from: f64,
    /// Rotation of the body at each end.
    pub facings: [DQuat; 2],
    /// Angular velocity of the body at each end, rad/s.
    pub spins: [DVec3; 2],
    /// For an axis of the world: the inverse effective mass, 1/kg, of the body at each end if a force along the axis turned it at
    /// the other end. None if elements cannot turn the body.
    pub axis_mobility: [Option<f64>; 2],
    pub pieces: Pieces,
    /// How far its length may change over the step.
    pub reach: Outreach,
    /// Upper bound on the frequency of the stiffest mode in which the element takes part, rad/s.
    pub omega: f64,
    /// Upper bound on the frequency of that mode if bodies under contact pressure do not move, rad/s.
    pub lively: f64,
    /// Whether its damper is a joint of its own that is solved before all springs. Other joints react to a spring only after it
    /// is solved, so a damper must not see the velocities that springs give to bodies on joints. Contacts are warm-started, so
    /// they have already reacted.
    pub apart: bool,
    /// Data of a torsion element in this step; none for other elements.
    pub turn: Option<Turn>,
    /// Share of the element's inverse mass that joints leave.
    pub jointed: f64,
    /// If an end is a link of a multibody: the velocity of end B relative to end A across the line, m/s. On links, Rapier ignores
    /// which axes of a joint are coupled, and how softly it holds them.
    pub on_link: Option<DVec3>,
}

struct Frame {
    bodies: [BodyId; 2],
    anchors: [Vec3; 2],
    rotations: [Quat; 2],
    along: Along,
}

impl Frame {
    /// A joint in this frame. `force` is its force at the length `target`, `most` its greatest force.
    fn joint(
        &self,
        substep: f64,
        [stiffness, damping]: [f64; 2],
        target: f64,
        [force, most]: [f64; 2],
    ) -> SoftJoint {
        SoftJoint {
            bodies: self.bodies,
            anchors: self.anchors,
            rotations: self.rotations,
            along: self.along,
            substep: single(substep),
            stiffness: single(stiffness),
            damping: single(damping),
            target: single(target),
            force: single(force),
            most: single(most),
        }
    }
}

impl Order {
    /// Damping with which it acts in substeps of `substep` seconds, N s/m or N m s/rad.
    pub(crate) fn acting_damping(&self, substep: f64) -> f64 {
        let modes = [self.omega, self.lively];
        let pieces = self.pieces.iter();
        pieces
            .map(|piece| soft::damping(&piece.tangent, modes, substep))
            .sum()
    }

    /// For each end that elements can move: the index of its body, and the root of its inverse mass along the line.
    pub(crate) fn mobilities(&self) -> impl Iterator<Item = (usize, f64)> {
        let holds = self.line.holds.iter().zip(self.line.inverse_masses);
        holds.filter_map(|(hold, inverse_mass)| Some((hold.body?, inverse_mass.sqrt())))
    }

    /// Makes the order of an element. [`Plan`](super::plan::Plan) completes it.
    pub(crate) fn new(
        row: usize,
        inside: &Inside,
        (element, line, turn): (Element, Line, Option<Turn>),
        bodies: &[Body],
        is_linked: bool,
        time: f64,
    ) -> Self {
        // After a slip, the twist of a torsion element differs from the rotation of its bodies.
        let from = if inside.slipped {
            element.angle
        } else {
            line.distance()
        };
        let Motion {
            axial: rate,
            lateral,
            ..
        } = line.motion(&element, bodies, 0.0);
        // Extrapolated from the last two steps, because the engine's velocities are those of its last substep.
        let [last, before] = inside.rates.unwrap_or([rate; 2]);
        let ahead = 2.0 * last - before;
        let facings = element.ends.each_ref().map(|end| end.rotation(bodies));
        let spins = element
            .ends
            .each_ref()
            .map(|end| end.angular_velocity(bodies));
        let axis_mobility = Self::axis_mobility(&element, &line, bodies);
        Self {
            row,
            from,
            facings,
            spins,
            axis_mobility,
            element,
            line,
            pieces: Pieces::default(),
            reach: Outreach {
                way: [from, from + time * ahead],
                rate: ahead,
                change: 0.0,
                speed: rate.abs(),
                firmest: [FIRMEST / (time * time), DAMPEST / time]
                    .map(|most| most / (line.inverse_mass * inside.leeway.jointed.max(LIGHTEST))),
            },
            omega: 0.0,
            lively: 0.0,
            apart: false,
            turn,
            jointed: inside.leeway.jointed,
            on_link: is_linked.then_some(lateral),
        }
    }

    /// Change of the element's coordinate per change of the joint's coordinate. It differs from 1 only for torsion elements,
    /// whose joint measures the angle about the gradient of the twist.
    fn leverage(&self) -> f64 {
        self.turn.as_ref().map_or(1.0, |turn| turn.leverage)
    }

    /// Stiffness with respect to the joint's coordinate, N/m or N m/rad.
    pub(crate) fn stiffness(&self) -> f64 {
        self.leverage().powi(2) * self.pieces.stiffness()
    }

    /// Returns the joints of the element for substeps of `substep` seconds, or none if it has no force. `holders` are the bodies
    /// at both ends, `bodies` those of the plan. It is long because each piece of the law needs the same dozen numbers.
    pub(crate) fn joints(
        &mut self,
        row: &ElementRow,
        holders: [BodyId; 2],
        bodies: &[Body],
        [substep, time]: [f64; 2],
    ) -> Option<WantedJoints> {
        let frame = self.frame(row, holders, time);
        let mobility = self.axis_mobility[self.steadier(time)].unwrap_or(0.0);
        let law = self.element.law.as_ref();
        let across = self
            .turn
            .as_ref()
            .map_or(0.0, |turn| turn.across_damping(time));
        let scale = self.leverage();
        let holds = self.line.holds.iter();
        let inverse_mass: f64 = holds.map(|hold| hold.most_inverse_mass(bodies)).sum();
        let per_speed = (inverse_mass * substep).max(f64::MIN_POSITIVE).recip();
        let (nothing, bound) = (NOTHING * per_speed, SWIFTEST * per_speed);
        let joint = |[stiffness, damping]: [f64; 2], target: f64, [force, most]: [f64; 2]| {
            let square = scale * scale;
            let rates = [square * stiffness, (square * damping).max(nothing)];
            let forces = [scale * force, (scale * most).min(bound)];
            frame.joint(substep, rates, target, forces)
        };
        let mut wanted = WantedJoints::default();
        for (i, piece) in self.pieces.iter().enumerate() {
            let Tangent {
                stiffness, damping, ..
            } = piece.tangent;
            let force = piece.tangent.elastic(self.from);
            if stiffness == 0.0 && damping == 0.0 && force == 0.0 {
                continue;
            }
            let ahead = ramp(stiffness.abs() * mobility * time * time, DRIFTS) * stiffness;
            let stiffness = stiffness - ahead;
            let (middle, most) = piece.middle();
            let apart = self.apart && i == 0 && damping > 0.0 && most == f64::INFINITY;
            let left = Tangent {
                stiffness,
                damping: self.ahead_damping(ahead, time) + if apart { 0.0 } else { damping },
                ..piece.tangent
            };
            let acting = soft::damping(&left, [self.omega, self.lively], substep)
                .max(across * stiffness.abs());
            if let Some(turn) = self.turn.as_mut().filter(|_| i == 0) {
                turn.damping = acting + if apart { damping } else { 0.0 };
            }
            // The joint of a linear element is the same in every step. All others measure from the present length or rotation.
            let (target, offset) = match law {
                _ if self.turn.is_some() => (0.0, force),
                None if ahead == 0.0 => (self.element.rest_length, 0.0),
                _ => (self.from, force),
            };
            if apart {
                wanted.damper = Some(joint([0.0, damping], target, [0.0, most]));
            }
            if middle != 0.0 {
                // The range of a motor's force is symmetric about zero. A second motor, always at its limit, shifts the spring's
                // range.
                wanted.push(joint([0.0; 2], target, [2.0 * middle, middle.abs()]));
            }
            wanted.push(joint([stiffness, acting], target, [offset - middle, most]));
        }
        (!wanted.is_empty()).then_some(wanted)
    }

    /// Index of the end to which the axis of the joint is fixed: an end that elements cannot turn, else the end that turns much
    /// less over the step, else the end that the element can turn less.
    fn steadier(&self, time: f64) -> usize {
        let spins = self.spins.map(|spin| time * spin.length());
        let is_calm = |end: usize| {
            let other = spins[1 - end];
            other > TURNS && spins[end] < 0.5 * other
        };
        match self.axis_mobility {
            [Some(_), None] => 1,
            [None, Some(_)] => 0,
            _ if is_calm(0) || is_calm(1) => usize::from(is_calm(1)),
            [a, b] => usize::from(b < a),
        }
    }

    /// See the field of this name.
    fn axis_mobility(element: &Element, line: &Line, bodies: &[Body]) -> [Option<f64>; 2] {
        let Guide::World(axis) = element.guide else {
            return [None; 2];
        };
        let arm = (line.holds[1].position - line.holds[0].position).cross(axis);
        line.holds.map(|hold| {
            let inverse_inertia = bodies[hold.body?].inverse_inertia();
            (inverse_inertia != DMat3::ZERO).then(|| arm.dot(inverse_inertia * arm))
        })
    }

    /// Damping that makes a force implicit that is fixed at the start of a step, N s/m. With a share of a half, the force does
    /// the work k s₀ Δs + ½ k dt ∫ṡ² dt. By the Cauchy–Schwarz inequality that is at least the change of the spring's energy, so
    /// no motion within the step gains any.
    fn ahead_damping(&self, stiffness: f64, time: f64) -> f64 {
        let phase_squared = stiffness * self.line.inverse_mass * time * time;
        let share = AHEAD[0] + (AHEAD[1] - AHEAD[0]) * ramp(phase_squared, FOLLOWED);
        share * time * stiffness.max(0.0)
    }

    /// Fixes the axis of the joint to one of the bodies. It coincides with `axis`, of the world, in the middle of the step.
    fn fix_axis(&self, frame: &mut Frame, mut axis: DVec3, time: f64) {
        let end = self.steadier(time);
        let half = DQuat::from_scaled_axis(0.5 * time * self.spins[end]);
        axis = (half * self.facings[end]).inverse() * axis;
        if end == 1 {
            frame.bodies.swap(0, 1);
            frame.anchors.swap(0, 1);
            axis = -axis;
        }
        frame.rotations[0] = x_to(axis).as_quat();
    }

    fn frame(&self, row: &ElementRow, holders: [BodyId; 2], time: f64) -> Frame {
        let anchors = row.rare.held.map(|held| match held {
            Held::Body { local, .. } => local.as_vec3(),
            Held::Path { .. } => Vec3::ZERO,
        });
        let mut frame = Frame {
            bodies: holders,
            anchors,
            rotations: [Quat::IDENTITY; 2],
            along: Along::Distance,
        };
        match (self.element.guide, self.on_link) {
            (Guide::Centres, Some(lateral)) => {
                // From end to end as it will be in the middle of the step.
                let [a, b] = self.line.holds.map(|hold| hold.position);
                let axis = b - a + 0.5 * time * lateral;
                frame.along = Along::Slide;
                self.fix_axis(&mut frame, axis.normalize_or(self.line.direction), time);
            }
            (Guide::Centres, None) => {}
            (Guide::OfA(axis), _) => {
                frame.along = Along::Slide;
                frame.rotations[0] = x_to(axis).as_quat();
            }
            (Guide::World(axis), on_link) => {
                frame.along = if on_link.is_some() {
                    Along::Slide
                } else {
                    Along::Apart
                };
                self.fix_axis(&mut frame, axis, time);
            }
            (Guide::Twist(_), _) => {
                frame.along = Along::Twist;
                if let Some(turn) = &self.turn {
                    let first = x_to(turn.axis);
                    let second = turn.relative.inverse() * first;
                    frame.rotations = [first.as_quat(), second.as_quat()];
                }
            }
        }
        frame
    }
}

/// Rotation that takes the x axis to a unit vector.
fn x_to(axis: DVec3) -> DQuat {
    DQuat::from_rotation_arc(DVec3::X, axis)
}

#[cfg(test)]
mod tests;
