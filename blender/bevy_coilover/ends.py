# SPDX-License-Identifier: MIT OR Apache-2.0
"""Where the ends of an element are, and what of them moves."""

from mathutils import Vector

from .fields import has_spring


def anchor(obj, point):
    """A point of an object's frame, in the world."""
    return obj.matrix_world @ Vector(point)


def line(element):
    """Both points of a linear element in the world, or None where an end is missing."""
    if element.a is None or element.b is None:
        return None
    return anchor(element.a, element.anchor_a), anchor(element.b, element.anchor_b)


def length(element):
    """From anchor to anchor, m; None where an end is missing."""
    points = line(element)
    return None if points is None else (points[1] - points[0]).length


def body(obj):
    """The rigid body that an object belongs to: its own or that of the nearest ancestor which has one."""
    found = None
    while obj is not None:
        if obj.rigid_body is not None:
            # Children of a compound body are shapes of it.
            if found is None or obj.rigid_body.collision_shape == "COMPOUND":
                found = obj
        obj = obj.parent
    return found


def frame(obj):
    """How the body of an end is turned: axes are in its frame."""
    return (body(obj) or obj).matrix_world.to_quaternion()


def moves(obj):
    """Whether the simulation moves it."""
    rigid = obj.rigid_body if obj is not None else None
    return rigid is not None and rigid.type == "ACTIVE" and rigid.enabled and not rigid.kinematic


def faults(element):
    """What is wrong with an element, in words; Bevy would say the same."""
    found = []
    for name, end in (("A", element.a), ("B", element.b)):
        if end is None:
            found.append(f"End {name} is missing")
    if found:
        return found
    if element.a == element.b:
        found.append("Both ends are the same object")
    elif not moves(body(element.a)) and not moves(body(element.b)):
        found.append("Neither end is an active rigid body: nothing will move")
    elif body(element.a) is not None and body(element.a) == body(element.b):
        found.append("Both ends belong to one rigid body")
    if element.kind.startswith("torsion"):
        if Vector(element.axis).length < 1e-6:
            found.append("The axis has no direction")
        return found
    if not found and length(element) < 1e-6:
        found.append("Both anchors are at the same point")
    negative = has_spring(element.kind) and element.use_rest and element.rest_length < 0.0
    if negative and not element.spring_axis.use:
        found.append("The rest length is negative")
    return found
