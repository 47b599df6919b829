# SPDX-License-Identifier: MIT OR Apache-2.0
"""Elements out of a file, through hooks of Blender's own glTF importer."""

import logging
import math

from .axes import to_blender
from .fields import COMPANIONS, KINDS, NAME, is_torsion
from .properties import variant_prop


def finite(x):
    return float(x) if isinstance(x, (int, float)) and not isinstance(x, bool) and math.isfinite(x) else None


def vector(x, count=3):
    """So many finite numbers, or None."""
    if not isinstance(x, list) or len(x) != count or any(finite(v) is None for v in x):
        return None
    return [float(v) for v in x]


def at(content, path):
    """`a.b` in nested objects; None where it is not there."""
    for step in path.split("."):
        content = content.get(step) if isinstance(content, dict) else None
    return content


def spelled(said, names):
    """A name of several, whose first letter may be small in the file; None for another."""
    return next((name for name in names if isinstance(said, str) and said[:1].upper() + said[1:] == name), None)


def set_value(group, name, field, said, axes, scale):
    """Sets one property; what is not of its kind is left as it was, and False comes back."""
    if field.optional:
        setattr(group, "use_" + name, said is not None)
    if said is None:
        return True
    if field.kind == "number":
        x = finite(said)
        if x is not None:
            setattr(group, name, x * (scale if field.unit == "LENGTH" and not getattr(group, "fitted", False) else 1.0))
        return x is not None
    if field.kind in ("vector", "color"):
        if field.kind == "color" and isinstance(said, list) and len(said) == 3:
            said = [*said, 1.0]
        v = vector(said, 4 if field.kind == "color" else 3)
        if v is not None:
            setattr(group, name, axes(v) if field.kind == "vector" else v)
        return v is not None
    if field.kind == "choice":
        found = spelled(said, field.choices)
        if found is not None:
            setattr(group, name, found)
        return found is not None
    if field.kind == "flag":
        if isinstance(said, bool):
            setattr(group, name, said)
        return isinstance(said, bool)
    points = [vector(p, 2) for p in said] if isinstance(said, list) else [None]
    if None in points:
        return False
    table = getattr(group, name)
    table.clear()
    for x, y in points:
        point = table.add()
        point.x, point.y = x, y
    return True


def fill_companion(companion, group, said, axes, scale):
    """Sets a companion; yields the names of what could not be read."""
    if companion.variants:
        as_said = said if isinstance(said, str) else next(iter(said), None) if isinstance(said, dict) else None
        name = spelled(as_said, [variant for variant, _ in companion.variants])
        if name is None:
            yield companion.key
            return
        group.variant, fields = name, dict(companion.variants)[name]
        inner = said[as_said] if isinstance(said, dict) else {}
        for field in fields:
            found = inner if companion.key == "springAxis" else at(inner, field.key)
            if not set_value(group, variant_prop(companion, name, field), field, found, axes, scale):
                yield f"{companion.key}.{name}.{field.key}"
    elif not companion.fields:
        group.use = said is True
    elif companion.bare:
        field = companion.fields[0]
        if not set_value(group, field.prop, field, said, axes, scale):
            yield companion.key
    elif isinstance(said, dict):
        for field in companion.fields:
            if not set_value(group, field.prop, field, at(said, field.key), axes, scale):
                yield f"{companion.key}.{field.key}"
    else:
        yield companion.key


def fill(element, content, axes=to_blender, scale=1.0, anchor_axes=None):
    """Sets all of an element but its ends from the extension's object; a list of what could not be read."""
    kinds = [k for k, _, _ in KINDS if k in content]
    if len(kinds) != 1:
        return [f"needs exactly one element, but has {len(kinds)}"]
    kind, wrong = kinds[0], []
    core = content[kind]
    if not isinstance(core, dict):
        return [kind]
    element.kind = kind
    for key in ("stiffness", "damping"):
        if hasattr(element, key):
            # What is not said is one, as in Rust.
            x = finite(core.get(key, 1.0))
            if x is None:
                wrong.append(f"{kind}.{key}")
            else:
                setattr(element, key, x)
    rest = core.get("restAngle" if is_torsion(kind) else "restLength")
    element.use_rest = rest is not None
    if rest is not None and finite(rest) is None:
        wrong.append(f"{kind}.rest")
    elif rest is not None and is_torsion(kind):
        element.rest_angle = rest
    elif rest is not None:
        element.rest_length = rest * scale
    a_axes, b_axes = anchor_axes or (axes, axes)
    if is_torsion(kind):
        axis = vector(core.get("axis"))
        if axis is None:
            wrong.append(f"{kind}.axis")
        else:
            element.axis = axes(axis)
    if "anchors" in content:
        for end, turn in (("a", a_axes), ("b", b_axes)):
            point = vector(at(content["anchors"], end))
            if point is None:
                wrong.append(f"anchors.{end}")
            else:
                setattr(element, "anchor_" + end, [scale * x for x in turn(point)])
    for companion in COMPANIONS:
        group = getattr(element, companion.prop)
        group.use = companion.key in content
        if group.use:
            wrong += fill_companion(companion, group, content[companion.key], axes, scale)
    known = {kind, "anchors", "extensions", "extras", *(c.key for c in COMPANIONS)}
    return wrong + [key for key in content if key not in known]


def warn(gltf, text):
    """A line for the user; Blender 4.2's importer keeps all of its own to itself."""
    logger = getattr(gltf.log, "logger", None)
    if logger is not None and logger.isEnabledFor(logging.WARNING):
        gltf.log.warning(text)
    else:
        print("WARNING:", text)


class glTF2ImportUserExtension:
    """Found by Blender's importer in the add-on's module, by this name."""

    def __init__(self):
        from io_scene_gltf2.io.com.gltf2_io_extensions import Extension

        self.extensions = [Extension(NAME, {}, True)]
        self.objects, self.joints = {}, []

    def gather_import_gltf_before_hook(self, gltf):
        from .gltf_read_bodies import take_joints

        self.joints = take_joints(gltf)

    def gather_import_node_after_hook(self, vnode, node, obj, gltf):
        if node is not None and node.extensions and NAME in node.extensions:
            self.objects[obj.name] = node.extensions[NAME]

    def gather_import_scene_after_nodes_hook(self, gltf_scene, scene, gltf):
        import bpy

        scale = 1.0 / scene.unit_settings.scale_length
        of = {i: getattr(v, "blender_object", None) for i, v in gltf.vnodes.items() if isinstance(i, int)}
        turned = lambda o: tuple if o is not None and o.type in ("CAMERA", "LIGHT") else to_blender
        for name, content in self.objects.items():
            element = bpy.data.objects[name].coilover
            core = next((content[k] for k, _, _ in KINDS if isinstance(content.get(k), dict)), {})
            for end in ("a", "b"):
                target = core.get(end)
                if isinstance(target, int) and of.get(target) is not None:
                    setattr(element, end, of[target])
                else:
                    warn(gltf, f"{name}: end {end.upper()} is {target!r}, which is no node")
            for what in fill(element, content, to_blender, scale, (turned(element.a), turned(element.b))):
                warn(gltf, f"{name}: {NAME}: {what} could not be read")
        if scene.coilover.bodies != "NEVER":
            from .gltf_read_bodies import read

            read(gltf, of, self.joints)
