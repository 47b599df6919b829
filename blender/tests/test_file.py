# SPDX-License-Identifier: MIT OR Apache-2.0
"""What is in the file, against the schema and against what was set; and what comes back from it."""

import json

import bpy
import jsonschema
import pytest
from conftest import REPOSITORY
from mathutils import Matrix, Quaternion, Vector

from bevy_coilover import fields
from bevy_coilover.properties import variant_prop

SCHEMA = json.loads((REPOSITORY / "docs" / "gltf.schema.json").read_text())
CHECK = jsonschema.Draft202012Validator(SCHEMA)


def check(glb):
    """Every element of a file is as the schema says, and its ends are nodes; the elements by name."""
    found = glb.elements()
    for name, content in found.items():
        CHECK.validate(content)
        core = content[next(k for k, _, _ in fields.KINDS if k in content)]
        for end in "ab":
            assert 0 <= core[end] < len(glb.json["nodes"]), name
    assert not found or "BEVY_coilover" in glb.json["extensionsUsed"]
    assert "BEVY_coilover" not in glb.json.get("extensionsRequired", [])
    return found


def to_gltf(v):
    return (v[0], v[2], -v[1])


def everything(element, seed):
    """Sets every companion, each field to a number of its own; variant number `seed` of each enum."""
    count = seed
    for companion in fields.COMPANIONS:
        group = getattr(element, companion.prop)
        group.use = True
        places = [(f.prop, f) for f in companion.fields]
        if companion.variants:
            name, inner = companion.variants[seed % len(companion.variants)]
            group.variant = name
            places = [(variant_prop(companion, name, f), f) for f in inner]
        for prop, field in places:
            count += 1
            if field.optional:
                setattr(group, "use_" + prop, count % 3 != 0)
            if field.kind == "number":
                setattr(group, prop, 0.1 * count)
            elif field.kind == "vector":
                setattr(group, prop, (0.1 * count, -0.2, 0.3))
            elif field.kind == "color":
                setattr(group, prop, (0.01 * count, 0.2, 0.3, 1.0))
            elif field.kind == "choice":
                setattr(group, prop, field.choices[count % len(field.choices)])
            elif field.kind == "flag":
                setattr(group, prop, count % 2 == 0)
            else:
                for i in range(3):
                    point = getattr(group, prop).add()
                    point.x, point.y = 0.1 * i, 7.0 * i


def test_one_spring_is_written_as_the_documentation_shows(scene):
    hook, lamp = scene.empty("Hook", (0, 0, 2)), scene.body("Lamp", (0, 0, 1), mass=2.0)
    spring = scene.spring(hook, lamp, stiffness=1200.0, damping=40.0)
    spring.name = "Spring"
    element = spring.coilover
    element.use_rest, element.rest_length = True, 0.5
    element.anchor_a = (0.0, 0.0, 0.1)
    element.preload.use, element.preload.preload = True, 10.0
    element.coil.use = element.telescope.use = False
    glb = scene.export()
    content = check(glb)["Spring"]
    core = content.pop("springDamper")
    assert (glb.name(core.pop("a")), glb.name(core.pop("b"))) == ("Hook", "Lamp")
    assert core == {"stiffness": 1200, "damping": 40, "restLength": 0.5}
    assert content == {"anchors": {"a": [0, 0.1, 0], "b": [0, 0, 0]}, "preload": 10}


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("kind", [k for k, _, _ in fields.KINDS])
def test_every_companion_is_written_as_the_schema_says_and_comes_back(scene, kind, seed):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    made = scene.spring(a, b, kind=kind)
    everything(made.coilover, seed)
    made.coilover.use_rest = True
    made.coilover.rest_length, made.coilover.rest_angle, made.coilover.axis = 0.7, 0.9, (0.1, 0.2, 0.3)
    made.coilover.anchor_a = (0.1, 0.2, 0.3)
    first = check(scene.export("first.glb"))
    linear = not fields.is_torsion(kind)
    wanted = {c.key for c in fields.COMPANIONS if linear or not c.linear} | {kind} | ({"anchors"} if linear else set())
    (content,) = first.values()
    assert set(content) == wanted

    again(scene, "first.glb")
    assert scene.export("second.glb").elements() == first


def again(scene, name):
    """Into an empty Blender."""
    from conftest import fresh

    fresh()
    assert bpy.ops.import_scene.gltf(filepath=str(scene.folder / name)) == {"FINISHED"}
    bpy.context.view_layer.update()


def test_numbers_are_short_and_exact_in_single_precision(scene):
    import struct

    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    for stiffness in (0.1, 1e-7, 123456.789, 33333.332, 3e7):
        element = scene.spring(a, b, stiffness=stiffness).coilover
        written = scene.export().said(bpy.context.object.name)["springDamper"]["stiffness"]
        assert struct.pack("f", written) == struct.pack("f", element.stiffness)
        assert len(repr(written)) <= 11


def global_matrix(glb, index):
    """Of a node, in glTF's axes."""
    parents = {c: i for i, n in enumerate(glb.json["nodes"]) for c in n.get("children", [])}
    matrix = Matrix.Identity(4)
    while index is not None:
        node = glb.json["nodes"][index]
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        own = Matrix.LocRotScale(
            Vector(node.get("translation", (0, 0, 0))), Quaternion((w, x, y, z)), Vector(node.get("scale", (1, 1, 1))))
        matrix, index = own @ matrix, parents.get(index)
    return matrix


def test_anchors_are_the_same_points_of_the_world_on_nested_turned_scaled_and_mirrored_ends(scene):
    arm = scene.empty("Arm", (1, 2, 3))
    arm.rotation_euler, arm.scale = (0.4, -0.2, 1.3), (2.0, 2.0, 2.0)
    a = scene.body("A", (0.3, 0.1, 0.2), parent=arm)
    b = scene.body("B", (-2, 1, 0))
    b.rotation_euler, b.scale = (-1.0, 0.5, 0.1), (1.0, -1.5, 0.5)
    bpy.context.view_layer.update()
    element = scene.spring(a, b).coilover
    element.anchor_a, element.anchor_b = (0.1, -0.2, 0.3), (-0.3, 0.2, 0.1)
    wanted = [to_gltf(obj.matrix_world @ Vector(p)) for obj, p in ((a, element.anchor_a), (b, element.anchor_b))]
    glb = scene.export()
    (content,) = check(glb).values()
    for end, point in zip("ab", wanted):
        found = global_matrix(glb, content["springDamper"][end]) @ Vector(content["anchors"][end])
        assert tuple(found) == pytest.approx(point, abs=1e-5)


@pytest.mark.parametrize("what, options", [("camera", {"export_cameras": True}), ("light", {"export_lights": True})])
def test_a_camera_or_a_lamp_as_an_end_is_held_where_it_was(scene, what, options):
    {"camera": bpy.ops.object.camera_add, "light": bpy.ops.object.light_add}[what](
        location=(0, 0, 3), rotation=(0.3, 0.4, 0.5))
    eye = bpy.context.object
    b = scene.body("B", (0, 0, 1))
    element = scene.spring(eye, b).coilover
    element.anchor_a = (0.1, 0.2, 0.3)
    wanted = to_gltf(eye.matrix_world @ Vector(element.anchor_a))
    glb = scene.export(**options)
    (content,) = check(glb).values()
    found = global_matrix(glb, content["springDamper"]["a"]) @ Vector(content["anchors"]["a"])
    assert tuple(found) == pytest.approx(wanted, abs=1e-5)


def test_an_element_may_be_a_child_of_its_own_end(scene):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    made = scene.spring(a, b)
    made.parent = a
    glb = scene.export()
    (content,) = check(glb).values()
    assert glb.name(content["springDamper"]["a"]) == "A"


def test_two_copies_of_a_collection_have_springs_of_their_own(scene):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    made = scene.spring(a, b)
    part = bpy.data.collections.new("Part")
    for obj in (a, b, made):
        for collection in list(obj.users_collection):
            if collection != bpy.context.scene.rigidbody_world.collection:
                collection.objects.unlink(obj)
        part.objects.link(obj)
    for x in (0, 5):
        copy = scene.empty(f"Copy {x}", (x, 0, 0))
        copy.instance_type, copy.instance_collection = "COLLECTION", part
    bpy.context.view_layer.update()
    glb = scene.export()
    parents = {c: i for i, n in enumerate(glb.json["nodes"]) for c in n.get("children", [])}
    found = [(i, n["extensions"]["BEVY_coilover"]) for i, n in enumerate(glb.json["nodes"])
             if "BEVY_coilover" in n.get("extensions", {})]
    assert len(found) == 2
    for index, content in found:
        CHECK.validate(content)
        for end in "ab":
            assert parents[content["springDamper"][end]] == parents[index]


def test_an_element_whose_end_is_not_in_the_file_is_left_out_with_a_warning(scene, capfd):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    made = scene.spring(a, b)
    scene.select(b, made)
    assert scene.export(use_selection=True).elements() == {}
    assert "end A is A, which is not in the file" in "".join(capfd.readouterr())
    made.coilover.b = None
    assert scene.export().elements() == {}
    assert "end B is missing" in "".join(capfd.readouterr())


def test_meshes_made_for_a_picture_are_not_in_the_file(scene):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    scene.spring(a, b)
    before = scene.export("before.glb").json
    bpy.ops.coilover.meshes()
    after = scene.export("after.glb").json
    assert len(after["nodes"]) == len(before["nodes"]) == 3
    assert len(after["meshes"]) == len(before["meshes"])


def test_a_file_with_nonsense_is_read_with_a_warning_for_each(scene, capfd):
    a, b = scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1))
    scene.spring(a, b).name = "S"
    glb = scene.export("good.glb")
    content = glb.said("S")
    content["springDamper"].update(a=99, stiffness="much")
    content["springAction"] = "Sideways"
    content["springLaw"] = {"Table": {"points": [[0, 1], [2]]}}
    content["anchors"] = {"a": [0, 0], "b": [0, 0, None]}
    content["coil"]["radius"] = True
    content["wings"] = 2
    text = json.dumps(glb.json)
    data = text.encode() + b" " * (-len(text.encode()) % 4)
    old = (scene.folder / "good.glb").read_bytes()
    start = 20 + int.from_bytes(old[12:16], "little")
    body = len(data).to_bytes(4, "little") + b"JSON" + data + old[start:]
    (scene.folder / "bad.glb").write_bytes(old[:8] + (12 + len(body)).to_bytes(4, "little") + body)
    again(scene, "bad.glb")
    element = bpy.data.objects["S"].coilover
    assert element.kind == "springDamper" and element.a is None and element.b.name == "B"
    said = "".join(capfd.readouterr())
    for what in ("end A is 99", "springDamper.stiffness", "springAction", "springLaw.Table.points", "anchors.a",
                 "anchors.b", "coil.radius", "wings"):
        assert what in said, what


def test_ten_bodies_in_a_chain_keep_every_number_there_and_back(scene):
    beads = [scene.body(f"Bead {i}", (0.3 * i, 0, 0), mass=0.1 + i) for i in range(10)]
    scene.select(beads[0], *beads[1:])
    bpy.ops.coilover.chain(stiffness=321.5, damping=0.7)
    first = scene.export("first.glb")
    assert len(check(first)) == 9
    again(scene, "first.glb")
    second = scene.export("second.glb")
    assert [n["name"] for n in second.json["nodes"]] == [n["name"] for n in first.json["nodes"]]
    for one, other in zip(first.json["nodes"], second.json["nodes"]):
        assert one.get("extensions") == other.get("extensions"), one["name"]
        assert one.get("translation", [0, 0, 0]) == pytest.approx(other.get("translation", [0, 0, 0]), abs=1e-6)
    assert first.json["extensions"] == second.json["extensions"]
