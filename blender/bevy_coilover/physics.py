# SPDX-License-Identifier: MIT OR Apache-2.0
"""Frequency, damping ratio and sag of an element from the masses of its ends, as Bevy's `SpringTuning` has them.

Joints and contacts are not counted: the bodies are taken as free.
"""

import math

import numpy as np
from mathutils import Matrix, Vector

from . import ends
from .fields import is_torsion


def box_inertia(mass, size):
    x, y, z = (s * s for s in size)
    return np.diag([y + z, x + z, x + y]) * mass / 12.0


def extent(obj):
    """Size of the mesh before its scale, m."""
    corners = np.array([tuple(c) for c in obj.bound_box])
    return corners.max(axis=0) - corners.min(axis=0)


def shape_inertia(obj):
    """Principal inertia (kg m²) of a rigid body about its origin, in its own axes, for the shape that it collides as.

    A convex hull, a mesh and a compound are taken as their bounding box.
    """
    mass, kind = obj.rigid_body.mass, obj.rigid_body.collision_shape
    size = extent(obj) * np.abs(np.array(obj.matrix_world.to_scale()))
    radius, height = 0.5 * max(size[0], size[1]), size[2]
    if kind == "SPHERE":
        return np.eye(3) * 0.4 * mass * (0.5 * size.max()) ** 2
    if kind == "CYLINDER":
        side = mass * (3.0 * radius**2 + height**2) / 12.0
        return np.diag([side, side, 0.5 * mass * radius**2])
    if kind == "CONE":
        side = mass * (3.0 / 20.0 * radius**2 + 3.0 / 80.0 * height**2)
        return np.diag([side, side, 0.3 * mass * radius**2])
    if kind == "CAPSULE":
        straight = max(height - 2.0 * radius, 0.0)
        ball = 4.0 / 3.0 * radius / (straight + 4.0 / 3.0 * radius)
        tube, caps = mass * (1.0 - ball), mass * ball
        along = 0.5 * tube * radius**2 + 0.4 * caps * radius**2
        side = tube * (3.0 * radius**2 + straight**2) / 12.0
        side += caps * (0.4 * radius**2 + 0.25 * straight**2 + 0.375 * straight * radius)
        return np.diag([side, side, along])
    return box_inertia(mass, size)


def inverse_inertia(obj):
    """In the world's axes."""
    turn = np.array(obj.matrix_world.to_quaternion().to_matrix())
    inertia = shape_inertia(obj)
    with np.errstate(divide="ignore"):
        diagonal = np.where(np.diag(inertia) > 0.0, 1.0 / np.diag(inertia), 0.0)
    return turn @ np.diag(diagonal) @ turn.T


def effective_mass(element):
    """What the element has to move, kg (kg m² about the axis of a torsion element); None where nothing moves."""
    if element.a is None or element.b is None or element.a == element.b:
        return None
    inverse = 0.0
    if is_torsion(element.kind):
        axis = ends.frame(element.a) @ Vector(element.axis)
        if axis.length < 1e-6:
            return None
        n = np.array(axis.normalized())
        for end in (element.a, element.b):
            body = ends.body(end)
            if ends.moves(body):
                inverse += n @ inverse_inertia(body) @ n
    else:
        points = ends.line(element)
        along = points[1] - points[0]
        if along.length < 1e-6:
            return None
        n = np.array(along.normalized())
        for end, point in zip((element.a, element.b), points):
            body = ends.body(end)
            if ends.moves(body):
                lever = np.cross(np.array(point - body.matrix_world.translation), n)
                inverse += 1.0 / body.rigid_body.mass + lever @ inverse_inertia(body) @ lever
    return 1.0 / inverse if inverse > 0.0 else None


def frequency(stiffness, mass):
    """Undamped natural frequency, Hz."""
    return math.sqrt(stiffness / mass) / (2.0 * math.pi)


def damping_ratio(stiffness, damping, mass):
    """1 is critical; None without a spring."""
    return damping / (2.0 * math.sqrt(stiffness * mass)) if stiffness > 0.0 else None


def coefficients(hertz, ratio, mass):
    """Stiffness and damping for a natural frequency and a damping ratio."""
    stiffness = mass * (2.0 * math.pi * hertz) ** 2
    return stiffness, 2.0 * ratio * math.sqrt(stiffness * mass)


def sag(element, scene):
    """How far it gives way along itself under the weight of the end that moves, m; None where that is not known."""
    movers = [body for body in (ends.body(element.a), ends.body(element.b)) if ends.moves(body)]
    if is_torsion(element.kind) or len(movers) != 1 or element.stiffness <= 0.0 or not scene.use_gravity:
        return None
    along = ends.line(element)
    along = (along[1] - along[0]).normalized()
    weight = movers[0].rigid_body.mass * abs(Vector(scene.gravity).dot(along))
    return weight / element.stiffness


def upright(direction):
    """A rotation that takes +Z to a direction."""
    return direction.to_track_quat("Z", "Y").to_matrix().to_4x4() if direction.length > 1e-9 else Matrix.Identity(4)
