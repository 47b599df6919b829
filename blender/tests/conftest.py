# SPDX-License-Identifier: MIT OR Apache-2.0
"""A fresh Blender with the add-on for every test."""

import json
import struct
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
sys.path.insert(0, str(HERE.parent))
sys.path.insert(0, str(HERE))

import bpy  # noqa: E402, I001  (it brings the next one)
import addon_utils  # noqa: E402


def fresh():
    """An empty scene, with the add-on enabled as a user enables it: only so does the exporter see it."""
    if "bevy_coilover" in bpy.context.preferences.addons:
        addon_utils.disable("bevy_coilover", default_set=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert addon_utils.enable("bevy_coilover", default_set=True) is not None


@pytest.fixture(autouse=True)
def blender():
    fresh()
    yield bpy


class Scene:
    """What tests put into a scene, and how they write and read files."""

    def __init__(self, folder):
        self.folder = folder

    def body(self, name, place, mass=1.0, size=(0.2, 0.2, 0.2), shape="BOX", active=True, parent=None):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.0))
        obj = bpy.context.object
        obj.name = name
        for v in obj.data.vertices:
            v.co = [c * s for c, s in zip(v.co, size)]
        obj.data.update()
        obj.location = place
        if parent is not None:
            obj.parent = parent
        bpy.ops.rigidbody.object_add()
        obj.rigid_body.type = "ACTIVE" if active else "PASSIVE"
        obj.rigid_body.mass = mass
        obj.rigid_body.collision_shape = shape
        bpy.context.view_layer.update()
        return obj

    def empty(self, name, place=(0.0, 0.0, 0.0), parent=None):
        obj = bpy.data.objects.new(name, None)
        bpy.context.scene.collection.objects.link(obj)
        obj.location = place
        obj.parent = parent
        bpy.context.view_layer.update()
        return obj

    def select(self, active, *others):
        bpy.ops.object.select_all(action="DESELECT")
        for obj in (active, *others):
            obj.select_set(True)
        bpy.context.view_layer.objects.active = active

    def spring(self, a, b, **numbers):
        """An element from a to b by the operator; what it made."""
        self.select(a, b)
        assert bpy.ops.coilover.between(**numbers) == {"FINISHED"}
        bpy.context.view_layer.update()
        return bpy.context.object

    def export(self, name="scene.glb", **options):
        path = self.folder / name
        kind = "GLB" if name.endswith(".glb") else "GLTF_SEPARATE"
        assert bpy.ops.export_scene.gltf(filepath=str(path), export_format=kind, **options) == {"FINISHED"}
        return Glb(path)


class Glb:
    """The JSON of a .glb file."""

    def __init__(self, path):
        self.path = path
        data = Path(path).read_bytes()
        length = struct.unpack("<I", data[12:16])[0]
        self.json = json.loads(data[20 : 20 + length])

    def node(self, name):
        found = [n for n in self.json["nodes"] if n["name"] == name]
        assert len(found) == 1, (name, [n["name"] for n in self.json["nodes"]])
        return found[0]

    def said(self, name, extension="BEVY_coilover"):
        return self.node(name).get("extensions", {}).get(extension)

    def elements(self):
        return {n["name"]: n["extensions"]["BEVY_coilover"] for n in self.json["nodes"]
                if "BEVY_coilover" in n.get("extensions", {})}

    def name(self, index):
        return self.json["nodes"][index]["name"]


@pytest.fixture
def scene(tmp_path, blender):
    return Scene(tmp_path)
