# SPDX-License-Identifier: MIT OR Apache-2.0
"""Springs and dampers between objects, exported to glTF for the Bevy crate `bevy_coilover`."""

# For Blender before 4.2, which reads no manifest.
bl_info = {
    "name": "Coilover: springs for Bevy",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Physics",
    "description": "Springs and dampers between objects, exported to glTF for Bevy",
    "category": "Physics",
}

from . import operators, panel, preview, properties
from .gltf_read import glTF2ImportUserExtension
from .gltf_write import glTF2ExportUserExtension

__all__ = ["glTF2ExportUserExtension", "glTF2ImportUserExtension", "register", "unregister"]

PARTS = (properties, operators, panel, preview)


def register():
    for part in PARTS:
        part.register()


def unregister():
    for part in reversed(PARTS):
        part.unregister()
