# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a file leaves open is in Blender what it is in Bevy, and what it says is not changed on the way."""

import json

import bpy
import pytest
from conftest import fresh
from test_bodies import BODIES

from bevy_coilover import ends, fields

ENDS = {"a": 0, "b": 1}


def load(scene, document, unit=1.0):
    """Imports a file into an empty Blender with a unit scale."""
    path = scene.folder / "file.gltf"
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "scene": 0, **document}))
    fresh()
    bpy.context.scene.unit_settings.scale_length = unit
    assert bpy.ops.import_scene.gltf(filepath=str(path)) == {"FINISHED"}
    bpy.context.view_layer.update()


def element(scene, content, unit=1.0):
    """The element of a file with two bare nodes and this extension, in Blender."""
    nodes = [{"name": "A"}, {"name": "B", "translation": [0, 1, 0]},
             {"name": "E", "extensions": {"BEVY_coilover": content}}]
    load(scene, {"extensionsUsed": ["BEVY_coilover"], "scenes": [{"nodes": [0, 1, 2]}], "nodes": nodes}, unit)
    return bpy.data.objects["E"].coilover


def near(x):
    return pytest.approx(x, rel=1e-6, abs=1e-9)


def test_what_a_companion_leaves_open_is_what_the_crate_takes_for_it(scene):
    made = element(scene, {
        "springDamper": ENDS,
        "springTuning": {"Frequency": {"frequency": 3}},
        "springTravel": {"minLength": 0.3},
        "springLaw": {"Polynomial": {"pull": {"cubic": 5}}},
        "dampingLaw": {"BlowOff": {"damping": 9}},
        "breakable": {},
        "holdPose": {},
    })
    assert (made.stiffness, made.damping, made.use_rest) == (1.0, 1.0, False)
    assert (made.spring_tuning.frequency_frequency, made.spring_tuning.frequency_damping_ratio) == (3.0, 0.0)
    travel = made.spring_travel
    assert (travel.use_min_length, travel.use_max_length) == (True, False)
    assert (travel.stop_stiffness, travel.progression, travel.stop_damping) == (0.0, 0.0, 0.0)
    law = made.spring_law
    assert [getattr(law, f"polynomial_{side}_{part}") for side in ("pull", "push")
            for part in ("linear", "quadratic", "cubic")] == [0.0, 0.0, 5.0, 0.0, 0.0, 0.0]
    blow_off = made.damping_law
    assert (blow_off.blowoff_damping, blow_off.blowoff_knee, blow_off.blowoff_beyond) == (9.0, 0.0, 0.0)
    assert not made.breakable.use_force and not made.breakable.use_length and made.breakable.then == "Despawn"
    assert (made.hold_pose.load, made.hold_pose.share, made.hold_pose.use_mass) == ("Moving", 1.0, False)


@pytest.mark.parametrize("variant, inner", [("Sided", "bump rebound"), ("Quadratic", "linear quadratic")])
def test_damping_that_a_law_leaves_open_is_none(scene, variant, inner):
    law = element(scene, {"damper": ENDS, "dampingLaw": {variant: {}}}).damping_law
    assert [getattr(law, f"{variant.lower()}_{name}") for name in inner.split()] == [0.0, 0.0]


def test_looks_that_are_left_open_are_those_of_the_crate_also_where_they_fit_the_length(scene):
    made = element(scene, {"springDamper": ENDS, "coil": {}, "telescope": {}})
    assert (made.coil.radius, made.coil.wire_radius, made.coil.turns) == near((0.13, 0.016, 8.0))
    assert (made.telescope.tube_radius, made.telescope.rod_radius) == near((0.062, 0.026))
    made = element(scene, {"springDamper": ENDS, "coil": {"fitted": True}, "telescope": {"fitted": True}})
    assert (made.coil.radius, made.coil.wire_radius) == near((0.1, 0.012))
    assert (made.telescope.tube_radius, made.telescope.rod_radius) == near((0.048, 0.02))


def test_one_anchor_may_be_left_open(scene, capfd):
    made = element(scene, {"spring": ENDS, "anchors": {"b": [0, 0.5, 0]}})
    assert tuple(made.anchor_a) == (0.0, 0.0, 0.0) and tuple(made.anchor_b) == near((0.0, 0.0, 0.5))
    assert "could not be read" not in "".join(capfd.readouterr())


@pytest.mark.parametrize("companion", [
    {"maxForce": "much"}, {"springAction": "Sideways"}, {"springTuning": {"Frequency": {"dampingRatio": 1}}},
    {"springTravel": 3}, {"springAxis": {"World": [0, 1]}}, {"springLaw": "Steep"}, {"disabled": "yes"},
    {"showSpringGizmos": 1},
])
def test_a_companion_that_cannot_be_read_is_left_out_with_a_warning(scene, companion, capfd):
    (key,) = companion
    made = element(scene, {"spring": ENDS, **companion})
    assert not getattr(made, fields.snake(key)).use
    assert f"{key} could not be read" in "".join(capfd.readouterr())


def test_a_value_that_cannot_be_read_is_what_it_is_without_it(scene, capfd):
    made = element(scene, {"spring": {**ENDS, "stiffness": "much", "restLength": []},
                           "springTravel": {"minLength": "short", "stopStiffness": True}})
    assert (made.stiffness, made.use_rest) == (1.0, False)
    assert (made.spring_travel.use_min_length, made.spring_travel.stop_stiffness) == (False, 0.0)
    told = "".join(capfd.readouterr())
    for what in ("spring.stiffness", "spring.rest", "springTravel.minLength", "springTravel.stopStiffness"):
        assert what in told, what


def test_a_value_beyond_the_limits_of_the_panel_is_told_of(scene, capfd):
    made = element(scene, {"spring": {**ENDS, "stiffness": -5}, "coil": {"turns": 0.1}, "maxForce": -3})
    assert made.stiffness == 0.0 and made.max_force.use
    told = "".join(capfd.readouterr())
    for what in ("spring.stiffness", "coil.turns", "maxForce.force"):
        assert f"{what} could not be read" in told, what


def test_paint_may_be_brighter_than_white(scene):
    assert tuple(element(scene, {"spring": ENDS, "coil": {"color": [2, 0.5, 0]}}).coil.color) == (2.0, 0.5, 0.0, 1.0)


def test_a_rest_length_along_a_direction_may_be_negative(scene):
    content = {"spring": {**ENDS, "stiffness": 1, "restLength": -0.5}, "springAxis": {"World": [0, 1, 0]}}
    made = element(scene, content)
    assert made.use_rest and made.rest_length == -0.5
    assert scene.export().elements()["E"] == content
    assert "The rest length is negative" not in ends.faults(made)
    made.spring_axis.use = False
    assert "The rest length is negative" in ends.faults(made)


@pytest.mark.parametrize("shown", [True, False])
def test_debug_lines_that_are_never_drawn_come_back_so(scene, shown):
    content = {"spring": {**ENDS, "stiffness": 1}, "showSpringGizmos": shown}
    assert element(scene, content).show_spring_gizmos.shown is shown
    assert scene.export().elements()["E"] == content


def test_lengths_follow_the_units_of_the_scene_and_angles_do_not(scene):
    """In a scene of centimetres a length of 0.3 m is 30, and an angle of 0.3 rad stays 0.3."""
    core = {"springTravel": {"minLength": 0.3, "maxLength": 0.6, "stopStiffness": 1},
            "breakable": {"length": 0.9}, "springTuning": {"Sag": {"sag": 0.2, "dampingRatio": 1}}}
    for kind, factor in (("spring", 100.0), ("torsionSpring", 1.0)):
        made = element(scene, {kind: {**ENDS, **({} if kind == "spring" else {"axis": [0, 1, 0]})}, **core}, unit=0.01)
        found = (made.spring_travel.min_length, made.spring_travel.max_length, made.breakable.length,
                 made.spring_tuning.sag_sag)
        assert found == near(tuple(factor * x for x in (0.3, 0.6, 0.9, 0.2))), kind
    made = element(scene, {"spring": ENDS, "coil": {}}, unit=0.01)
    assert made.coil.radius == near(13.0)


def test_a_body_that_leaves_mass_and_friction_open_has_those_of_the_crate(scene):
    """The mass of its shape of water, and the friction of the specification."""
    scene.body("Box", (0, 0, 0), mass=7.0, size=(1.0, 2.0, 3.0))
    scene.body("Other", (5, 0, 0), mass=7.0)
    path = scene.folder / "box.gltf"
    assert bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLTF_SEPARATE") == {"FINISHED"}
    document = json.loads(path.read_text())
    (box,) = [n for n in document["nodes"] if n["name"] == "Box"]
    del box["extensions"][BODIES]["motion"]["mass"]
    document["extensions"][BODIES]["physicsMaterials"] = [{}]
    path.write_text(json.dumps(document))
    fresh()
    assert bpy.ops.import_scene.gltf(filepath=str(path)) == {"FINISHED"}
    box, other = (bpy.data.objects[name].rigid_body for name in ("Box", "Other"))
    assert (box.mass, other.mass) == near((6000.0, 7.0))
    assert (box.friction, box.restitution) == near((0.6, 0.0))
