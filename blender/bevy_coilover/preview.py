# SPDX-License-Identifier: MIT OR Apache-2.0
"""Coils and telescopes in the viewport, and as meshes for a picture.

They are worked out anew whenever the window is drawn, so they follow the objects; what has not changed is kept.
"""

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import ends, look, physics, shape
from .fields import is_torsion
from .make import home
from .properties import elements

#: Lengths at the first frame, by which telescopes are fitted, as Bevy does when it first draws them.
_first = {}
#: What has been drawn: name -> (what it follows from, batches).
_drawn = {}
_handle = None


def coil_of(element):
    c = element.coil
    if not c.use:
        return None
    return look.Coil(c.radius, c.wire_radius, c.turns, c.ends, c.handedness, tuple(c.color), c.fitted)


def telescope_of(element):
    t = element.telescope
    if not t.use:
        return None
    given = {name: getattr(t, name) if getattr(t, "use_" + name) else None
             for name in ("tube_length", "rod_length", "stroke")}
    return look.Telescope(t.tube_radius, t.rod_radius, eyes=t.eyes, bump_rubber=t.bump_rubber,
                          color=tuple(t.color), fitted=t.fitted, **given)


def place(element):
    """From the frame of the parts (along +Z from end A) to the world, and the length; None where an end is missing."""
    if is_torsion(element.kind):
        if element.a is None or element.b is None:
            return None
        axis = ends.frame(element.a) @ Vector(element.axis)
        # It has no place of its own, so it is drawn where its object is.
        return Matrix.Translation(element.id_data.matrix_world.translation) @ physics.upright(axis), 0.0
    points = ends.line(element)
    if points is None:
        return None
    along = points[1] - points[0]
    return Matrix.Translation(points[0]) @ physics.upright(along), along.length


def first_length(obj, scene, length):
    """The length at the scene's first frame: what is moved there is designed, later it slides."""
    if scene.frame_current == scene.frame_start or obj.name not in _first:
        _first[obj.name] = length
    return _first[obj.name]


def parts(obj, scene, detail):
    """Solids of an element's object and where they are; None where an end is missing."""
    element = obj.coilover
    placed = place(element)
    if placed is None:
        return None
    matrix, length = placed
    if is_torsion(element.kind):
        size = 0.3 * min(max(element.a.dimensions), max(element.b.dimensions)) or 0.2
        mesh = shape.arc(size, 1.5 * np.pi, 0.04 * size)
        axle = shape.cylinder(0.03 * size, -size, size, 12)
        solids = [look.Part("Coil", mesh, (0.604, 0.0087, 0.006, 1.0)), look.Part("Rod", axle)]
        return matrix, solids
    first = first_length(obj, scene, length)
    return matrix, look.parts(coil_of(element), telescope_of(element), length, first, detail)


def shaded(part, matrix):
    """Colours of the corners under a light from above left: enough to see what is round."""
    light = np.array(Vector((0.35, -0.5, 0.8)).normalized())
    turn = np.array(matrix.to_3x3())
    normals = part.mesh.normals @ turn.T
    bright = 0.35 + 0.65 * np.clip(normals @ light, 0.0, 1.0)
    color = np.array(part.color)
    # Paint that is nearly black would hide its shape.
    lit = np.clip((0.12 + 0.88 * color[:3]) * bright[:, None], 0.0, 1.0) ** (1.0 / 2.2)
    return np.concatenate([lit, np.ones((len(lit), 1))], axis=1)


def detail_of(scene, count):
    """Segments of a turn: fewer where there are many coils, so that a large lattice can still be moved."""
    return max(6, min(scene.coilover.detail, 4000 // max(count, 1)))


def key(obj, matrix, lengths, detail):
    """What a drawing follows from."""
    element = obj.coilover
    return (
        tuple(round(x, 6) for row in matrix for x in row),
        lengths,
        coil_of(element).__repr__(),
        telescope_of(element).__repr__(),
        detail,
        obj.select_get(),
        element.kind,
    )


def draw():
    """In the viewport, after everything else."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    scene = bpy.context.scene
    if not scene.coilover.show:
        return
    name = "SMOOTH_COLOR" if bpy.app.version >= (4, 0, 0) else "3D_SMOOTH_COLOR"
    shader = gpu.shader.from_builtin(name)
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    gpu.state.face_culling_set("NONE")
    seen, all_elements = set(), elements(scene)
    detail = detail_of(scene, len(all_elements))
    for obj in all_elements:
        if not obj.visible_get():
            continue
        placed = place(obj.coilover)
        if placed is None:
            continue
        seen.add(obj.name)
        matrix, length = placed
        now = key(obj, matrix, (round(length, 6), first_length(obj, scene, length)), detail)
        if obj.name not in _drawn or _drawn[obj.name][0] != now:
            batches = []
            for part in parts(obj, scene, detail)[1]:
                world = part.mesh.points @ np.array(matrix.to_3x3()).T + np.array(matrix.translation)
                colors = shaded(part, matrix)
                if obj.select_get():
                    colors[:, :3] = 0.6 * colors[:, :3] + 0.4 * np.array([1.0, 0.55, 0.1])
                content = {"pos": world.astype(np.float32), "color": colors.astype(np.float32)}
                batches.append(batch_for_shader(shader, "TRIS", content, indices=part.mesh.faces))
            _drawn[obj.name] = (now, batches)
        for batch in _drawn[obj.name][1]:
            batch.draw(shader)
    for gone in set(_drawn) - seen:
        del _drawn[gone]
    gpu.state.depth_mask_set(False)
    gpu.state.depth_test_set("NONE")


def material(name, color):
    """A paint of this colour, made once."""
    name = f"Coilover {name} {tuple(round(c, 3) for c in color)}"
    found = bpy.data.materials.get(name)
    if found is None:
        found = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0, 0):
            found.use_nodes = True
        found.diffuse_color = color
        for node in found.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED":
                node.inputs["Base Color"].default_value = color
                node.inputs["Metallic"].default_value = 0.6
                node.inputs["Roughness"].default_value = 0.3
    return found


def mesh_object(part, name):
    """A solid as an object of Blender, not yet in any collection."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(part.mesh.points.tolist(), [], part.mesh.faces.tolist())
    mesh.polygons.foreach_set("use_smooth", [part.name in ("Coil", "Eye A", "Eye B")] * len(mesh.polygons))
    mesh.materials.append(material(part.name, part.color))
    mesh.update()
    return bpy.data.objects.new(name, mesh)


def clear_meshes(obj):
    """Removes what `make_meshes` made."""
    for child in [c for c in obj.children if c.get("coilover_look")]:
        mesh = child.data
        bpy.data.objects.remove(child)
        if mesh is not None and mesh.users == 0:
            bpy.data.meshes.remove(mesh)


def make_meshes(obj, scene, detail=48):
    """The looks of an element as real objects below it, as it lies now. They are left out of a glTF file."""
    clear_meshes(obj)
    placed = parts(obj, scene, detail)
    if placed is None:
        return []
    matrix, solids = placed
    made = []
    for part in solids:
        solid = mesh_object(part, f"{obj.name} {part.name}")
        solid["coilover_look"] = True
        home(scene, obj).objects.link(solid)
        solid.parent = obj
        solid.matrix_parent_inverse = obj.matrix_world.inverted()
        solid.matrix_basis = matrix
        solid.hide_select = True
        made.append(solid)
    return made


def register():
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def unregister():
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _first.clear()
    _drawn.clear()
