//! Writes an element as Rust code that compiles.

use super::snapshot::{Part, Snapshot};
use crate::element::*;
use bevy::prelude::Vec3;
use std::fmt::Write;

/// Returns the source of a function that spawns the element between two bodies.
pub(crate) fn rust(snapshot: &Snapshot, function: &str, title: &str) -> String {
    let mut parts = vec![part(&snapshot.part)];
    if let Some(Anchors { a, b }) = snapshot.anchors {
        parts.push(format!("Anchors::new({}, {})", vector(a), vector(b)));
    }
    parts.extend(snapshot.spring_law.as_ref().map(spring_law));
    parts.extend(snapshot.damping_law.as_ref().map(damping_law));
    if let Some(action) = snapshot.action {
        parts.push(format!("SpringAction::{action:?}"));
    }
    parts.extend(snapshot.travel.map(travel));
    match snapshot.axis {
        Some(SpringAxis::World(axis)) => parts.push(format!("SpringAxis::World({})", vector(axis))),
        Some(SpringAxis::BodyA(axis)) => parts.push(format!("SpringAxis::BodyA({})", vector(axis))),
        None => {}
    }
    if let Some(Preload(force)) = snapshot.preload {
        parts.push(format!("Preload({})", number(force)));
    }
    if let Some(MaxForce(force)) = snapshot.max_force {
        parts.push(format!("MaxForce({})", number(force)));
    }
    parts.extend(snapshot.breakable.map(breakable));
    // A line break in the title would end the comment.
    let title = title.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut out = format!(
        "/// {title}.\npub fn {function}(commands: &mut Commands, body_a: Entity, body_b: Entity) -> Entity {{\n"
    );
    out += "    commands\n        .spawn((\n";
    for part in parts {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "            {part},");
    }
    out += "        ))\n        .id()\n}\n";
    out
}

/// Turns a title into a function name.
pub(crate) fn function_name(title: &str) -> String {
    let mut name = String::new();
    for letter in title.chars() {
        if letter.is_ascii_alphanumeric() {
            name.push(letter.to_ascii_lowercase());
        } else if !name.ends_with('_') {
            name.push('_');
        }
    }
    let name = name.trim_matches('_');
    format!("spawn_{}", if name.is_empty() { "element" } else { name })
}

fn number(value: f32) -> String {
    if value.is_nan() {
        "f32::NAN".into()
    } else if value == f32::INFINITY {
        "f32::INFINITY".into()
    } else if value == f32::NEG_INFINITY {
        "f32::NEG_INFINITY".into()
    } else {
        format!("{value:?}")
    }
}

fn vector(v: Vec3) -> String {
    match v {
        Vec3::ZERO => "Vec3::ZERO".into(),
        Vec3::X => "Vec3::X".into(),
        Vec3::Y => "Vec3::Y".into(),
        Vec3::Z => "Vec3::Z".into(),
        _ => format!(
            "Vec3::new({}, {}, {})",
            number(v.x),
            number(v.y),
            number(v.z)
        ),
    }
}

fn part(part: &Part) -> String {
    let axis = part.twist().map(vector);
    let axis = axis.map_or(String::new(), |axis| format!(", {axis}"));
    let mut out = format!("{}::new(body_a, body_b{axis})", part.name());
    if let Some(stiffness) = part.stiffness() {
        out += &format!(".with_stiffness({})", number(stiffness));
    }
    if let Some(damping) = part.damping() {
        out += &format!(".with_damping({})", number(damping));
    }
    if let Some(rest) = part.rest() {
        let what = if part.is_torsion() { "angle" } else { "length" };
        out += &format!(".with_rest_{what}({})", number(rest));
    }
    out
}

fn polynomial(p: &Polynomial) -> String {
    let [linear, quadratic, cubic] = [p.linear, p.quadratic, p.cubic].map(number);
    format!("Polynomial::new({linear}, {quadratic}, {cubic})")
}

fn table(table: &ForceTable) -> String {
    let point = |p: &bevy::prelude::Vec2| format!("({}, {})", number(p.x), number(p.y));
    let points: Vec<_> = table.points.iter().map(point).collect();
    if points.is_empty() {
        // An empty list alone does not tell the compiler the type of its items.
        return "Vec::<(f32, f32)>::new()".into();
    }
    format!("[{}]", points.join(", "))
}

fn spring_law(law: &SpringLaw) -> String {
    match law {
        SpringLaw::Linear => "SpringLaw::Linear".into(),
        SpringLaw::Cubic => "SpringLaw::Cubic".into(),
        SpringLaw::Polynomial { pull, push } => {
            format!(
                "SpringLaw::sided({}, {})",
                polynomial(pull),
                polynomial(push)
            )
        }
        SpringLaw::Table(points) => format!("SpringLaw::table({})", table(points)),
    }
}

fn damping_law(law: &DampingLaw) -> String {
    match law {
        DampingLaw::Linear => "DampingLaw::Linear".into(),
        DampingLaw::Sided { bump, rebound } => {
            format!("DampingLaw::sided({}, {})", number(*bump), number(*rebound))
        }
        DampingLaw::Quadratic { linear, quadratic } => format!(
            "DampingLaw::Quadratic {{ linear: {}, quadratic: {} }}",
            number(*linear),
            number(*quadratic)
        ),
        DampingLaw::BlowOff {
            damping,
            knee,
            beyond,
        } => format!(
            "DampingLaw::BlowOff {{ damping: {}, knee: {}, beyond: {} }}",
            number(*damping),
            number(*knee),
            number(*beyond)
        ),
        DampingLaw::Table(points) => format!("DampingLaw::table({})", table(points)),
    }
}

fn travel(travel: SpringTravel) -> String {
    let [min, max, stop] =
        [travel.min_length, travel.max_length, travel.stop_stiffness].map(number);
    let mut out = format!("SpringTravel::new({min}, {max}, {stop})");
    if travel.progression != 0.0 {
        out += &format!(".with_progression({})", number(travel.progression));
    }
    if travel.stop_damping != 0.0 {
        out += &format!(".with_stop_damping({})", number(travel.stop_damping));
    }
    out
}

fn breakable(limit: Breakable) -> String {
    format!(
        "Breakable {{ force: {}, length: {}, then: WhenBroken::{:?} }}",
        number(limit.force),
        number(limit.length),
        limit.then
    )
}
