# SPDX-License-Identifier: MIT OR Apache-2.0
"""Are coils and telescopes closed solids of the size asked for, do they follow the ends, and can they be seen?"""

import itertools
import math
import os
from collections import Counter
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

from bevy_coilover import look, preview, shape

COILS = [
    (radius, wire, turns, length, ends, hand)
    for (radius, wire, turns, length), ends, hand in itertools.product(
        [(0.13, 0.016, 8.0, 1.0), (1.0, 0.3, 3.5, 4.0), (0.5, 0.01, 1.0, 0.2), (0.2, 0.02, 5.25, 0.5)],
        ["Open", "Closed", "ClosedGround"],
        ["Right", "Left"],
    )
]


def volume(mesh):
    a, b, c = (mesh.points[mesh.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", np.cross(a, b), c).sum() / 6.0)


def edges(mesh):
    """Directed edges, corners at one place being one corner."""
    places = {}
    number = [places.setdefault(tuple(np.round(p, 9)), len(places)) for p in mesh.points]
    for face in mesh.faces:
        corners = [number[i] for i in face]
        if len(set(corners)) == 3:
            yield from zip(corners, corners[1:] + corners[:1])


@pytest.mark.parametrize("radius, wire, turns, length, ends, hand", COILS)
def test_a_coil_is_as_long_and_as_wide_as_asked(radius, wire, turns, length, ends, hand):
    mesh = shape.coil(radius, wire, turns, length, ends, hand, along=48, around=32)
    low, high = mesh.points[:, 2].min(), mesh.points[:, 2].max()
    assert (low, high) == pytest.approx((0.0, length), abs=2e-3 * length)
    away = np.hypot(mesh.points[:, 0], mesh.points[:, 1])
    assert away.max() == pytest.approx(radius + wire, rel=1e-3)
    if turns >= 2.0:
        assert away.min() == pytest.approx(radius - wire, rel=1e-2)


@pytest.mark.parametrize("radius, wire, turns, length, ends, hand", COILS)
def test_a_coil_is_a_closed_tube_with_its_faces_outward(radius, wire, turns, length, ends, hand):
    mesh = shape.coil(radius, wire, turns, length, ends, hand, along=48, around=32)
    if ends == "Open":
        count = Counter(edges(mesh))
        assert all(count[b, a] == n for (a, b), n in count.items())
        pitch = (length - 2 * wire) / turns
        tube = math.pi * wire**2 * turns * math.hypot(pitch, 2 * math.pi * radius)
        assert volume(mesh) == pytest.approx(tube, rel=0.03)
    assert volume(mesh) > 0.0
    a, b, c = (mesh.points[mesh.faces[:, i]] for i in range(3))
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), mesh.normals[mesh.faces].mean(axis=1))
    assert (outward > -1e-12).mean() > 0.98


def test_a_right_handed_coil_is_wound_as_a_common_screw():
    for hand, sign in (("Right", 1), ("Left", -1)):
        height, _ = shape.climb(np.linspace(0, 4, 100), 4.0, 1.0, 0.02, 0.1, "Open")
        assert (np.diff(height) > 0).all()
        points = shape.coil(0.1, 0.02, 4.0, 1.0, "Open", hand, along=40, around=4).points.reshape(-1, 4, 3).mean(axis=1)
        turn = np.cross(points[:-1], points[1:])[:, 2]
        assert (np.sign(turn) == sign).all()


def test_closed_ends_keep_wire_on_wire_however_far_the_coil_is_stretched():
    for length in (0.5, 1.0, 2.0):
        height, pitch = shape.climb(np.array([0.0, 0.5, 1.0, 4.0]), 8.0, length, 0.016, 0.13, "ClosedGround")
        assert pitch[:3] == pytest.approx(0.032) and pitch[3] > 0.04
        assert height[2] == pytest.approx(0.032)


@pytest.mark.parametrize("mesh, solid", [
    (shape.cylinder(0.2, 0.1, 0.7, 64), math.pi * 0.2**2 * 0.6),
    (shape.ring(0.5, 0.1, 96, 64), 2 * math.pi**2 * 0.5 * 0.1**2),
])
def test_other_solids_are_closed_and_outward(mesh, solid):
    count = Counter(edges(mesh))
    assert all(count[b, a] == n for (a, b), n in count.items())
    assert volume(mesh) == pytest.approx(solid, rel=0.01)


def span(parts, name):
    (part,) = [p for p in parts if p.name == name]
    return part.mesh.points[:, 2].min(), part.mesh.points[:, 2].max()


@pytest.mark.parametrize("telescope", [
    look.Telescope(), look.Telescope(eyes=True, bump_rubber=True), look.Telescope(stroke=0.9),
    look.Telescope(tube_length=0.3, rod_length=0.4), look.Telescope(0.05, 0.02, fitted=True),
])
@pytest.mark.parametrize("coil", [None, look.Coil(), look.Coil(0.1, 0.012, fitted=True)])
def test_tube_and_rod_always_overlap_and_stay_between_the_ends(telescope, coil):
    for length in (0.3, 0.7, 1.0, 1.1, 1.5, 4.0):
        solids = look.parts(coil, telescope, length, 1.0)
        tube, rod = span(solids, "Tube"), span(solids, "Rod")
        assert tube[1] > rod[0], "the rod has left the tube"
        assert all(-1e-9 <= z <= length + 1e-9 for z in (*tube, *rod))


def test_tube_and_rod_keep_their_lengths_within_the_stroke():
    telescope = look.Telescope(stroke=0.4)
    at = lambda length: [np.diff(span(look.parts(None, telescope, length, 1.0), n))[0] for n in ("Tube", "Rod")]
    for length in np.linspace(0.81, 1.19, 7):
        assert at(length) == pytest.approx(at(1.0), abs=1e-6)


def test_a_coilover_has_its_coil_between_seats():
    solids = look.parts(look.Coil(), look.Telescope(eyes=True), 1.2, 1.0)
    assert span(solids, "Coil") == pytest.approx((span(solids, "Seat A")[1], span(solids, "Seat B")[0]), abs=1e-6)


def test_the_preview_goes_from_anchor_to_anchor_wherever_they_are_moved(scene):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0.3, 1, 0.4))
    made = scene.spring(a, b)
    made.coilover.anchor_b = (0.1, 0.0, 0.05)
    for place in ((1, 2, 3), (-2, 0.1, 0.3), (0, 0, -5)):
        b.location, b.rotation_euler = place, place
        bpy.context.view_layer.update()
        matrix, solids = preview.parts(made, bpy.context.scene, 24)
        everything = np.concatenate([p.mesh.points for p in solids])
        low, high = everything[:, 2].min(), everything[:, 2].max()
        at = lambda z: tuple(matrix @ Vector((0, 0, z)))
        assert at(low) == pytest.approx(tuple(a.matrix_world.translation), abs=1e-4)
        assert at(high) == pytest.approx(tuple(b.matrix_world @ Vector((0.1, 0, 0.05))), abs=1e-4)


def test_the_telescope_slides_while_blender_plays(scene):
    hook, load = scene.empty("Hook", (0, 0, 2)), scene.body("Load", (0, 0, 1))
    made = scene.spring(hook, load)
    bpy.context.scene.frame_set(bpy.context.scene.frame_start)
    lengths = []
    for frame, z in ((1, 1.0), (2, 0.9), (3, 1.15)):
        bpy.context.scene.frame_current = frame
        load.location.z = z
        bpy.context.view_layer.update()
        _, solids = preview.parts(made, bpy.context.scene, 24)
        lengths.append(np.diff(span(solids, "Tube"))[0])
    assert lengths == pytest.approx([lengths[0]] * 3)


def test_made_meshes_lie_where_the_preview_is_and_can_be_removed(scene):
    a, b = scene.body("A", (1, 0, 0)), scene.body("B", (1, 2, 2))
    made = scene.spring(a, b)
    before = len(bpy.data.objects)
    bpy.ops.coilover.meshes()
    bpy.ops.coilover.meshes()
    bpy.context.view_layer.update()
    solids = [o for o in made.children if o.get("coilover_look")]
    assert {o.name.split()[-1] for o in solids} >= {"Coil", "Tube", "Rod"}
    tube = next(o for o in solids if o.name.endswith("Tube"))
    assert tuple(tube.matrix_world.translation) == pytest.approx((1, 0, 0), abs=1e-5)
    bpy.ops.coilover.meshes(remove=True)
    assert len(bpy.data.objects) == before


def test_a_rendered_coilover_can_be_seen(scene):
    """By Cycles on the processor: red coil before a grey wall. With PICTURES set, the picture is kept there."""
    hook, load = scene.empty("Hook", (0, 0, 2)), scene.body("Load", (0, 0, 0.8), mass=2.0, size=(0.5, 0.5, 0.3))
    made = scene.spring(hook, load, stiffness=80.0)
    made.coilover.anchor_b = (0, 0, 0.15)
    made.coilover.telescope.eyes = made.coilover.telescope.bump_rubber = True
    bpy.ops.coilover.meshes()
    bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.3, 0.4))
    bpy.context.object.data.energy = 3.0
    bpy.ops.object.camera_add(location=(0, -2.6, 1.4), rotation=(math.pi / 2, 0, 0))
    world = bpy.data.worlds.new("World")
    world.color = (0.5, 0.5, 0.5)
    stage = bpy.context.scene
    stage.world, stage.camera = world, bpy.context.object
    stage.render.engine, stage.cycles.device, stage.cycles.samples = "CYCLES", "CPU", 16
    stage.cycles.use_denoising = False
    stage.view_settings.view_transform = "Standard"
    stage.render.resolution_x, stage.render.resolution_y = 240, 320
    folder = Path(os.environ.get("PICTURES", scene.folder))
    stage.render.filepath = str(folder / "coilover.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(stage.render.filepath)
    pixels = np.array(image.pixels[:]).reshape(320, 240, 4)[:, :, :3]
    red = (pixels[..., 0] > 0.25) & (pixels[..., 0] > 2.0 * pixels[..., 1])
    rows = np.nonzero(red.any(axis=1))[0]
    assert red.sum() > 800, "the coil is red"
    assert rows.max() - rows.min() > 80, "it is as long as the distance between the ends"
    assert red[:, :60].sum() == 0 and red[:, 180:].sum() == 0
