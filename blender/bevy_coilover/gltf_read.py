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


def as_kind(field, said, axes, scale):
    """What a file says, as the value of a property; None where it is not of the field's kind."""
    if field.kind == "number":
        x = finite(said)
        return None if x is None else x * scale
    if field.kind == "vector":
        v = vector(said)
        return None if v is None else axes(v)
    if field.kind == "color":
        return vector([*said, 1.0] if isinstance(said, list) and len(said) == 3 else said, 4)
    if field.kind == "choice":
        return spelled(said, field.choices)
    if field.kind == "flag":
        return said if isinstance(said, bool) else None
    points = [vector(p, 2) for p in said] if isinstance(said, list) else [None]
    return None if None in points else points


def left_open(group, field, scale):
    """What a field is that a file leaves out: the default of the format, as the crate reads it."""
    if field.fitted is not None and group.fitted:
        return field.fitted
    found = field.default if field.absent is None else field.absent
    return found * scale if field.unit == "LENGTH" else found


def kept(group, name, value):
    """Sets a property; False where Blender has put it between the property's limits."""
    setattr(group, name, value)
    found = getattr(group, name)
    if not isinstance(value, float):
        return True
    return math.isclose(found, value, rel_tol=1e-5, abs_tol=1e-9)


def set_points(table, points):
    table.clear()
    for x, y in points:
        point = table.add()
        point.x, point.y = x, y
    return True


def set_value(group, name, field, said, axes, scale):
    """Sets one property. What is absent, or not of its kind, is what the crate takes for it. False comes back for what
    is not of its kind or not within the limits, and for what the companion cannot be without."""
    own = 1.0 if getattr(group, "fitted", False) or field.unit != "LENGTH" else scale
    found = None if said is None else as_kind(field, said, axes, own)
    if field.optional:
        setattr(group, "use_" + name, found is not None)
    right = found is not None or (said is None and not field.required)
    if found is None:
        found = left_open(group, field, scale)
    if field.kind == "points":
        return set_points(getattr(group, name), found) and right
    return kept(group, name, found) and right


def fill_variant(companion, group, said, axes, scale):
    """Sets an enum of Rust; yields the names of what could not be read."""
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
            if field.required and as_kind(field, found, axes, scale) is None:
                yield companion.key


def fill_companion(companion, group, said, axes, scale):
    """Sets a companion; yields the names of what could not be read, with its own where it is left out as a whole."""
    if companion.variants:
        yield from fill_variant(companion, group, said, axes, scale)
    elif not companion.fields:
        group.use = said is True
        if not isinstance(said, bool):
            yield companion.key
    elif companion.bare:
        field = companion.fields[0]
        if as_kind(field, said, axes, scale) is None:
            yield companion.key
        elif not set_value(group, field.prop, field, said, axes, scale):
            yield f"{companion.key}.{field.key}"
    elif isinstance(said, dict):
        for field in companion.fields:
            if not set_value(group, field.prop, field, at(said, field.key), axes, scale):
                yield f"{companion.key}.{field.key}"
    else:
        yield companion.key


def fill_companions(element, content, axes, scale):
    """Sets all companions; yields the names of what could not be read. One that is left out is not used."""
    for companion in COMPANIONS:
        group = getattr(element, companion.prop)
        group.use = companion.key in content
        if group.use:
            for wrong in fill_companion(companion, group, content[companion.key], axes, scale):
                yield wrong
                group.use = group.use and wrong != companion.key


def fill_anchors(element, anchors, turns, scale):
    """Sets both anchors, of which each may be left out; yields the names of what could not be read."""
    if not isinstance(anchors, dict):
        yield "anchors"
        return
    for end, turn in zip("ab", turns):
        point = vector(anchors.get(end, [0.0, 0.0, 0.0]))
        if point is None:
            yield f"anchors.{end}"
        else:
            setattr(element, "anchor_" + end, [scale * x for x in turn(point)])


def fill_core(element, kind, core, axes, scale):
    """Sets what is inside the element's own key but its ends; yields the names of what could not be read."""
    for key in ("stiffness", "damping"):
        # What is not said is one, as in Rust.
        x = finite(core.get(key, 1.0))
        if not kept(element, key, 1.0 if x is None else x) or x is None:
            yield f"{kind}.{key}"
    said = core.get("restAngle" if is_torsion(kind) else "restLength")
    rest = finite(said)
    element.use_rest = rest is not None
    if said is not None and rest is None:
        yield f"{kind}.rest"
    elif rest is not None and is_torsion(kind):
        element.rest_angle = rest
    elif rest is not None:
        element.rest_length = rest * scale
    if is_torsion(kind):
        axis = vector(core.get("axis"))
        element.axis = axes(axis or (0.0, 0.0, 0.0))
        if axis is None:
            yield f"{kind}.axis"


def fill(element, content, axes=to_blender, scale=1.0, anchor_axes=None):
    """Sets all of an element but its ends from the extension's object; a list of what could not be read."""
    kinds = [k for k, _, _ in KINDS if k in content]
    if len(kinds) != 1:
        return [f"needs exactly one element, but has {len(kinds)}"]
    (kind,) = kinds
    if not isinstance(content[kind], dict):
        return [kind]
    element.kind = kind
    wrong = list(fill_core(element, kind, content[kind], axes, scale))
    if "anchors" in content:
        wrong += fill_anchors(element, content["anchors"], anchor_axes or (axes, axes), scale)
    # The lengths of a torsion element are angles.
    wrong += fill_companions(element, content, axes, 1.0 if is_torsion(kind) else scale)
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
