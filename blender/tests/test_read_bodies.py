# SPDX-License-Identifier: MIT OR Apache-2.0
"""What is wrong with one body or joint of a file does not take the others with it."""

import json

import bpy
import pytest
from test_bodies import BODIES, SHAPES, joint
from test_file import again


def changed(scene, change):
    """Two bodies and a hinge, and two bodies and another; exported, changed as JSON, and read into an empty Blender."""
    for y, side in enumerate(("Bad", "Good")):
        ground = scene.body(f"{side} Ground", (0, y, 0), active=False)
        door = scene.body(f"{side} Door", (1, y, 0), mass=7.0, size=(0.1, 0.2, 0.3 + y), shape="CYLINDER")
        hinge = joint(scene, f"{side} Hinge", "HINGE", ground, door, (0.5, y, 0))
        hinge.use_limit_ang_z, hinge.limit_ang_z_upper = True, 0.25 * (y + 1)
    path = scene.folder / "first.gltf"
    assert bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLTF_SEPARATE") == {"FINISHED"}
    document = json.loads(path.read_text())
    change({n["name"]: n.get("extensions", {}).get(BODIES) for n in document["nodes"]}, document["extensions"])
    path.write_text(json.dumps(document))
    again(scene, "first.gltf")


def check_good():
    """What the change has left alone is read."""
    door = bpy.data.objects["Good Door"].rigid_body
    assert (door.type, door.mass, door.collision_shape) == ("ACTIVE", 7.0, "CYLINDER")
    hinge = bpy.data.objects["Good Hinge"].rigid_body_constraint
    assert (hinge.type, hinge.object1.name, hinge.object2.name) == ("HINGE", "Good Ground", "Good Door")
    assert hinge.limit_ang_z_upper == 0.5


def test_a_cylinder_without_sizes_is_a_cylinder(scene, capfd):
    def change(said, root):
        shape = said["Bad Door"]["collider"]["geometry"]["shape"]
        root[SHAPES]["shapes"][shape] = {"type": "cylinder"}

    changed(scene, change)
    assert bpy.data.objects["Bad Door"].rigid_body.collision_shape == "CYLINDER"
    check_good()
    assert "could not be read" not in "".join(capfd.readouterr())


@pytest.mark.parametrize("place, wrong", [
    (("geometry", "shape"), 99), (("geometry", "shape"), -1), (("geometry", "shape"), "box"), (("geometry",), 3),
    (("physicsMaterial",), 99), (("physicsMaterial",), None), (("collisionFilter",), 0),
])
def test_a_body_with_a_wrong_number_is_told_of_and_all_others_are_read(scene, capfd, place, wrong):
    def change(said, root):
        *outer, last = place
        at = said["Bad Door"]["collider"]
        for key in outer:
            at = at[key]
        at[last] = wrong

    changed(scene, change)
    assert "Bad Door: this body could not be read in full" in "".join(capfd.readouterr())
    check_good()


@pytest.mark.parametrize("wrong", [
    {"motion": 7}, {"motion": {"mass": "much"}}, {"motion": {"mass": 10**400}}, {"collider": ["box"]},
])
def test_a_body_of_the_wrong_kind_is_told_of_and_all_others_are_read(scene, capfd, wrong):
    changed(scene, lambda said, root: said["Bad Door"].update(wrong))
    assert "Bad Door: this body could not be read in full" in "".join(capfd.readouterr())
    check_good()


@pytest.mark.parametrize("index", [99, -1, "first", None])
def test_a_joint_with_a_wrong_number_is_told_of_and_all_others_are_read(scene, capfd, index):
    changed(scene, lambda said, root: said["Bad Hinge Joint A"]["joint"].update(joint=index))
    assert bpy.data.objects["Bad Hinge"].rigid_body_constraint is None
    assert "Bad Hinge: this joint could not be read in full" in "".join(capfd.readouterr())
    check_good()


@pytest.mark.parametrize("key, value", [("angularAxes", [7]), ("linearAxes", 3), ("min", "low")])
def test_a_joint_with_a_wrong_limit_is_told_of_and_all_others_are_read(scene, capfd, key, value):
    def change(said, root):
        limits = root[BODIES]["physicsJoints"][said["Bad Hinge Joint A"]["joint"]["joint"]]["limits"]
        limits[-1][key] = value

    changed(scene, change)
    assert "Bad Hinge: this joint could not be read in full" in "".join(capfd.readouterr())
    check_good()


@pytest.mark.parametrize("connected", [[1], None, "door"])
def test_a_joint_that_ties_no_node_is_told_of_and_all_others_are_read(scene, capfd, connected):
    changed(scene, lambda said, root: said["Bad Hinge Joint A"]["joint"].update(connectedNode=connected))
    assert "Bad Hinge Joint A: this joint ties no node" in "".join(capfd.readouterr())
    check_good()


@pytest.mark.parametrize("root", [BODIES, SHAPES])
def test_lists_that_are_missing_are_told_of_for_each_body(scene, capfd, root):
    changed(scene, lambda said, roots: roots.update({root: {}}))
    told = "".join(capfd.readouterr())
    assert all(f"{side} Door: this body could not be read in full" in told for side in ("Good", "Bad"))


@pytest.mark.parametrize("centre, told_of", [([0, 0, 0], False), ([0, -0.2, 0], True), (["x"], False)])
def test_a_centre_of_mass_that_blender_cannot_have_is_told_of(scene, capfd, centre, told_of):
    changed(scene, lambda said, root: said["Bad Door"]["motion"].update(centerOfMass=centre))
    assert ("Bad Door: its centre of mass" in "".join(capfd.readouterr())) is told_of
    check_good()


@pytest.mark.parametrize("shared_ground", [False, True])
def test_two_copies_of_a_collection_have_hinges_of_their_own_when_they_are_read(scene, shared_ground):
    ground, door = scene.body("Ground", (0, 0, 0), active=False), scene.body("Door", (1, 0, 0))
    joint(scene, "Hinge", "HINGE", ground, door, (0.5, 0, 0))
    part = bpy.data.collections.new("Part")
    for obj in (door, bpy.data.objects["Hinge"], *(() if shared_ground else (ground,))):
        for collection in list(obj.users_collection):
            world = bpy.context.scene.rigidbody_world
            if collection not in (world.collection, world.constraints):
                collection.objects.unlink(obj)
        part.objects.link(obj)
    for y in (0, 5):
        copy = scene.empty(f"Copy {y}", (0, y, 0))
        copy.instance_type, copy.instance_collection = "COLLECTION", part
    bpy.context.view_layer.update()
    scene.export("first.glb")
    again(scene, "first.glb")
    hinges = [obj for obj in bpy.data.objects if obj.rigid_body_constraint is not None]
    assert len(hinges) == 2
    for hinge in hinges:
        first, second = hinge.rigid_body_constraint.object1, hinge.rigid_body_constraint.object2
        assert second.parent == hinge.parent and first.name.startswith("Ground")
        assert (first.parent == hinge.parent) is not shared_ground
