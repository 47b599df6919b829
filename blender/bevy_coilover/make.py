# SPDX-License-Identifier: MIT OR Apache-2.0
"""Makes elements and bodies: what the operators, a script and the importer share."""

import bpy
from mathutils import Vector

from . import ends
from .fields import is_torsion
from .properties import dress


def new_element(scene, a, b, kind="springDamper", name=None, collection=None, follow=True):
    """An Empty that is an element from `a` to `b`."""
    obj = bpy.data.objects.new(name or f"{words(kind)} {a.name} {b.name}", None)
    (collection or home(scene, a)).objects.link(obj)
    element = obj.coilover
    element.kind = kind
    element.a, element.b = a, b
    dress(element, kind)
    middle = 0.5 * (a.matrix_world.translation + b.matrix_world.translation)
    obj.location = middle
    span = (a.matrix_world.translation - b.matrix_world.translation).length
    obj.empty_display_size = max(0.05 * span, 0.01)
    fit(element, span)
    if follow:
        # It stays between its ends, where it can be found and clicked.
        for influence, end in ((1.0, a), (1.0 if is_torsion(kind) else 0.5, b)):
            copy = obj.constraints.new("COPY_LOCATION")
            copy.target, copy.influence = end, influence
    return obj


def home(scene, obj):
    """The collection of a scene that an object lies in; the world of rigid bodies has others, which are not drawn."""
    own = {scene.collection, *scene.collection.children_recursive}
    return next((c for c in obj.users_collection if c in own), scene.collection)


def fit(element, span):
    """Looks of a size that goes with the length between the ends; a car's where they fit."""
    if span > 1e-6:
        element.coil.radius, element.coil.wire_radius = 0.1 * span, 0.012 * span
        element.telescope.tube_radius, element.telescope.rod_radius = 0.048 * span, 0.02 * span


def words(kind):
    return {"spring": "Spring", "damper": "Damper", "springDamper": "Coilover"}.get(kind, "Torsion")


def chain(start, others, closed=False):
    """Pairs from each object to the nearest that is left, from `start` on."""
    left, pairs, here = list(others), [], start
    while left:
        there = min(left, key=lambda o: ((o.matrix_world.translation - here.matrix_world.translation).length, o.name))
        left.remove(there)
        pairs.append((here, there))
        here = there
    if closed and len(pairs) > 1:
        pairs.append((here, start))
    return pairs


def make_bodies(context, objects, passive=(), mass=1.0, shape="SPHERE"):
    """Gives mesh objects rigid bodies."""
    scene = context.scene
    if scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
    world = scene.rigidbody_world
    if world.collection is None:
        world.collection = bpy.data.collections.new("RigidBodyWorld")
    fixed = set(passive)
    for obj in objects:
        # Linking to the world's collection makes a body, in one go for thousands.
        if obj.name not in world.collection.objects:
            world.collection.objects.link(obj)
    context.view_layer.update()
    for obj in objects:
        if obj.rigid_body is None:
            with context.temp_override(object=obj, active_object=obj, selected_objects=[obj]):
                bpy.ops.rigidbody.object_add()
        obj.rigid_body.type = "PASSIVE" if obj in fixed else "ACTIVE"
        obj.rigid_body.collision_shape = shape
        obj.rigid_body.mass = mass
        obj.rigid_body.use_deactivation = False


def ball_mesh(radius):
    """One small ball for all corners of a lattice."""
    import bmesh

    mesh = bpy.data.meshes.new("Lattice Ball")
    work = bmesh.new()
    bmesh.ops.create_icosphere(work, subdivisions=1, radius=radius)
    work.to_mesh(mesh)
    work.free()
    return mesh


def lattice(context, source, kind, total_mass, radius, pinned, diagonals, stiffness, damping):
    """A ball for each corner of a mesh and an element for each edge that can move; the balls and the elements."""
    mesh = source.data
    collection = bpy.data.collections.new(source.name + " Springs")
    context.scene.collection.children.link(collection)
    points = [source.matrix_world @ v.co for v in mesh.vertices]
    edges = [tuple(e.vertices) for e in mesh.edges]
    if diagonals:
        known = {tuple(sorted(e)) for e in edges}
        for face in mesh.polygons:
            corners = list(face.vertices)
            for i in range(len(corners)):
                for j in range(i + 2, len(corners)):
                    pair = tuple(sorted((corners[i], corners[j])))
                    if pair not in known:
                        known.add(pair)
                        edges.append(pair)
    ball = ball_mesh(radius)
    balls = []
    for i, point in enumerate(points):
        obj = bpy.data.objects.new(f"{source.name} {i:03}", ball)
        obj.location = point
        collection.objects.link(obj)
        balls.append(obj)
    context.view_layer.update()
    fixed = [balls[i] for i in pinned]
    make_bodies(context, balls, fixed, total_mass / max(len(balls), 1))
    made, still = [], set(pinned)
    for i, j in edges:
        if i in still and j in still:
            # Between two corners that are held nothing can move.
            continue
        obj = new_element(context.scene, balls[i], balls[j], kind, f"{source.name} {i:03}-{j:03}", collection, False)
        obj.coilover.stiffness, obj.coilover.damping = stiffness, damping
        made.append(obj)
    return balls, made


def pins(source, group):
    """Corners of a mesh that are held: those of a vertex group, or without a name those that are selected."""
    if group:
        found = source.vertex_groups.get(group)
        if found is None:
            raise ValueError(f"{source.name} has no vertex group {group}")
        return [v.index for v in source.data.vertices
                if any(g.group == found.index and g.weight > 0.0 for g in v.groups)]
    chosen = [v.index for v in source.data.vertices if v.select]
    # A mesh that was just made has all of them selected; nobody means that.
    return chosen if len(chosen) < len(source.data.vertices) else []


def anchor_at(element, end, point):
    """Holds an end at a point of the world."""
    obj = getattr(element, end)
    setattr(element, "anchor_" + end, obj.matrix_world.inverted_safe() @ Vector(point))


def take_rest(element):
    """The length of now becomes the rest length."""
    found = ends.length(element)
    if found is not None:
        element.use_rest, element.rest_length = True, found
