# SPDX-License-Identifier: MIT OR Apache-2.0
"""Elements into the file, through hooks of Blender's own glTF exporter.

Nodes and objects are collected while the exporter gathers them. When all nodes have their numbers, each element's object
says what it is in the extension `BEVY_coilover` of its node. (A node put into an extension earlier becomes its number by
itself, but an end above its element, or a mesh that collides as itself, would send the exporter round in circles.)
"""

import bpy

from . import gltf_bodies, gltf_joints
from .axes import short, to_gltf
from .fields import COMPANIONS, NAME, has_damper, has_spring, is_torsion
from .properties import is_element, variant_prop
from .tree import parents, steps


def value(group, name, field, axes=to_gltf):
    """One value as JSON, or None where it is left out."""
    if field.optional and not getattr(group, "use_" + name):
        return None
    found = getattr(group, name)
    if field.kind == "number":
        return short(found)
    if field.kind == "vector":
        return [short(x) for x in axes(found)]
    if field.kind == "color":
        return [short(x) for x in found]
    if field.kind == "points":
        return [[short(p.x), short(p.y)] for p in found]
    return found


def put(content, path, what):
    """Sets `a.b` in nested objects."""
    *outer, last = path.split(".")
    for step in outer:
        content = content.setdefault(step, {})
    if what is not None:
        content[last] = what


def variant(companion, group, axes):
    """An enum of Rust: the name alone, or the name with what it holds."""
    name = group.variant
    fields = dict(companion.variants)[name]
    if not fields:
        return name
    if companion.key == "springAxis":
        return {name: value(group, variant_prop(companion, name, fields[0]), fields[0], axes)}
    content = {}
    for field in fields:
        put(content, field.key, value(group, variant_prop(companion, name, field), field, axes))
    return {name: content}


def companion_json(companion, group, axes):
    if not companion.fields and not companion.variants:
        return True
    if companion.variants:
        return variant(companion, group, axes)
    if companion.bare:
        return value(group, companion.fields[0].prop, companion.fields[0], axes)
    content = {}
    for field in companion.fields:
        put(content, field.key, value(group, field.prop, field, axes))
    return content


def describe(element, axes=to_gltf):
    """All of an element but its ends, as the extension's object."""
    kind = element.kind
    core = {}
    if has_spring(kind):
        core["stiffness"] = short(element.stiffness)
    if has_damper(kind):
        core["damping"] = short(element.damping)
    if is_torsion(kind):
        core["axis"] = [short(x) for x in axes(element.axis)]
        if has_spring(kind) and element.use_rest:
            core["restAngle"] = short(element.rest_angle)
    elif has_spring(kind) and element.use_rest:
        core["restLength"] = short(element.rest_length)
    content = {kind: core}
    if not is_torsion(kind) and any((*element.anchor_a, *element.anchor_b)):
        content["anchors"] = {end: [short(x) for x in axes(getattr(element, "anchor_" + end))] for end in "ab"}
    for companion in COMPANIONS:
        group = getattr(element, companion.prop)
        if group.use and not (companion.linear and is_torsion(kind)):
            content[companion.key] = companion_json(companion, group, axes)
    return content


def warn(settings, text):
    """A line for the user, in the exporter's own report where it has one."""
    log = settings.get("log")
    try:
        log.warning(text, popup=True)
    except (AttributeError, TypeError):
        print("WARNING:", text)


class Gathered:
    """The nodes of a file, their numbers, and the objects that they came from."""

    def __init__(self):
        self.pairs = []
        self.nodes, self.number, self.parent = [], {}, {}

    def index(self, nodes):
        """Takes the file's list of nodes; what is not in it is forgotten."""
        self.nodes = nodes
        self.number = {id(node): i for i, node in enumerate(nodes)}
        self.parent = parents(nodes)
        self.pairs = [(node, obj) for node, obj in self.pairs if id(node) in self.number]

    def near(self, obj, node):
        """The number of an object's node; of several, as collections drawn twice have, the nearest one in the tree."""
        found = [self.number[id(n)] for n, o in self.pairs if o == obj]
        if len(found) < 2:
            return found[0] if found else None
        own = self.number[id(node)]
        return min(found, key=lambda other: steps(self.parent, own, other))

    def add(self, node, parent=None):
        """A new node below another one, or outside the scene."""
        self.nodes.append(node)
        number = len(self.nodes) - 1
        self.number[id(node)] = number
        if parent is not None:
            self.parent[number] = parent
            self.nodes[parent].children = (self.nodes[parent].children or []) + [number]
        return number


class Document:
    """The file's own extensions."""

    def __init__(self, gltf):
        self.gltf = gltf

    def use(self, name):
        self.gltf.extensions_used = self.gltf.extensions_used or []
        if name not in self.gltf.extensions_used:
            self.gltf.extensions_used.append(name)

    def put(self, node, name, content):
        """Sets a node's extension."""
        node.extensions = node.extensions or {}
        node.extensions[name] = content
        self.use(name)

    def shared(self, name, key, item):
        """The place of an item in a list of the file's extension; equal ones are one."""
        self.use(name)
        self.gltf.extensions = self.gltf.extensions or {}
        items = self.gltf.extensions.setdefault(name, {}).setdefault(key, [])
        if item not in items:
            items.append(item)
        return items.index(item)


def axes_of(obj, settings):
    """From an object's own frame to its node's: cameras and lights are turned by the exporter already."""
    if not settings.get("gltf_yup", True):
        return tuple
    turned = (obj.type == "CAMERA" and settings.get("gltf_cameras")) or (
        obj.type == "LIGHT" and settings.get("gltf_lights"))
    return tuple if turned else to_gltf


def content_of(obj, node, gathered, settings):
    """The extension of an element's node; None, with a warning, where it cannot be written."""
    element = obj.coilover
    axes = to_gltf if settings.get("gltf_yup", True) else tuple
    content = describe(element, axes)
    core = {}
    for end in ("a", "b"):
        target = getattr(element, end)
        found = None if target is None else gathered.near(target, node)
        if found is None:
            what = "is missing" if target is None else f"is {target.name}, which is not in the file"
            warn(settings, f"{obj.name}: end {end.upper()} {what}; the element is left out")
            return None
        core[end] = found
        if "anchors" in content:
            point = axes_of(target, settings)(getattr(element, "anchor_" + end))
            content["anchors"][end] = [short(x) for x in point]
    # Ends first, for whoever reads the file.
    content[element.kind] = {**core, **content[element.kind]}
    return {element.kind: content.pop(element.kind), **content}


class glTF2ExportUserExtension:
    """Found by Blender's exporter in the add-on's module, by this name."""

    def __init__(self):
        self.gathered = Gathered()

    def gather_node_hook(self, node, obj, settings):
        if isinstance(obj, bpy.types.Object):
            self.gathered.pairs.append((node, obj))

    def gather_scene_hook(self, scene, blender_scene, settings):
        # Meshes that were made for a picture are drawn by Bevy itself, and frames of joints are written anew.
        drawn = {id(node) for node, obj in self.gathered.pairs if obj.get("coilover_look") or obj.get(gltf_joints.MARK)}
        for node, _ in self.gathered.pairs:
            if node.children:
                node.children = [child for child in node.children if id(child) not in drawn]
        scene.nodes = [node for node in scene.nodes if id(node) not in drawn]

    def gather_gltf_extensions_hook(self, gltf, settings):
        gathered, document = self.gathered, Document(gltf)
        gathered.index(gltf.nodes)
        for node, obj in gathered.pairs:
            if is_element(obj):
                content = content_of(obj, node, gathered, settings)
                if content is not None:
                    document.put(node, NAME, content)
        if bpy.context.scene.coilover.bodies == "AUTO":
            gltf_bodies.write(gathered, document, settings)
