//! Reads the companions of an element (the components beside it) from `BEVY_coilover`.

use super::element::KINDS;
use super::json::{Object, Variant, numbers};
use crate::element::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use serde_json::Value;

/// JSON keys of the companions.
const KEYS: [&str; 15] = [
    "anchors",
    "springLaw",
    "dampingLaw",
    "springAction",
    "springTravel",
    "springAxis",
    "preload",
    "maxForce",
    "breakable",
    "springTuning",
    "holdPose",
    "disabled",
    "coil",
    "telescope",
    "showSpringGizmos",
];

/// Inserts all companions that the extension object describes. `kind` is the key of the element.
pub(super) fn insert(object: &Object, kind: &str, entity: &mut EntityWorldMut) {
    let mut known = KEYS.to_vec();
    known.extend(KINDS.map(|(key, _)| key));
    object.only(&known);
    if let Some(anchors) = object.object("anchors") {
        anchors.only(&["a", "b"]);
        let point = |key| anchors.vector(key).unwrap_or_default();
        entity.insert(Anchors::new(point("a"), point("b")));
    }
    if let Some(law) = object
        .variant("springLaw")
        .and_then(|v| spring_law(object, &v))
    {
        entity.insert(law);
    }
    if let Some(law) = object
        .variant("dampingLaw")
        .and_then(|v| damping_law(object, &v))
    {
        entity.insert(law);
    }
    let actions = [
        ("Both", SpringAction::Both),
        ("Pull", SpringAction::Pull),
        ("Push", SpringAction::Push),
    ];
    if let Some(action) = choice(object, "springAction", actions) {
        entity.insert(action);
    }
    if let Some(travel) = object.object("springTravel") {
        // Angles, and lengths along an axis, can be negative. Without a minimum, the least of them is then -∞.
        let signed = kind.starts_with("torsion") || object.has("springAxis");
        entity.insert(spring_travel(&travel, signed));
    }
    if let Some(axis) = object
        .variant("springAxis")
        .and_then(|v| spring_axis(object, &v))
    {
        entity.insert(axis);
    }
    if let Some(preload) = object.number("preload") {
        entity.insert(Preload(preload));
    }
    if let Some(most) = object.number("maxForce") {
        entity.insert(MaxForce(most));
    }
    if let Some(breakable) = object.object("breakable") {
        breakable.only(&["force", "length", "then"]);
        let then = [
            ("Despawn", WhenBroken::Despawn),
            ("Disable", WhenBroken::Disable),
        ];
        entity.insert(Breakable {
            force: breakable.number("force").unwrap_or(f32::INFINITY),
            length: breakable.number("length").unwrap_or(f32::INFINITY),
            then: choice(&breakable, "then", then).unwrap_or_default(),
        });
    }
    if let Some(tuning) = object
        .variant("springTuning")
        .and_then(|v| tuning(object, &v))
    {
        entity.insert(tuning);
    }
    if let Some(pose) = object.object("holdPose") {
        pose.only(&["load", "share", "mass"]);
        let loads = [
            ("Moving", HeldEnd::Moving),
            ("A", HeldEnd::A),
            ("B", HeldEnd::B),
        ];
        entity.insert(HoldPose {
            load: choice(&pose, "load", loads).unwrap_or_default(),
            share: pose.number("share").unwrap_or(1.0),
            mass: pose.number("mass"),
        });
    }
    if object.flag("disabled") == Some(true) {
        entity.insert(Disabled);
    }
    #[cfg(feature = "visual")]
    super::looks::insert(object, entity);
    #[cfg(not(feature = "visual"))]
    for key in ["coil", "telescope", "showSpringGizmos"] {
        if object.has(key) {
            object.tell(key, "needs the feature `visual`; left out");
        }
    }
}

/// Reads a variant that has no data.
pub(super) fn choice<T, const N: usize>(
    object: &Object,
    key: &str,
    choices: [(&str, T); N],
) -> Option<T> {
    let variant = object.variant(key)?;
    let names = choices.each_ref().map(|(name, _)| *name).join(", ");
    let chosen = choices
        .into_iter()
        .find(|(name, _)| variant.data.is_none() && variant.is(name));
    if chosen.is_none() {
        object.tell(key, format_args!("is none of {names}; left out"));
    }
    chosen.map(|(_, value)| value)
}

/// Returns the JSON object that holds the data of a variant.
fn data<'a>(object: &Object<'a>, variant: &Variant<'a>) -> Option<Object<'a>> {
    Object::new(
        variant.data.unwrap_or(&Value::Null),
        variant.place.clone(),
        object.told(),
    )
}

fn unknown(variant: &Variant, object: &Object) {
    object
        .told()
        .tell(&variant.place, "is not a variant that there is; left out");
}

fn spring_law(object: &Object, variant: &Variant) -> Option<SpringLaw> {
    if variant.is("Linear") {
        return Some(SpringLaw::Linear);
    }
    if variant.is("Cubic") {
        return Some(SpringLaw::Cubic);
    }
    if variant.is("Table") {
        return Some(SpringLaw::Table(table(&data(object, variant)?)));
    }
    if !variant.is("Polynomial") {
        unknown(variant, object);
        return None;
    }
    let sides = data(object, variant)?;
    sides.only(&["pull", "push"]);
    let side = |key| {
        let side = sides.object(key);
        side.map_or(Polynomial::default(), |side| {
            side.only(&["linear", "quadratic", "cubic"]);
            let of = |key| side.number(key).unwrap_or(0.0);
            Polynomial::new(of("linear"), of("quadratic"), of("cubic"))
        })
    };
    Some(SpringLaw::sided(side("pull"), side("push")))
}

fn damping_law(object: &Object, variant: &Variant) -> Option<DampingLaw> {
    if variant.is("Linear") {
        return Some(DampingLaw::Linear);
    }
    if variant.is("Table") {
        return Some(DampingLaw::Table(table(&data(object, variant)?)));
    }
    let fields: &[&str] = match variant {
        v if v.is("Sided") => &["bump", "rebound"],
        v if v.is("Quadratic") => &["linear", "quadratic"],
        v if v.is("BlowOff") => &["damping", "knee", "beyond"],
        _ => {
            unknown(variant, object);
            return None;
        }
    };
    let data = data(object, variant)?;
    data.only(fields);
    let of = |key| {
        data.number(key).unwrap_or_else(|| {
            if !data.has(key) {
                data.tell(key, "is missing, and taken as 0");
            }
            0.0
        })
    };
    Some(if variant.is("Sided") {
        DampingLaw::sided(of("bump"), of("rebound"))
    } else if variant.is("Quadratic") {
        DampingLaw::Quadratic {
            linear: of("linear"),
            quadratic: of("quadratic"),
        }
    } else {
        DampingLaw::BlowOff {
            damping: of("damping"),
            knee: of("knee"),
            beyond: of("beyond"),
        }
    })
}

/// Reads a table of points, each an array of two numbers. A malformed point is reported and left out.
fn table(data: &Object) -> ForceTable {
    data.only(&["points"]);
    let mut points = Vec::new();
    for point in data.list("points") {
        match numbers::<2>(point) {
            Some([x, y]) => points.push(Vec2::new(x, y)),
            None => data.tell("points", "has a point that is not two numbers; left out"),
        }
    }
    ForceTable { points }
}

fn spring_travel(travel: &Object, signed: bool) -> SpringTravel {
    let fields = [
        "minLength",
        "maxLength",
        "stopStiffness",
        "progression",
        "stopDamping",
    ];
    travel.only(&fields);
    let of = |key| travel.number(key);
    if !travel.has("stopStiffness") {
        travel.tell("stopStiffness", "is missing, so there is no stop");
    }
    let none = if signed { f32::NEG_INFINITY } else { 0.0 };
    SpringTravel {
        min_length: of("minLength").unwrap_or(none),
        max_length: of("maxLength").unwrap_or(f32::INFINITY),
        stop_stiffness: of("stopStiffness").unwrap_or(0.0),
        progression: of("progression").unwrap_or(0.0),
        stop_damping: of("stopDamping").unwrap_or(0.0),
    }
}

fn spring_axis(object: &Object, variant: &Variant) -> Option<SpringAxis> {
    let axis = variant.data.and_then(numbers).map(Vec3::from_array);
    if axis.is_none() {
        object
            .told()
            .tell(&variant.place, "is not an array of 3 numbers; left out");
    }
    if variant.is("World") {
        axis.map(SpringAxis::World)
    } else if variant.is("BodyA") {
        axis.map(SpringAxis::BodyA)
    } else {
        unknown(variant, object);
        None
    }
}

fn tuning(object: &Object, variant: &Variant) -> Option<SpringTuning> {
    let key = match variant {
        v if v.is("Frequency") => "frequency",
        v if v.is("Sag") => "sag",
        _ => {
            unknown(variant, object);
            return None;
        }
    };
    let data = data(object, variant)?;
    data.only(&[key, "dampingRatio"]);
    let ratio = data.number("dampingRatio").unwrap_or(0.0);
    let Some(value) = data.number(key) else {
        if !data.has(key) {
            data.tell(key, "is missing; the tuning is left out");
        }
        return None;
    };
    Some(if key == "sag" {
        SpringTuning::sag(value, ratio)
    } else {
        SpringTuning::frequency(value, ratio)
    })
}
