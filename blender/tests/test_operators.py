# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a designer clicks does what its name says."""

import math

import bpy
import pytest

from bevy_coilover import ends, fields, physics


def test_between_two_objects_a_spring_goes_from_the_active_one_to_the_other(scene):
    hook, load = scene.empty("Hook", (0, 0, 2)), scene.body("Load", (0, 0, 1))
    made = scene.spring(hook, load, stiffness=80.0, damping=1.0)
    assert made.coilover.kind == "springDamper"
    assert (made.coilover.a, made.coilover.b) == (hook, load)
    assert made.coilover.stiffness == 80.0
    assert made.matrix_world.translation.z == pytest.approx(1.5)


def test_between_several_objects_springs_go_out_from_the_active_one_as_a_star(scene):
    hub = scene.body("Hub", (0, 0, 0))
    tips = [scene.body(f"Tip {i}", (i - 1, 1, 0)) for i in range(3)]
    scene.select(hub, *tips)
    bpy.ops.coilover.between(kind="spring")
    made = [o for o in bpy.data.objects if o.coilover.kind == "spring"]
    assert {o.coilover.a for o in made} == {hub}
    assert {o.coilover.b for o in made} == set(tips)


def test_one_object_alone_gets_a_hook_above_it(scene):
    load = scene.body("Load", (0, 0, 0))
    scene.select(load)
    bpy.ops.coilover.between()
    element = bpy.context.object.coilover
    assert element.b == load and element.a.name == "Load Hook"
    assert element.a.matrix_world.translation.z >= 1.0


def test_a_chain_goes_from_neighbour_to_neighbour_whatever_their_names(scene):
    places = {"C": 0, "A": 1, "D": 2, "B": 3}
    beads = {name: scene.body(name, (x, 0, 0)) for name, x in places.items()}
    scene.select(beads["C"], *(beads[n] for n in "ABD"))
    bpy.ops.coilover.chain(kind="springDamper", closed=True)
    pairs = {(o.coilover.a.name, o.coilover.b.name) for o in bpy.data.objects if o.coilover.kind != "NONE"}
    assert pairs == {("C", "A"), ("A", "D"), ("D", "B"), ("B", "C")}


def test_a_lattice_has_a_body_per_corner_and_a_spring_per_edge_and_holds_what_is_selected(scene):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=3, size=2.0)
    grid = bpy.context.object
    for v in grid.data.vertices:
        v.select = v.co.y > 0.9
    held = sum(v.select for v in grid.data.vertices)
    corners, faces = len(grid.data.vertices), len(grid.data.polygons)
    loose = [e for e in grid.data.edges if not all(grid.data.vertices[i].select for i in e.vertices)]
    assert held > 1 and len(loose) < len(grid.data.edges)
    bpy.ops.coilover.lattice(mass=3.0, diagonals=True, stiffness=200.0)
    bodies = [o for o in bpy.data.objects if o.rigid_body is not None]
    assert len(bodies) == corners
    assert sum(o.rigid_body.type == "PASSIVE" for o in bodies) == held
    assert sum(o.rigid_body.mass for o in bodies) == pytest.approx(3.0, rel=1e-5)
    springs = [o for o in bpy.data.objects if o.coilover.kind != "NONE"]
    assert len(springs) == len(loose) + 2 * faces
    assert all(ends.faults(o.coilover) == [] for o in springs)
    assert len({o.data for o in bodies}) == 1, "all balls share one mesh"


def test_a_mesh_that_was_just_made_is_held_nowhere(scene):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    assert all(v.select for v in cube.data.vertices)
    bpy.ops.coilover.lattice()
    assert {o.rigid_body.type for o in bpy.data.objects if o.rigid_body} == {"ACTIVE"}
    assert sum(o.coilover.kind != "NONE" for o in bpy.data.objects) == 12


def test_a_lattice_can_be_held_by_a_vertex_group_and_says_when_there_is_none(scene):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=2, y_subdivisions=2)
    grid = bpy.context.object
    grid.vertex_groups.new(name="Held").add([0, 1], 1.0, "REPLACE")
    bpy.ops.coilover.lattice(group="Held")
    assert sum(o.rigid_body.type == "PASSIVE" for o in bpy.data.objects if o.rigid_body) == 2
    scene.select(grid) if grid.visible_get() else grid.hide_set(False)
    scene.select(grid)
    with pytest.raises(RuntimeError, match="has no vertex group"):
        bpy.ops.coilover.lattice(group="No Such")


def test_frequency_and_damping_ratio_follow_from_the_masses_and_can_be_set(scene):
    a, b = scene.body("A", (0, 0, 0), mass=3.0), scene.body("B", (0, 0, 1), mass=6.0)
    element = scene.spring(a, b).coilover
    assert physics.effective_mass(element) == pytest.approx(2.0)
    bpy.ops.coilover.tune(frequency=1.5, ratio=0.25)
    assert element.stiffness == pytest.approx(2.0 * (2 * math.pi * 1.5) ** 2, rel=1e-6)
    assert physics.frequency(element.stiffness, 2.0) == pytest.approx(1.5)
    assert physics.damping_ratio(element.stiffness, element.damping, 2.0) == pytest.approx(0.25)


def test_a_spring_off_centre_moves_less_mass_because_the_body_turns(scene):
    hook, rod = scene.empty("Hook", (1, 0, 1)), scene.body("Rod", (0, 0, 0), mass=12.0, size=(2.0, 0.02, 0.02))
    element = scene.spring(hook, rod).coilover
    element.anchor_b = (1.0, 0.0, 0.0)
    # A thin rod at its tip: 1/m + (L/2)²/(m L²/12) = 4/m.
    assert physics.effective_mass(element) == pytest.approx(3.0, rel=1e-3)


@pytest.mark.parametrize("shape, size, axis, inertia", [
    ("SPHERE", (0.4, 0.4, 0.4), (0, 0, 1), 0.4 * 5 * 0.2**2),
    ("CYLINDER", (0.4, 0.4, 1.0), (0, 0, 1), 0.5 * 5 * 0.2**2),
    ("CYLINDER", (0.4, 0.4, 1.0), (1, 0, 0), 5 * (3 * 0.2**2 + 1.0) / 12),
    ("BOX", (0.2, 0.4, 0.6), (0, 0, 1), 5 * (0.2**2 + 0.4**2) / 12),
])
def test_a_torsion_spring_turns_the_inertia_of_the_shape(scene, shape, size, axis, inertia):
    frame = scene.body("Frame", (0, 0, 0), active=False)
    wheel = scene.body("Wheel", (0, 0, 1), mass=5.0, size=size, shape=shape)
    element = scene.spring(frame, wheel, kind="torsionSpring").coilover
    element.axis = axis
    assert physics.effective_mass(element) == pytest.approx(inertia, rel=1e-4)


def test_sag_is_weight_over_stiffness(scene):
    hook, load = scene.empty("Hook", (0, 0, 2)), scene.body("Load", (0, 0, 1), mass=2.0)
    element = scene.spring(hook, load, stiffness=80.0).coilover
    assert physics.sag(element, bpy.context.scene) == pytest.approx(2.0 * 9.81 / 80.0, rel=1e-4)


def test_anchors_can_be_put_at_the_cursor_of_a_turned_and_scaled_body(scene):
    hook, load = scene.empty("Hook", (0, 0, 2)), scene.body("Load", (1, 2, 3))
    load.rotation_euler, load.scale = (0.3, 0.8, -1.1), (2.0, 1.0, 0.5)
    scene.spring(hook, load)
    bpy.context.scene.cursor.location = (1.2, 2.1, 2.9)
    bpy.ops.coilover.anchor(end="b")
    element = bpy.context.object.coilover
    assert tuple(ends.line(element)[1]) == pytest.approx((1.2, 2.1, 2.9), abs=1e-5)


def test_swapped_ends_take_their_anchors_along(scene):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    element = scene.spring(a, b).coilover
    element.anchor_a, element.anchor_b = (1, 2, 3), (4, 5, 6)
    before = [tuple(p) for p in ends.line(element)]
    bpy.ops.coilover.swap()
    assert [tuple(p) for p in ends.line(element)][::-1] == before


def test_the_rest_length_can_be_taken_from_now(scene):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 3, 4))
    element = scene.spring(a, b).coilover
    assert not element.use_rest
    bpy.ops.coilover.rest()
    assert element.use_rest and element.rest_length == pytest.approx(5.0)


def test_numbers_are_copied_to_other_elements_but_not_their_ends(scene):
    a, b, c = (scene.body(n, (0, 0, z)) for z, n in enumerate("ABC"))
    first, second = scene.spring(a, b, stiffness=123.0), scene.spring(b, c, kind="spring")
    first.coilover.breakable.use = True
    first.coilover.breakable.use_force, first.coilover.breakable.force = True, 55.0
    second.coilover.anchor_a = (0.1, 0.2, 0.3)
    scene.select(first, second)
    bpy.ops.coilover.copy()
    other = second.coilover
    assert (other.kind, other.stiffness, other.breakable.force) == ("springDamper", 123.0, 55.0)
    assert (other.a, other.b) == (b, c)
    assert tuple(other.anchor_a) == pytest.approx((0.1, 0.2, 0.3))


def test_faults_are_named_before_bevy_finds_them(scene):
    a, b = scene.body("A", (0, 0, 0), active=False), scene.body("B", (0, 0, 1), active=False)
    element = scene.spring(a, b).coilover
    assert ends.faults(element) == ["Neither end is an active rigid body: nothing will move"]
    b.rigid_body.type = "ACTIVE"
    assert ends.faults(element) == []
    element.b = a
    assert ends.faults(element) == ["Both ends are the same object"]
    element.a = None
    assert ends.faults(element) == ["End A is missing"]


def test_a_torsion_spring_may_end_at_an_object_that_is_no_body(scene):
    """Bevy's importer gives such an end a fixed body."""
    hook, wheel = scene.empty("Hook", (0, 0, 1)), scene.body("Wheel", (0, 0, 0))
    element = scene.spring(hook, wheel, kind="torsionSpring").coilover
    assert ends.faults(element) == []


def test_every_field_of_the_table_is_a_property(scene):
    element = scene.empty("E").coilover
    for companion in fields.COMPANIONS:
        group = getattr(element, companion.prop)
        for field in companion.fields:
            assert hasattr(group, field.prop), (companion.key, field.key)
            assert not field.optional or hasattr(group, field.tick)


def test_the_add_on_can_be_switched_off_and_on_again(scene):
    import addon_utils

    addon_utils.disable("bevy_coilover", default_set=True)
    assert not hasattr(bpy.types.Object, "coilover")
    addon_utils.enable("bevy_coilover", default_set=True)
    assert scene.empty("E").coilover.kind == "NONE"
