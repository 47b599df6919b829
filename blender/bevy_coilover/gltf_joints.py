# SPDX-License-Identifier: MIT OR Apache-2.0
"""Blender's rigid body constraints as joints of KHR_physics_rigid_bodies.

A constraint of Blender is an object between two others. In the file each of the two gets a child node with the pose of
that object, and the joint ties the children together.
"""

from mathutils import Quaternion

from .axes import short, to_gltf

BODIES = "KHR_physics_rigid_bodies"
#: Marks the nodes that this add-on adds, with the name of the object that each is made for. An import takes them out
#: again, and knows a constraint's object by the name.
MARK = "coilover_joint"
#: Blender's axes x, y, z in the file, with Y up.
AXIS = {"x": 0, "y": 2, "z": 1}


def turned(constraint, part, name):
    """Whether a range counts the other way in the file.

    The Y of Blender is the -Z of the file. And the angles of these constraints are those of object 1 against object 2,
    as Blender's engine has them; the file's are those of the second frame against the first.
    """
    backwards = part == "ang" and constraint in ("HINGE", "GENERIC", "GENERIC_SPRING")
    return (name == "y") != backwards


def held(names, kind, low=0.0, high=0.0):
    """A limit of one axis or several."""
    return {kind + "Axes": sorted(AXIS[n] for n in names), "min": short(low), "max": short(high)}


def single(rigid, part, name):
    """The limits of one axis of a generic constraint: 'lin' or 'ang'."""
    kind = {"lin": "linear", "ang": "angular"}[part]
    if not getattr(rigid, f"use_limit_{part}_{name}"):
        return []
    low, high = getattr(rigid, f"limit_{part}_{name}_lower"), getattr(rigid, f"limit_{part}_{name}_upper")
    if turned(rigid.type, part, name):
        low, high = -high, -low
    # Blender leaves an axis free whose lower limit is above the upper one.
    return [held([name], kind, low, high)] if low <= high else []


def springs(rigid):
    """The springs of a generic constraint, towards the pose that it has now."""
    out = []
    for part, kind in (("", "linear"), ("ang_", "angular")):
        for name in "xyz":
            if getattr(rigid, f"use_spring_{part}{name}"):
                out.append({
                    "type": kind, "mode": "force", "axis": AXIS[name], "positionTarget": 0.0, "velocityTarget": 0.0,
                    "stiffness": short(getattr(rigid, f"spring_stiffness_{part}{name}")),
                    "damping": short(getattr(rigid, f"spring_damping_{part}{name}")),
                })
    return out


def describe(rigid):
    """Limits and drives of a constraint; None where the file has no words for it."""
    kind = rigid.type
    place = held("xyz", "linear")
    if kind == "FIXED":
        return {"limits": [place, held("xyz", "angular")]}
    if kind == "POINT":
        return {"limits": [place]}
    if kind == "HINGE":
        return {"limits": [place, held("xy", "angular"), *single(rigid, "ang", "z")]}
    if kind == "SLIDER":
        return {"limits": [held("yz", "linear"), held("xyz", "angular"), *single(rigid, "lin", "x")]}
    if kind == "PISTON":
        turn = single(rigid, "ang", "x")
        return {"limits": [held("yz", "linear"), held("yz", "angular"), *single(rigid, "lin", "x"), *turn]}
    if kind in ("GENERIC", "GENERIC_SPRING"):
        limits = [limit for part in ("lin", "ang") for name in "xyz" for limit in single(rigid, part, name)]
        said = {"limits": limits} if limits else {}
        if kind == "GENERIC_SPRING" and springs(rigid):
            said["drives"] = springs(rigid)
        return said or None
    return None


def pose(target, obj):
    """Where a constraint's object is in the frame of a body, and how it is turned against that body.

    The place is in the body's scaled space. The turn leaves the scale out: readers multiply the rotations of nodes, and a
    matrix with an uneven scale would skew it. A mirrored node turns its children the other way about Y and Z.
    """
    body, own = target.matrix_world, obj.matrix_world
    turn = body.decompose()[1].inverted() @ own.decompose()[1]
    if body.determinant() < 0.0:
        turn = turn @ Quaternion((0.0, 1.0, 0.0, 0.0))
    return body.inverted_safe() @ own.translation, turn


def new_node(name, **content):
    """A marked node. The name is in words, of which the first is the object that it is made for."""
    from io_scene_gltf2.io.com import gltf2_io

    fields = dict.fromkeys(
        ("camera", "extensions", "matrix", "mesh", "rotation", "scale", "skin", "translation", "weights"))
    fields.update(children=[], extras={MARK: name[0]}, name=" ".join(name), **content)
    return gltf2_io.Node(**fields)


def frame_node(name, place, turn):
    """A node with a pose in its parent's frame as Blender has it."""
    vector = to_gltf((turn.x, turn.y, turn.z))
    rotation = [*(short(x) for x in vector), short(turn.w)]
    return new_node(name, rotation=rotation, translation=[short(x) for x in to_gltf(place)])


def frames(obj, gathered, node):
    """The numbers of the two nodes of a joint, or None where an object is not in the file."""
    rigid = obj.rigid_body_constraint
    targets = [rigid.object1, rigid.object2]
    below = [None if t is None else gathered.near(t, node) for t in targets]
    if None in below:
        return None
    return [
        gathered.add(frame_node((obj.name, "Joint", end), *pose(target, obj)), number)
        for end, target, number in zip("AB", targets, below)
    ]


def write(gathered, document, settings):
    """All constraints of a file."""
    from .gltf_write import warn

    for node, obj in list(gathered.pairs):
        rigid = obj.rigid_body_constraint
        if rigid is None or not rigid.enabled:
            continue
        said = describe(rigid) if settings.get("gltf_yup", True) else None
        if said is None:
            warn(settings, f"{obj.name}: a constraint of type {rigid.type} cannot be written; it is left out")
            continue
        made = frames(obj, gathered, node)
        if made is None:
            warn(settings, f"{obj.name}: an object of this constraint is not in the file; it is left out")
            continue
        if rigid.use_breaking:
            warn(settings, f"{obj.name}: joints of the file do not break")
        joint = {"connectedNode": made[1], "joint": document.shared(BODIES, "physicsJoints", said)}
        if not rigid.disable_collisions:
            joint["enableCollision"] = True
        document.put(gathered.nodes[made[0]], BODIES, {"joint": joint})
