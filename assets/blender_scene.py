# SPDX-License-Identifier: MIT OR Apache-2.0
"""Makes `blender_scene.glb`: a car on wishbones, a rope bridge, and one of each element.

    python assets/blender_scene.py [file.glb]

It needs the Python package `bpy`, or runs in Blender: `blender --background --python assets/blender_scene.py`. All
springs are made by the add-on in `blender/`, all bodies and joints are Blender's own.
"""

import math
import sys
from pathlib import Path

import bpy
import addon_utils  # (the line above brings it)
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "blender"))
GRAVITY = 9.81
#: About the Z axis of its object a hinge turns; so Z becomes X, or Y.
ALONG_X, ALONG_Y = (0.0, math.pi / 2, 0.0), (-math.pi / 2, 0.0, 0.0)
PAINTS = {
    "Ground": (0.16, 0.18, 0.17), "Steel": (0.45, 0.47, 0.5), "Rubber": (0.03, 0.03, 0.035),
    "Red": (0.55, 0.03, 0.02), "Wood": (0.36, 0.2, 0.09), "Blue": (0.05, 0.14, 0.4),
}
_meshes = {}


def paint(name):
    found = bpy.data.materials.get(name)
    if found is None:
        found = bpy.data.materials.new(name)
        shader = next(n for n in found.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        shader.inputs["Base Color"].default_value = (*PAINTS[name], 1.0)
        shader.inputs["Roughness"].default_value = 0.5
    return found


def mesh(kind, size, color):
    """A box or a cylinder about Z; equal ones are one."""
    key = (kind, tuple(round(s, 4) for s in size), color)
    if key not in _meshes:
        if kind == "BOX":
            bpy.ops.mesh.primitive_cube_add(size=1.0)
        else:
            bpy.ops.mesh.primitive_cylinder_add(vertices=20, radius=0.5, depth=1.0)
        made = bpy.context.object
        data = made.data
        bpy.data.objects.remove(made)
        for v in data.vertices:
            v.co = [c * s for c, s in zip(v.co, size)]
        data.materials.append(paint(color))
        data.name = f"{kind.title()} {color}"
        _meshes[key] = data
    return _meshes[key]


def body(name, place, size, mass=None, kind="BOX", turn=(0.0, 0.0, 0.0), color="Steel", layers=(1,)):
    """A rigid body; without a mass it stands still."""
    obj = bpy.data.objects.new(name, mesh(kind, size, color))
    bpy.context.collection.objects.link(obj)
    obj.location, obj.rotation_euler = place, turn
    bpy.context.view_layer.objects.active = obj
    bpy.ops.rigidbody.object_add()
    rigid = obj.rigid_body
    rigid.type = "PASSIVE" if mass is None else "ACTIVE"
    rigid.mass = mass or 1.0
    rigid.collision_shape, rigid.friction = kind, 0.9
    rigid.collision_collections = [i + 1 in layers for i in range(20)]
    bpy.context.view_layer.update()
    return obj


def joint(kind, a, b, place, turn=(0.0, 0.0, 0.0)):
    obj = bpy.data.objects.new(f"{kind.title()} {a.name} {b.name}", None)
    bpy.context.collection.objects.link(obj)
    obj.location, obj.rotation_euler, obj.empty_display_size = place, turn, 0.1
    bpy.context.view_layer.objects.active = obj
    bpy.ops.rigidbody.constraint_add()
    rigid = obj.rigid_body_constraint
    rigid.type, rigid.object1, rigid.object2 = kind, a, b
    bpy.context.view_layer.update()


def element(a, b, kind, at=None, **numbers):
    """By the add-on's operator; `at` are its anchors in the world. The new element's properties."""
    bpy.ops.object.select_all(action="DESELECT")
    for obj in (b, a):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = a
    bpy.ops.coilover.between(kind=kind, **numbers)
    made = bpy.context.object
    made.name = f"{kind[0].upper()}{kind[1:]} {a.name} {b.name}"
    made.select_set(False)
    if at is not None:
        made.coilover.anchor_a, made.coilover.anchor_b = (
            obj.matrix_world.inverted() @ Vector(point) for obj, point in zip((a, b), at))
        span = (Vector(at[1]) - Vector(at[0])).length
        made.coilover.coil.radius, made.coilover.coil.wire_radius = 0.1 * span, 0.012 * span
        made.coilover.telescope.tube_radius, made.coilover.telescope.rod_radius = 0.048 * span, 0.02 * span
    return made.coilover


def car(place, mass=600.0, stiffness=40e3, damping=2.5e3):
    """A chassis on four corners of two wishbones, a knuckle, a wheel and a coilover, standing at rest."""
    at = Vector(place)
    wheel_radius, ride = 0.34, 0.42
    chassis = body("Chassis", at + Vector((0, 0, ride + 0.1)), (3.0, 0.9, 0.45), mass, color="Red", layers=(2,))
    for end, x in (("Front", 1.15), ("Rear", -1.15)):
        for side, s in (("Left", 1.0), ("Right", -1.0)):
            name = f"{end} {side}"
            axle = at + Vector((x, s * 0.92, wheel_radius))
            inner, outer = at.y + s * 0.45, at.y + s * 0.82
            low, high = at.z + 0.24, at.z + 0.46

            def arm(label, z):
                middle = Vector((axle.x, 0.5 * (inner + outer), z))
                return body(f"{label} {name}", middle, (0.3, abs(outer - inner), 0.04), 8.0, layers=(3,))

            lower, upper = arm("Lower Wishbone", low), arm("Upper Wishbone", high)
            knuckle = body(f"Knuckle {name}", Vector((axle.x, outer, 0.5 * (low + high))), (0.1, 0.05, 0.26), 10.0,
                           layers=(3,))
            wheel = body(f"Wheel {name}", axle, (2 * wheel_radius, 2 * wheel_radius, 0.2), 18.0, "CYLINDER",
                         ALONG_Y, "Rubber")
            # In Rapier, a cylinder on a box has a contact normal that is up to a degree off, and drives itself.
            wheel.rigid_body.collision_shape = "SPHERE"
            joint("HINGE", chassis, lower, (axle.x, inner, low), ALONG_X)
            joint("HINGE", chassis, upper, (axle.x, inner, high), ALONG_X)
            joint("HINGE", lower, knuckle, (axle.x, outer, low), ALONG_X)
            joint("POINT", upper, knuckle, (axle.x, outer, high))
            joint("HINGE", knuckle, wheel, axle, ALONG_Y)
            foot = Vector((axle.x, inner + 0.7 * (outer - inner), low + 0.02))
            top = Vector((axle.x, inner - s * 0.06, at.z + 0.82))
            made = element(chassis, lower, "springDamper", (top, foot), stiffness=stiffness, damping=damping)
            # The wishbones are level, so the wheel goes up and down with the knuckle. Each metre of it is so much of
            # the spring's length, and by that share the spring has to push harder than the quarter of the chassis weighs.
            along = foot - top
            share = 0.7 * -along.z / along.length
            force = 0.25 * mass * GRAVITY / share
            made.use_rest, made.rest_length = True, along.length + force / stiffness
            made.telescope.eyes = made.telescope.bump_rubber = True


def bridge(place, planks=12, gap=0.08):
    """Planks between two banks, hung on ropes that only pull."""
    at = Vector(place)
    depth, width, mass = 0.3, 1.2, 6.0
    half = 0.5 * planks * (depth + gap) + 0.5 * gap
    banks = [body(f"{name} Bank", at + Vector((x * (half + 0.5), 0, 0.45)), (1.0, 1.6, 0.9), color="Ground")
             for name, x in (("West", -1), ("East", 1))]
    row = [banks[0]]
    for i in range(planks):
        x = -half + gap + (i + 0.5) * depth + i * gap
        row.append(body(f"Plank {i + 1:02}", at + Vector((x, 0, 0.88)), (depth, width, 0.04), mass, color="Wood"))
    row.append(banks[1])
    for a, b in zip(row, row[1:]):
        for y in (-0.5, 0.5):
            right = a.location.x + (0.5 if a in banks else 0.5 * depth)
            left = b.location.x - (0.5 if b in banks else 0.5 * depth)
            ends = (right, at.y + y, at.z + 0.88), (left, at.y + y, at.z + 0.88)
            rope = element(a, b, "springDamper", ends, stiffness=30e3, damping=300.0)
            rope.spring_action.use, rope.spring_action.action = True, "Pull"
            rope.telescope.use = False
            rope.coil.radius, rope.coil.wire_radius, rope.coil.turns, rope.coil.ends = 0.02, 0.006, 5.0, "Open"
            rope.coil.color = (0.3, 0.22, 0.12, 1.0)


def gallery(place):
    """One of each: a spring, a damper, both, and the two that turn."""
    at = Vector(place)
    beam = body("Beam", at + Vector((0, 0, 2.4)), (6.0, 0.3, 0.2), color="Steel")
    for x in (-2.9, 2.9):
        body(f"Post {x:+}", at + Vector((x, 0, 1.15)), (0.2, 0.3, 2.3), color="Steel")
    for x, kind, mass in ((-2.0, "spring", 4.0), (-1.0, "damper", 4.0), (0.0, "springDamper", 4.0)):
        load = body(f"Load {kind}", at + Vector((x, 0, 1.2)), (0.4, 0.4, 0.4), mass, color="Blue")
        ends = at + Vector((x, 0, 2.3)), at + Vector((x, 0, 1.4))
        made = element(beam, load, kind, ends, stiffness=400.0, damping=8.0 if kind == "springDamper" else 200.0)
        made.use_rest, made.rest_length = True, 0.9
    for x, kind in ((1.0, "torsionSpring"), (2.0, "torsionDamper")):
        lever = body(f"Lever {kind}", at + Vector((x, -0.2, 2.4)), (0.7, 0.08, 0.08), 2.0, color="Blue", layers=(4,))
        hub = at + Vector((x - 0.35, -0.2, 2.4))
        joint("HINGE", beam, lever, hub, ALONG_Y)
        made = element(beam, lever, kind, stiffness=25.0, damping=4.0)
        made.axis = (0.0, 1.0, 0.0)


def build():
    """The whole scene, from an empty Blender."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    _meshes.clear()
    addon_utils.enable("bevy_coilover", default_set=True)
    bpy.ops.rigidbody.world_add()
    body("Ground", (0, 0, -0.25), (20.0, 16.0, 0.5), color="Ground", layers=(1, 2, 3, 4))
    car((0, 0, 0))
    bridge((0, 4.0, 0))
    gallery((0, -4.0, 0))
    lamp = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    lamp.rotation_euler, lamp.data.energy = (0.7, 0.2, 0.5), 3.0
    bpy.context.collection.objects.link(lamp)
    bpy.context.view_layer.update()


def write(path):
    bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB", export_texcoords=False, export_lights=False,
                              export_animations=False)


if __name__ == "__main__":
    given = [a for a in sys.argv[1:] if a.endswith(".glb")]
    build()
    write(given[0] if given else HERE / "blender_scene.glb")
