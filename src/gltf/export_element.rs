//! An element as `BEVY_coilover` writes it: the way back from [`element`](super::element).

use super::number::{Fields, number, numbers, vector};
use crate::element::*;
use bevy::prelude::*;
use serde_json::{Value, json};

/// What an element says, if the entity is one. `node` knows the index of an end's node.
pub(super) fn element(
    entity: EntityRef,
    node: impl Fn(Entity) -> Option<usize>,
    left_out: &mut Vec<String>,
) -> Option<Value> {
    let mut all = Fields::default();
    let mut end = |entity_of: Entity, name: &str| {
        let index = node(entity_of);
        if index.is_none() {
            left_out.push(format!(
                "{}: its {name} is not among what is exported",
                entity.id()
            ));
        }
        index.map_or(Value::Null, |index| json!(index))
    };
    let mut ends = |a: Entity, b: Entity| {
        Fields::default()
            .with("a", end(a, "body_a"))
            .with("b", end(b, "body_b"))
    };
    if let Some(s) = entity.get::<Spring>() {
        let fields = ends(s.body_a, s.body_b)
            .with("stiffness", number(s.stiffness))
            .with("restLength", optional(s.rest_length));
        all.add("spring", fields.value());
    } else if let Some(d) = entity.get::<Damper>() {
        let fields = ends(d.body_a, d.body_b).with("damping", number(d.damping));
        all.add("damper", fields.value());
    } else if let Some(p) = entity.get::<SpringDamper>() {
        let fields = ends(p.body_a, p.body_b)
            .with("stiffness", number(p.stiffness))
            .with("damping", number(p.damping))
            .with("restLength", optional(p.rest_length));
        all.add("springDamper", fields.value());
    } else if let Some(s) = entity.get::<TorsionSpring>() {
        let fields = ends(s.body_a, s.body_b)
            .with("axis", vector(s.axis))
            .with("stiffness", number(s.stiffness))
            .with("restAngle", optional(s.rest_angle));
        all.add("torsionSpring", fields.value());
    } else if let Some(d) = entity.get::<TorsionDamper>() {
        let fields = ends(d.body_a, d.body_b)
            .with("axis", vector(d.axis))
            .with("damping", number(d.damping));
        all.add("torsionDamper", fields.value());
    } else {
        let p = entity.get::<TorsionSpringDamper>()?;
        let fields = ends(p.body_a, p.body_b)
            .with("axis", vector(p.axis))
            .with("stiffness", number(p.stiffness))
            .with("damping", number(p.damping))
            .with("restAngle", optional(p.rest_angle));
        all.add("torsionSpringDamper", fields.value());
    }
    companions(entity, &mut all);
    if entity.contains::<CustomSpringLaw>() || entity.contains::<CustomDampingLaw>() {
        left_out.push(format!(
            "{}: its law is a function, which no file can hold",
            entity.id()
        ));
    }
    Some(all.value())
}

fn optional(x: Option<f32>) -> Value {
    x.map_or(Value::Null, number)
}

fn companions(entity: EntityRef, all: &mut Fields) {
    if let Some(anchors) = entity.get::<Anchors>() {
        let anchors = json!({ "a": vector(anchors.a), "b": vector(anchors.b) });
        all.add("anchors", anchors);
    }
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
        let fields = Fields::default()
            .with("minLength", number(travel.min_length))
            .with("maxLength", number(travel.max_length))
            .with("stopStiffness", number(travel.stop_stiffness))
            .with("progression", number(travel.progression))
            .with("stopDamping", number(travel.stop_damping));
        all.add("springTravel", fields.value());
    }
    match entity.get::<SpringAxis>() {
        Some(SpringAxis::World(axis)) => all.add("springAxis", json!({ "World": vector(*axis) })),
        Some(SpringAxis::BodyA(axis)) => all.add("springAxis", json!({ "BodyA": vector(*axis) })),
        None => {}
    }
    if let Some(Preload(force)) = entity.get() {
        all.add("preload", number(*force));
    }
    if let Some(MaxForce(force)) = entity.get() {
        all.add("maxForce", number(*force));
    }
    if let Some(breakable) = entity.get::<Breakable>() {
        let then = match breakable.then {
            WhenBroken::Despawn => "Despawn",
            WhenBroken::Disable => "Disable",
        };
        let fields = Fields::default()
            .with("force", number(breakable.force))
            .with("length", number(breakable.length))
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
            .with("share", number(pose.share))
            .with("mass", optional(pose.mass));
        all.add("holdPose", fields.value());
    }
    #[cfg(feature = "visual")]
    looks(entity, all);
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

#[cfg(feature = "visual")]
fn looks(entity: EntityRef, all: &mut Fields) {
    use crate::visual::{Coil, Handedness, HelixEnds, ShowSpringGizmos, Telescope};
    let color = |color: Color| numbers(color.to_linear().to_f32_array());
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
            .with("radius", number(coil.radius))
            .with("wireRadius", number(coil.wire_radius))
            .with("turns", number(coil.turns))
            .with("ends", ends.into())
            .with("handedness", hand.into())
            .with("color", color(coil.color))
            .with("fitted", coil.fitted.into());
        all.add("coil", fields.value());
    }
    if let Some(look) = entity.get::<Telescope>() {
        let fields = Fields::default()
            .with("tubeRadius", number(look.tube_radius))
            .with("rodRadius", number(look.rod_radius))
            .with("tubeLength", optional(look.tube_length))
            .with("rodLength", optional(look.rod_length))
            .with("stroke", optional(look.stroke))
            .with("eyes", look.eyes.into())
            .with("bumpRubber", look.bump_rubber.into())
            .with("color", color(look.color))
            .with("fitted", look.fitted.into());
        all.add("telescope", fields.value());
    }
    if let Some(ShowSpringGizmos(shown)) = entity.get() {
        all.add("showSpringGizmos", (*shown).into());
    }
}
