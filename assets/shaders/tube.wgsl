// The shape of a coil whose wire stays round at any stretch; `round_wire.wgsl` and `round_wire.wesl` draw it, each in
// the language of another version of Bevy.
//
// A mesh scaled between two ends would flatten or fatten its wire. This rebuilds the tube from the mesh's
// UVs and the length of the model matrix's columns, so that one mesh and one material serve all springs of
// a shape. `src/visual/helix/wire.rs` has the same formula in Rust, with what it is derived from.

struct RoundWire {
    // Coil radius and wire radius (m), turns, length of the mesh where its model is not scaled (m).
    shape: vec4<f32>,
    // +1 right-handed or -1 left-handed; ends: 0 open, 1 closed, 2 closed and ground; two spares.
    style: vec4<f32>,
}

const TAU: f32 = 6.283185307179586;
const DEAD: f32 = 1.0;
const BLEND: f32 = 0.5;
// Least divisors, so that a coil without size has no extent. Otherwise its positions would be no numbers.
const LEAST_SIZE: f32 = 1e-9;
const LEAST_SCALE: f32 = 1e-20;

struct Point {
    position: vec3<f32>,
    normal: vec3<f32>,
    tangent: vec4<f32>,
}

// The vector at unit length; zero if it has no length.
fn unit(v: vec3<f32>) -> vec3<f32> {
    return v / max(length(v), LEAST_SCALE);
}

// Without scale: a point in the coil's own frame, for a coil of this radius, wire radius and length.
fn tube(radius: f32, wire_radius: f32, length: f32, uv: vec2<f32>) -> Point {
    let turns = round_wire.shape.z;
    let hand = round_wire.style.x;
    let open = round_wire.style.y < 0.5;
    let ground = round_wire.style.y > 1.5;
    let dead = select(min(DEAD, turns / 4.0), 0.0, open);
    let blend = select(min(BLEND, (turns - 2.0 * dead) / 4.0), 0.0, open);

    let around = max(TAU * radius, LEAST_SIZE);
    var end_pitch = 0.0;
    var pitch = 0.0;
    var start = 0.0;
    var rise = 0.0;
    for (var i = 0u; i < 3u; i += 1u) {
        let slope = end_pitch / around;
        start = select(wire_radius * inverseSqrt(1.0 + slope * slope), 0.0, ground);
        rise = max(length - 2.0 * start, 0.0);
        let even = rise / turns;
        end_pitch = select(min(even, 2.0 * wire_radius), even, open);
        pitch = (rise - end_pitch * (2.0 * dead + blend)) / (turns - 2.0 * dead - blend);
    }

    let turn = uv.x * turns;
    let lower = turn <= turns - turn;
    let near = max(min(turn, turns - turn), 0.0);
    // Selections instead of branches: Mesa's software driver of 2022 crashes on the latter here.
    let more = pitch - end_pitch;
    let blended = clamp(near - dead, 0.0, blend);
    let share = select(blended / max(blend, 1e-6), 1.0, near >= dead + blend);
    let here = end_pitch + more * share;
    let climbed = end_pitch * near + more * (0.5 * blended * share + max(near - dead - blend, 0.0));
    let above = start + climbed;
    let height = select(2.0 * start + rise - above, above, lower);

    // The angle modulo a turn first: sine and cosine of large numbers are coarse on some cards.
    let angle = TAU * fract(turn);
    let steep = here / around;
    let cosine = inverseSqrt(1.0 + steep * steep);
    let outward = vec3(cos(angle), 0.0, -hand * sin(angle));
    let tangent = cosine * vec3(-sin(angle), steep, -hand * cos(angle));
    let upward = hand * cross(outward, tangent);
    let center = radius * outward + vec3(0.0, height, 0.0);

    // What a ground end leaves of the section.
    let cut = select(-1.0, max(-above / max(wire_radius * cosine, LEAST_SIZE), -1.0), ground);
    let low = select(-1.0, cut, lower);
    let high = select(-cut, 1.0, lower);

    let across = cos(TAU * uv.y);
    let along = sin(TAU * uv.y);
    let kept = clamp(along, low, high);
    let round = across * outward + along * upward;
    let flat_down = select(round, vec3(0.0, -1.0, 0.0), along < kept);
    let normal = select(flat_down, vec3(0.0, 1.0, 0.0), along > kept);

    // The caps of the ends.
    let cap = uv.y > 1.5;
    let rim = center + wire_radius * (across * outward + kept * upward);
    let middle = center + wire_radius * 0.5 * (low + high) * upward;
    var out: Point;
    out.position = select(rim, middle, uv.y > 3.5);
    out.normal = select(normal, select(tangent, -tangent, uv.x < 0.5), cap);
    out.tangent = select(vec4(tangent, hand), vec4(outward, 1.0), cap);
    return out;
}

// In the world: the model matrix gives place and turn, the lengths of its columns give size and stretch.
fn placed(model: mat4x4<f32>, uv: vec2<f32>) -> Point {
    let size = length(model[0].xyz);
    let stretched = length(model[1].xyz);
    let local = tube(
        round_wire.shape.x * size,
        round_wire.shape.y * size,
        round_wire.shape.w * stretched,
        uv,
    );
    // The axis of a coil that is flattened altogether is across its other two.
    let flattened = stretched < LEAST_SCALE;
    let across = unit(model[0].xyz);
    let along = select(unit(model[1].xyz), unit(cross(model[2].xyz, model[0].xyz)), flattened);
    let turned = mat3x3<f32>(across, along, unit(cross(across, along)));
    var out: Point;
    out.position = turned * local.position + model[3].xyz;
    out.normal = unit(turned * local.normal);
    out.tangent = vec4(unit(turned * local.tangent.xyz), local.tangent.w);
    return out;
}
