//! Writes an element as `BEVY_coilover`; [`element`](super::element) reads it back.

use super::ends::{count, framed_ends, is_torsion, written_ends};
use super::expand::{owner, still_body};
use super::left_out::LeftOut;
use super::number::{Fields, not_finite, number, numbers, vector};
use super::place::{matrix, place};
use crate::element::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_rapier3d::prelude::RigidBody;
use serde_json::{Value, json};

/// Returns the extension object of an element; `None` if the entity is not an element, or is one with a fault that the file
/// cannot hold. Such an element did not act, and without the fault it would. `node` returns the index of an end's node.
pub(super) fn element(
    entity: EntityRef,
    world: &World,
    node: impl Fn(Entity) -> Option<usize>,
    left_out: &mut LeftOut,
) -> Option<Value> {
    let [a, b] = written_ends(entity, world)?;
    if count(entity) > 1 {
        left_out.tell(
            entity,
            "several elements on one entity do not act; none is written",
        );
        return None;
    }
    if entity.contains::<EndNames>() && (node(a).is_none() || node(b).is_none()) {
        left_out.tell(entity, "EndNames is not written");
    }
    let mut end = |entity_of: Entity, name: &str| {
        let index = node(entity_of);
        if index.is_none() {
            let what = format_args!("its {name} is not among what is exported");
            left_out.tell(entity, what);
        }
        index.map_or(Value::Null, |index| json!(index))
    };
    let ends = Fields::default()
        .with("a", end(a, "body_a"))
        .with("b", end(b, "body_b"));
    let mut all = Fields::default();
    if let Some(s) = entity.get::<Spring>() {
        let fields = ends
            .number("stiffness", s.stiffness)
            .number("restLength", s.rest_length);
        all.add("spring", fields.value());
    } else if let Some(d) = entity.get::<Damper>() {
        let fields = ends.number("damping", d.damping);
        all.add("damper", fields.value());
    } else if let Some(p) = entity.get::<SpringDamper>() {
        let fields = ends
            .number("stiffness", p.stiffness)
            .number("damping", p.damping)
            .number("restLength", p.rest_length);
        all.add("springDamper", fields.value());
    } else if let Some(s) = entity.get::<TorsionSpring>() {
        let fields = ends
            .with("axis", vector(s.axis))
            .number("stiffness", s.stiffness)
            .number("restAngle", s.rest_angle);
        all.add("torsionSpring", fields.value());
    } else if let Some(d) = entity.get::<TorsionDamper>() {
        let fields = ends
            .with("axis", vector(d.axis))
            .number("damping", d.damping);
        all.add("torsionDamper", fields.value());
    } else {
        let p = entity.get::<TorsionSpringDamper>()?;
        let fields = ends
            .with("axis", vector(p.axis))
            .number("stiffness", p.stiffness)
            .number("damping", p.damping)
            .number("restAngle", p.rest_angle);
        all.add("torsionSpringDamper", fields.value());
    }
    if let Some(anchors) = anchors(entity, [a, b], world, left_out) {
        let anchors = json!({ "a": vector(anchors.a), "b": vector(anchors.b) });
        all.add("anchors", anchors);
    }
    companions(entity, &mut all);
    #[cfg(feature = "visual")]
    looks(entity, &mut all, left_out);
    if entity.contains::<Disabled>() {
        all.add("disabled", true.into());
    }
    if entity.contains::<CustomSpringLaw>() || entity.contains::<CustomDampingLaw>() {
        left_out.tell(entity, "its law is a function, which no file can hold");
    }
    tell_frames(entity, world, left_out);
    let all = all.value();
    if let Some(field) = not_finite(&all) {
        let what = format_args!("its {field} is NaN or infinite, so it does not act; not written");
        left_out.tell(entity, what);
        return None;
    }
    Some(all)
}

/// Tells of an end on a fixed body whose frame is another one after a file. A file has no fixed bodies: an element that
/// needs one gets the node that [`still_body`] finds.
fn tell_frames(entity: EntityRef, world: &World, left_out: &mut LeftOut) {
    for end in framed_ends(entity) {
        let Some(body) = owner(world, end) else {
            continue;
        };
        let frames = [body, still_body(world, end)].map(|body| place(world, body));
        let [Some(now), Some(then)] = frames else {
            continue;
        };
        let is_fixed = world.get::<RigidBody>(body) == Some(&RigidBody::Fixed);
        if is_fixed && now.rotation.angle_between(then.rotation) > 1e-3 {
            let what = "the fixed body of an end comes back on a node that is turned against it";
            left_out.tell(entity, what);
        }
    }
}

/// Returns the anchors of an element. `WorldAnchors` that wait for the next step are converted to the frames of the
/// ends, as that step would do.
fn anchors(
    entity: EntityRef,
    ends: [Entity; 2],
    world: &World,
    left_out: &mut LeftOut,
) -> Option<Anchors> {
    let given = entity.get::<Anchors>().copied();
    let Some(points) = entity.get::<WorldAnchors>() else {
        return given;
    };
    let local = |end: Entity, point: Vec3| {
        let end = matrix(world, end)?.affine();
        Some(end.inverse().transform_point3(point))
    };
    let found = local(ends[0], points.a).zip(local(ends[1], points.b));
    if found.is_none() {
        left_out.tell(entity, "WorldAnchors are not written: an end is nowhere");
    }
    found.map(|(a, b)| Anchors::new(a, b)).or(given)
}

/// Returns a limit, or `None` where it is the value that stands for no limit.
fn limit(x: f32, none: f32) -> Option<f32> {
    (x != none).then_some(x)
}

fn companions(entity: EntityRef, all: &mut Fields) {
    if let Some(law) = entity.get::<SpringLaw>() {
        all.add("springLaw", spring_law(law));
    }
    if let Some(law) = entity.get::<DampingLaw>() {
        all.add("dampingLaw", damping_law(law));
    }
    if let Some(action) = entity.get::<SpringAction>() {
        let name = match action {
            SpringAction::Both => "Both",
            SpringAction::Pull => "Pull",
            SpringAction::Push => "Push",
        };
        all.add("springAction", name.into());
    }
    if let Some(travel) = entity.get::<SpringTravel>() {
        // Where lengths have no sign, this is a fault, and it would be read as 0.
        let signed = is_torsion(entity) || entity.contains::<SpringAxis>();
        let min = limit(travel.min_length, f32::NEG_INFINITY);
        let fields = Fields::default()
            .number("minLength", min.or((!signed).then_some(travel.min_length)))
            .number("maxLength", limit(travel.max_length, f32::INFINITY))
            .number("stopStiffness", travel.stop_stiffness)
            .number("progression", travel.progression)
            .number("stopDamping", travel.stop_damping);
        all.add("springTravel", fields.value());
    }
    match entity.get::<SpringAxis>() {
        Some(SpringAxis::World(axis)) => all.add("springAxis", json!({ "World": vector(*axis) })),
        Some(SpringAxis::BodyA(axis)) => all.add("springAxis", json!({ "BodyA": vector(*axis) })),
        None => {}
    }
    if let Some(Preload(force)) = entity.get() {
        all.add_number("preload", *force);
    }
    if let Some(MaxForce(force)) = entity.get() {
        all.add_number("maxForce", limit(*force, f32::INFINITY));
    }
    if let Some(breakable) = entity.get::<Breakable>() {
        let then = match breakable.then {
            WhenBroken::Despawn => "Despawn",
            WhenBroken::Disable => "Disable",
        };
        let fields = Fields::default()
            .number("force", limit(breakable.force, f32::INFINITY))
            .number("length", limit(breakable.length, f32::INFINITY))
            .with("then", then.into());
        all.add("breakable", fields.value());
    }
    match entity.get::<SpringTuning>() {
        Some(SpringTuning::Frequency {
            frequency,
            damping_ratio,
        }) => all.add(
            "springTuning",
            json!({ "Frequency": { "frequency": number(*frequency), "dampingRatio": number(*damping_ratio) } }),
        ),
        Some(SpringTuning::Sag { sag, damping_ratio }) => all.add(
            "springTuning",
            json!({ "Sag": { "sag": number(*sag), "dampingRatio": number(*damping_ratio) } }),
        ),
        None => {}
    }
    if let Some(pose) = entity.get::<HoldPose>() {
        let load = match pose.load {
            HeldEnd::Moving => "Moving",
            HeldEnd::A => "A",
            HeldEnd::B => "B",
        };
        let fields = Fields::default()
            .with("load", load.into())
            .number("share", pose.share)
            .number("mass", pose.mass);
        all.add("holdPose", fields.value());
    }
}

fn table(table: &ForceTable) -> Value {
    let points = table.points.iter().map(|p| numbers(p.to_array()));
    json!({ "Table": { "points": points.collect::<Value>() } })
}

fn spring_law(law: &SpringLaw) -> Value {
    let side = |p: &Polynomial| {
        json!({
            "linear": number(p.linear), "quadratic": number(p.quadratic), "cubic": number(p.cubic),
        })
    };
    match law {
        SpringLaw::Linear => "Linear".into(),
        SpringLaw::Cubic => "Cubic".into(),
        SpringLaw::Polynomial { pull, push } => {
            json!({ "Polynomial": { "pull": side(pull), "push": side(push) } })
        }
        SpringLaw::Table(points) => table(points),
    }
}

fn damping_law(law: &DampingLaw) -> Value {
    match law {
        DampingLaw::Linear => "Linear".into(),
        DampingLaw::Sided { bump, rebound } => {
            json!({ "Sided": { "bump": number(*bump), "rebound": number(*rebound) } })
        }
        DampingLaw::Quadratic { linear, quadratic } => {
            json!({ "Quadratic": { "linear": number(*linear), "quadratic": number(*quadratic) } })
        }
        DampingLaw::BlowOff {
            damping,
            knee,
            beyond,
        } => {
            json!({ "BlowOff": {
                "damping": number(*damping), "knee": number(*knee), "beyond": number(*beyond),
            } })
        }
        DampingLaw::Table(points) => table(points),
    }
}

/// Adds what is drawn of an element. A part that cannot be drawn, because a number is not finite, is left out alone.
#[cfg(feature = "visual")]
fn looks(entity: EntityRef, all: &mut Fields, left_out: &mut LeftOut) {
    use crate::visual::{Coil, Handedness, HelixEnds, ShowSpringGizmos, Telescope};
    let color = |color: Color| numbers(color.to_linear().to_f32_array());
    let mut add = |key: &str, look: Value| match not_finite(&look) {
        Some(field) => {
            let what = format_args!("the {field} of its {key} is NaN or infinite; not written");
            left_out.tell(entity, what);
        }
        None => all.add(key, look),
    };
    if let Some(coil) = entity.get::<Coil>() {
        let ends = match coil.ends {
            HelixEnds::Open => "Open",
            HelixEnds::Closed => "Closed",
            HelixEnds::ClosedGround => "ClosedGround",
        };
        let hand = match coil.handedness {
            Handedness::Right => "Right",
            Handedness::Left => "Left",
        };
        let fields = Fields::default()
            .number("radius", coil.radius)
            .number("wireRadius", coil.wire_radius)
            .number("turns", coil.turns)
            .with("ends", ends.into())
            .with("handedness", hand.into())
            .with("color", color(coil.color))
            .with("fitted", coil.fitted.into());
        add("coil", fields.value());
    }
    if let Some(look) = entity.get::<Telescope>() {
        let fields = Fields::default()
            .number("tubeRadius", look.tube_radius)
            .number("rodRadius", look.rod_radius)
            .number("tubeLength", look.tube_length)
            .number("rodLength", look.rod_length)
            .number("stroke", look.stroke)
            .with("eyes", look.eyes.into())
            .with("bumpRubber", look.bump_rubber.into())
            .with("color", color(look.color))
            .with("fitted", look.fitted.into());
        add("telescope", fields.value());
    }
    if let Some(ShowSpringGizmos(shown)) = entity.get() {
        all.add("showSpringGizmos", (*shown).into());
    }
}
