// Draws the coil of `tube.wgsl`, which follows this file, in Bevy 0.19; `round_wire.wesl` is its twin for 0.20.

#import bevy_pbr::{
    mesh_functions,
    view_transformations::position_world_to_clip,
}

#ifdef PREPASS_PIPELINE
#import bevy_pbr::prepass_io::{Vertex, VertexOutput}
#else
#import bevy_pbr::forward_io::{Vertex, VertexOutput}
#endif

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> round_wire: RoundWire;

@vertex
fn vertex(in: Vertex) -> VertexOutput {
    var out: VertexOutput;
    let model = mesh_functions::get_world_from_local(in.instance_index);
    let point = placed(model, in.uv);
    out.world_position = vec4(point.position, 1.0);
    out.position = position_world_to_clip(point.position);
    out.uv = in.uv;

#ifdef PREPASS_PIPELINE
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.unclipped_depth = out.position.z;
    out.position.z = min(out.position.z, 1.0);
#endif
#ifdef NORMAL_PREPASS_OR_DEFERRED_PREPASS
    out.world_normal = point.normal;
#ifdef VERTEX_TANGENTS
    out.world_tangent = point.tangent;
#endif
#endif
#ifdef MOTION_VECTOR_PREPASS
    let before = mesh_functions::get_previous_world_from_local(in.instance_index);
    out.previous_world_position = vec4(placed(before, in.uv).position, 1.0);
#endif
#else
    out.world_normal = point.normal;
#ifdef VERTEX_TANGENTS
    out.world_tangent = point.tangent;
#endif
#endif

#ifdef VERTEX_COLORS
    out.color = in.color;
#endif
#ifdef VERTEX_OUTPUT_INSTANCE_INDEX
    out.instance_index = in.instance_index;
#endif
#ifdef VISIBILITY_RANGE_DITHER
    out.visibility_range_dither = mesh_functions::get_visibility_range_dither_level(
        in.instance_index, model[3]);
#endif
    return out;
}

