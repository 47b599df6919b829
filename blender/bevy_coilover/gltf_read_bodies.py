# SPDX-License-Identifier: MIT OR Apache-2.0
"""Bodies and joints that this add-on wrote, back into Blender's rigid bodies.

Of other writers' files it reads what Blender has words for: motion, one collider per mesh, friction, and joints between
frames that this add-on made.
"""

import bpy

from .gltf_bodies import BODIES, SHAPES
from .gltf_joints import AXIS, MARK, turned
from .tree import parents, steps

#: What Python raises where a file lacks something, or has something of another kind.
WRONG = (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError)
KIND = {"box": "BOX", "sphere": "SPHERE", "capsule": "CAPSULE"}


def table(x):
    """An object inside of an extension or extras; an empty one in place of anything else."""
    return x if isinstance(x, dict) else {}


def item(items, index):
    """An item of a list of the file. In Python, -1 would be the last one."""
    if index < 0:
        raise IndexError(f"no item {index}")
    return items[index]


def shape_kind(collider, shapes):
    """Blender's shape of a collider."""
    geometry = collider.get("geometry", {})
    if "shape" in geometry:
        shape = item(shapes, geometry["shape"])
        if shape["type"] == "cylinder":
            return "CONE" if shape.get("cylinder", {}).get("radiusTop") == 0.0 else "CYLINDER"
        return KIND.get(shape["type"], "CONVEX_HULL")
    return "CONVEX_HULL" if geometry.get("convexHull") else "MESH"


def activate(obj):
    """Operators act on the active object. (An overridden context crashes Blender 5.0's `constraint_add`.)"""
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = obj


def new_body(obj):
    scene = bpy.context.scene
    if scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
    activate(obj)
    bpy.ops.rigidbody.object_add()
    return obj.rigid_body


def weigh(obj):
    """Gives a body the mass of its shape at the density of water, as the crate does where a file gives none."""
    selected = list(bpy.context.selected_objects)
    for other in selected:
        other.select_set(False)
    obj.select_set(True)
    bpy.ops.rigidbody.mass_calculate(material="Custom", density=1000.0)
    obj.select_set(False)
    for other in selected:
        other.select_set(True)


def read_body(obj, said, root, shapes):
    rigid = new_body(obj)
    motion, collider = said.get("motion"), said.get("collider")
    if motion is None:
        rigid.type = "PASSIVE"
    elif motion.get("isKinematic"):
        rigid.type, rigid.kinematic = "PASSIVE", True
    else:
        rigid.type = "ACTIVE"
        rigid.mass = motion.get("mass", rigid.mass)
    if collider is None:
        rigid.collision_shape = "COMPOUND"
        return
    rigid.collision_shape = shape_kind(collider, shapes)
    if rigid.type == "ACTIVE" and "mass" not in motion:
        weigh(obj)
    if "physicsMaterial" in collider:
        material = item(root["physicsMaterials"], collider["physicsMaterial"])
        # The defaults of the specification's schema.
        rigid.friction = material.get("dynamicFriction", 0.6)
        rigid.restitution = material.get("restitution", 0.0)
    if "collisionFilter" in collider:
        touching = item(root["collisionFilters"], collider["collisionFilter"])
        systems = touching.get("collisionSystems", [])
        numbers = {int(n) for s in systems if s.startswith("layers") for n in s.split()[1:] if n.isdigit()}
        if systems and systems[0].startswith("layers"):
            rigid.collision_collections = [i + 1 in numbers for i in range(20)]


def limited(said, kind):
    """Axis -> (low, high) of the limits of one kind that have one axis, and the axes that are held."""
    names = {number: name for name, number in AXIS.items()}
    free, locked = {}, set()
    for limit in said.get("limits", []):
        axes = limit.get(kind + "Axes", [])
        low, high = limit.get("min"), limit.get("max")
        if len(axes) == 1:
            free[names[axes[0]]] = (low, high)
        if low == 0.0 and high == 0.0:
            locked |= {names[a] for a in axes}
    return free, locked


def constraint_type(said):
    """Which of Blender's constraints has these limits."""
    lin, ang = limited(said, "linear")[1], limited(said, "angular")[1]
    if said.get("drives"):
        return "GENERIC_SPRING"
    if lin == set("xyz"):
        return {"xyz": "FIXED", "": "POINT", "xy": "HINGE"}.get("".join(sorted(ang)), "GENERIC")
    if lin == set("yz"):
        return {"xyz": "SLIDER", "yz": "PISTON"}.get("".join(sorted(ang)), "GENERIC")
    return "GENERIC"


def read_joint(obj, said, first, second, collide):
    # What is wrong with the limits shows here, before there is a constraint.
    constraint = constraint_type(said)
    activate(obj)
    bpy.ops.rigidbody.constraint_add()
    rigid = obj.rigid_body_constraint
    rigid.type = constraint
    rigid.object1, rigid.object2 = first, second
    rigid.disable_collisions = not collide
    for part, kind in (("lin", "linear"), ("ang", "angular")):
        free, locked = limited(said, kind)
        if rigid.type in ("GENERIC", "GENERIC_SPRING"):
            free.update({name: (0.0, 0.0) for name in locked})
        for name, (low, high) in free.items():
            if low is None or high is None:
                continue
            if turned(rigid.type, part, name):
                low, high = -high, -low
            setattr(rigid, f"use_limit_{part}_{name}", True)
            setattr(rigid, f"limit_{part}_{name}_lower", low)
            setattr(rigid, f"limit_{part}_{name}_upper", high)
    names = {number: name for name, number in AXIS.items()}
    for drive in said.get("drives", []):
        part = ("ang_" if drive["type"] == "angular" else "") + names[drive["axis"]]
        setattr(rigid, f"use_spring_{part}", True)
        setattr(rigid, f"spring_stiffness_{part}", drive.get("stiffness", 0.0))
        setattr(rigid, f"spring_damping_{part}", drive.get("damping", 0.0))


def owner(obj):
    """The object with a rigid body that a joint's frame is below."""
    while obj is not None and obj.rigid_body is None:
        obj = obj.parent
    return obj


class Joint:
    """A joint of this add-on's: the name of the constraint's object, and the nodes above its two frames."""

    def __init__(self, name, said, above):
        self.name, self.said, self.above = name, said, above


def take_joints(gltf):
    """The joints that this add-on wrote. The nodes that it made, the last ones of its files, are taken out of the
    document: frames of joints, whose pose the constraint's own object has, and meshes of bodies, which these have too.
    """
    from .gltf_read import warn

    nodes = gltf.data.nodes or []
    parent = parents(nodes)
    marked = [i for i, node in enumerate(nodes) if isinstance(node.extras, dict) and MARK in node.extras]
    joints = []
    for i in marked:
        said = (nodes[i].extensions or {}).get(BODIES, {}).get("joint")
        if isinstance(said, dict) and isinstance(said.get("connectedNode"), int):
            above = (parent.get(i), parent.get(said["connectedNode"]))
            joints.append(Joint(nodes[i].extras[MARK], said, above))
        elif said is not None:
            warn(gltf, f"{nodes[i].name}: this joint ties no node, and is not read")
    if marked == list(range(len(nodes) - len(marked), len(nodes))):
        for i in marked:
            if parent.get(i) is not None:
                nodes[parent[i]].children.remove(i)
        del nodes[len(nodes) - len(marked):]
    return joints


def read_node(gltf, obj, node, root, shapes):
    """The body of a node."""
    from .gltf_read import vector, warn

    said = node.extensions[BODIES]
    if "joint" in said and MARK not in table(node.extras):
        warn(gltf, f"{obj.name}: this joint was not written by this add-on, and is not read")
    if "motion" not in said and "collider" not in said:
        return
    if obj.type != "MESH":
        warn(gltf, f"{obj.name}: this body has no mesh, and Blender has rigid bodies of meshes alone")
        return
    read_body(obj, said, root, shapes)
    centre = vector(table(said.get("motion")).get("centerOfMass")) or [0.0]
    if max(map(abs, centre)) > 1e-6:
        warn(gltf, f"{obj.name}: its centre of mass is not at its origin, where Blender has it")


def by_name(nodes):
    """The numbers of all nodes of each name. Blender may name an object otherwise, where it had one of that name."""
    found = {}
    for i, node in enumerate(nodes):
        found.setdefault(node.name, []).append(i)
    return found


def holder(joint, named, parent, of):
    """The object that becomes a joint's constraint; None where there is none of its name, or none that is free.

    Copies of a collection have nodes of equal names. The writer took the bodies nearest to each constraint.
    """
    free = [i for i in named.get(joint.name, []) if of.get(i) is not None and of[i].rigid_body_constraint is None]
    return of.get(min(free, key=lambda i: sum(steps(parent, i, body) for body in joint.above), default=None))


def read(gltf, of, joints):
    """All bodies and joints of a file; `of` gives the object of a node. What is wrong with one ends that one alone."""
    from .gltf_read import warn

    top, nodes = gltf.data.extensions or {}, gltf.data.nodes or []
    root, shapes = top.get(BODIES, {}), top.get(SHAPES, {}).get("shapes", [])
    active = bpy.context.view_layer.objects.active
    for index, node in enumerate(nodes):
        obj = of.get(index)
        if obj is None or obj.rigid_body is not None or BODIES not in (node.extensions or {}):
            continue
        try:
            read_node(gltf, obj, node, root, shapes)
        except WRONG as error:
            warn(gltf, f"{obj.name}: this body could not be read in full: {error!r}")
    named, parent = by_name(nodes), parents(nodes)
    for joint in joints:
        try:
            obj = holder(joint, named, parent, of)
            if obj is not None:
                first, second = (owner(of.get(number)) for number in joint.above)
                said = item(root["physicsJoints"], joint.said["joint"])
                read_joint(obj, said, first, second, joint.said.get("enableCollision", False))
        except WRONG as error:
            warn(gltf, f"{joint.name}: this joint could not be read in full: {error!r}")
    bpy.context.view_layer.objects.active = active
