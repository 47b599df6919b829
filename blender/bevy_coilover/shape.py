# SPDX-License-Identifier: MIT OR Apache-2.0
"""Coils and cylinders as arrays of numbers, without Blender: along +Z from the origin.

The coil is the helix x = R cos t, y = R sin t, z = pitch t / 2 pi, with a round wire about it; closed ends lie wire on
wire. It is the same formula as the crate's `Helix`.
"""

import numpy as np

TAU = 2.0 * np.pi
#: Turns at each closed end that lie wire on wire, and over which the pitch changes.
DEAD, BLEND = 1.0, 0.5


class Mesh:
    """Corners, unit normals, and triangles."""

    def __init__(self, points, normals, faces):
        self.points = np.asarray(points, dtype=np.float64)
        self.normals = np.asarray(normals, dtype=np.float64)
        self.faces = np.asarray(faces, dtype=np.int32)


def join(meshes):
    """All in one."""
    meshes = list(meshes)
    starts = np.cumsum([0] + [len(m.points) for m in meshes[:-1]])
    return Mesh(
        np.concatenate([m.points for m in meshes]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.faces + s for m, s in zip(meshes, starts)]),
    )


def climb(turn, turns, length, wire, radius, ends):
    """Height of the wire's middle after so many turns (an array), and its rise per turn there."""
    closed = ends != "Open"
    dead = min(DEAD, turns / 4.0) if closed else 0.0
    blend = min(BLEND, (turns - 2.0 * dead) / 4.0) if closed else 0.0
    end_pitch = 0.0
    # How far the tip reaches depends on how steep it is, and that on what is left to climb.
    for _ in range(3):
        cosine = 1.0 / np.sqrt(1.0 + (end_pitch / (TAU * radius)) ** 2)
        start = 0.0 if ends == "ClosedGround" else wire * cosine
        rise = max(length - 2.0 * start, 0.0)
        even = rise / turns
        end_pitch = min(even, 2.0 * wire) if closed else even
        pitch = (rise - end_pitch * (2.0 * dead + blend)) / (turns - 2.0 * dead - blend)

    from_foot, from_top = turn, turns - turn
    x = np.clip(np.minimum(from_foot, from_top), 0.0, None)
    more = pitch - end_pitch
    into = np.clip(x - dead, 0.0, blend)
    past = np.clip(x - dead - blend, 0.0, None)
    curve = more * into * into / (2.0 * blend) if blend > 0.0 else 0.0
    above = end_pitch * x + curve + more * past
    slope = end_pitch + (more * into / blend if blend > 0.0 else more + 0.0 * x)
    lower = from_foot <= from_top
    height = np.where(lower, start + above, start + rise - above)
    return height, slope


def coil(radius, wire, turns, length, ends="ClosedGround", handedness="Right", along=24, around=10):
    """A coil that stands on the origin, `length` high, wire included."""
    rings = int(np.clip(np.ceil(turns * along), 4, 20_000))
    turn = np.linspace(0.0, turns, rings + 1)
    height, slope = climb(turn, turns, length, wire, radius, ends)
    hand = 1.0 if handedness == "Right" else -1.0
    sin, cos = np.sin(TAU * turn), np.cos(TAU * turn)
    none = np.zeros_like(turn)
    outward = np.stack([cos, hand * sin, none], axis=1)
    steep = slope / (TAU * radius)
    cosine = 1.0 / np.sqrt(1.0 + steep**2)
    upward = np.stack([sin * steep, -hand * cos * steep, none + 1.0], axis=1) * cosine[:, None]
    middle = radius * outward
    middle[:, 2] = height

    angle = np.linspace(0.0, TAU, around, endpoint=False)
    c, s = np.cos(angle)[None, :, None], np.sin(angle)[None, :, None]
    normals = c * outward[:, None, :] + s * upward[:, None, :]
    points = middle[:, None, :] + wire * normals
    if ends == "ClosedGround":
        points[..., 2] = np.clip(points[..., 2], 0.0, length)

    ring, step = np.meshgrid(np.arange(rings), np.arange(around), indexing="ij")
    a = ring * around + step
    b = ring * around + (step + 1) % around
    up = np.array([around])
    faces = np.concatenate([np.stack([a, a + up, b], -1), np.stack([b, a + up, b + up], -1)]).reshape(-1, 3)
    caps = []
    for first, turned in ((0, False), (rings * around, True)):
        fan = np.array([[first, first + k, first + k + 1] for k in range(1, around - 1)])
        caps.append(fan[:, ::-1] if turned else fan)
    faces = np.concatenate([faces, *caps])
    # A mirrored coil turns its faces over.
    if hand < 0.0:
        faces = faces[:, ::-1]
    return Mesh(points.reshape(-1, 3), normals.reshape(-1, 3), faces)


def cylinder(radius, low, high, around=24):
    """A solid about +Z from `low` to `high`; flat ends have corners of their own."""
    angle = np.linspace(0.0, TAU, around, endpoint=False)
    round_ = np.stack([np.cos(angle), np.sin(angle), np.zeros(around)], axis=1)
    at = lambda z: radius * round_ + [0.0, 0.0, z]
    down = np.tile([0.0, 0.0, -1.0], (around, 1))
    points = np.concatenate([at(low), at(high), at(low), at(high)])
    normals = np.concatenate([round_, round_, down, -down])
    k = np.arange(around)
    n = (k + 1) % around
    sides = [np.stack([k, n, around + k], -1), np.stack([n, around + n, around + k], -1)]
    fan = np.arange(1, around - 1)
    lid = np.stack([np.zeros_like(fan), fan, fan + 1], -1)
    return Mesh(points, normals, np.concatenate([*sides, lid[:, ::-1] + 2 * around, lid + 3 * around]))


def ring(radius, wire, along=24, around=10):
    """A ring about the X axis, as the eye of a damper."""
    big = np.linspace(0.0, TAU, along, endpoint=False)[:, None]
    small = np.linspace(0.0, TAU, around, endpoint=False)[None, :]
    normals = np.stack(
        [np.sin(small) + 0.0 * big, np.cos(small) * np.cos(big), np.cos(small) * np.sin(big)], axis=-1
    )
    middle = np.stack([0.0 * big, np.cos(big), np.sin(big)], axis=-1) * radius
    points = middle + wire * normals
    i, j = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    p = i * around + j
    q = i * around + (j + 1) % around
    r = (i + 1) % along * around + j
    t = (i + 1) % along * around + (j + 1) % around
    faces = np.concatenate([np.stack([p, r, q], -1), np.stack([q, r, t], -1)]).reshape(-1, 3)
    return Mesh(points.reshape(-1, 3), normals.reshape(-1, 3), faces)


def arc(radius, angle, wire, along=48):
    """A part of a ring about +Z, from +X on: what a torsion element is shown as."""
    steps = max(4, int(along * abs(angle) / TAU) + 1)
    t = np.linspace(0.0, angle, steps)
    outward = np.stack([np.cos(t), np.sin(t), 0.0 * t], axis=1)
    around = 8
    s = np.linspace(0.0, TAU, around, endpoint=False)
    normals = np.cos(s)[None, :, None] * outward[:, None, :] + np.sin(s)[None, :, None] * np.array([0.0, 0.0, 1.0])
    points = radius * outward[:, None, :] + wire * normals
    i, j = np.meshgrid(np.arange(steps - 1), np.arange(around), indexing="ij")
    p = i * around + j
    q = i * around + (j + 1) % around
    faces = np.concatenate([np.stack([p, q, p + around], -1), np.stack([q, q + around, p + around], -1)])
    return Mesh(points.reshape(-1, 3), normals.reshape(-1, 3), faces.reshape(-1, 3))
