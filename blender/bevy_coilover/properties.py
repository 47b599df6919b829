# SPDX-License-Identifier: MIT OR Apache-2.0
"""The table of `fields`, as properties of Blender's objects."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
)

from .fields import COMPANIONS, KINDS


class CoiloverPoint(bpy.types.PropertyGroup):
    """A point of a table."""

    x: FloatProperty(name="x", description="Stretch (m) or rate (m/s)")
    y: FloatProperty(name="Force (N)", description="Force there, tension positive; never falling")


def words(name):
    """ClosedGround -> Closed Ground"""
    return "".join(" " + c if c.isupper() and i else c for i, c in enumerate(name))


def items(names):
    return [(name, words(name), "") for name in names]


def prop(field):
    """The property of one field."""
    said = {"name": field.label, "description": field.about}
    if field.kind == "number":
        more = {"precision": 4} if field.unit == "NONE" else {"precision": 3, "unit": field.unit}
        return FloatProperty(default=field.default, min=field.least, **more, **said)
    if field.kind == "vector":
        return FloatVectorProperty(default=field.default, size=3, subtype="XYZ", **said)
    if field.kind == "color":
        return FloatVectorProperty(default=field.default, size=4, subtype="COLOR", min=0.0, soft_max=1.0, **said)
    if field.kind == "flag":
        return BoolProperty(default=field.default, **said)
    if field.kind == "choice":
        return EnumProperty(items=items(field.choices), default=field.default, **said)
    return CollectionProperty(type=CoiloverPoint, **said)


def variant_prop(companion, variant, field):
    """Name of the property of a variant's field; variants do not share theirs."""
    return f"{variant.lower()}_{field.prop}"


def group(companion):
    """The property group of one companion."""
    notes = {"use": BoolProperty(name=companion.label, description=companion.about)}
    if companion.variants:
        names = [name for name, _ in companion.variants]
        notes["variant"] = EnumProperty(name="Kind", items=items(names), default=names[0])
    placed = [(f.prop, f) for f in companion.fields]
    for variant, fields in companion.variants:
        placed += [(variant_prop(companion, variant, f), f) for f in fields]
    for name, field in placed:
        notes[name] = prop(field)
        if field.optional:
            notes["use_" + name] = BoolProperty(name=field.label, description="Give it: " + field.about)
    name = "Coilover" + companion.key[0].upper() + companion.key[1:]
    return type(name, (bpy.types.PropertyGroup,), {"__annotations__": notes, "__doc__": companion.about})


GROUPS = {c.prop: group(c) for c in COMPANIONS}

NONE = ("NONE", "None", "This object is no element")


class CoiloverElement(bpy.types.PropertyGroup):
    """An element between two objects."""

    kind: EnumProperty(name="Element", items=[NONE, *KINDS], default="NONE", description="What acts between the ends")
    a: PointerProperty(type=bpy.types.Object, name="End A", description="The end that it starts from")
    b: PointerProperty(type=bpy.types.Object, name="End B", description="The end that it goes to")
    stiffness: FloatProperty(name="Stiffness", default=1000.0, min=0.0, precision=2, description="N/m, or N m/rad")
    damping: FloatProperty(name="Damping", default=60.0, min=0.0, precision=2, description="N s/m, or N m s/rad")
    use_rest: BoolProperty(name="Rest Length", description="Without it, the length at the first step is the rest length")
    rest_length: FloatProperty(name="Rest Length", default=1.0, unit="LENGTH", precision=3,
                               description="Length without force; may be negative along a direction")
    rest_angle: FloatProperty(name="Rest Angle", unit="ROTATION", description="Angle without moment")
    axis: FloatVectorProperty(name="Axis", size=3, default=(0.0, 0.0, 1.0), subtype="XYZ",
                              description="In the frame of end A's body")
    anchor_a: FloatVectorProperty(name="Anchor A", size=3, subtype="TRANSLATION", unit="LENGTH",
                                  description="Where it is held, in end A's frame")
    anchor_b: FloatVectorProperty(name="Anchor B", size=3, subtype="TRANSLATION", unit="LENGTH",
                                  description="Where it is held, in end B's frame")


for _name, _group in GROUPS.items():
    CoiloverElement.__annotations__[_name] = PointerProperty(type=_group)


class CoiloverScene(bpy.types.PropertyGroup):
    """Of a scene."""

    show: BoolProperty(name="Preview Springs", default=True, description="Draw coils and telescopes in the viewport")
    detail: IntProperty(name="Detail", default=24, min=6, max=64, description="Segments of a turn in the preview")
    bodies: EnumProperty(
        name="Rigid Bodies",
        items=[
            ("AUTO", "Where Missing", "Written unless another exporter writes KHR_physics_rigid_bodies"),
            ("NEVER", "Not", "Elements only"),
        ],
        description="Write Blender's rigid bodies and joints as KHR_physics_rigid_bodies",
    )


def is_element(obj):
    return obj is not None and obj.coilover.kind != "NONE"


def elements(scene):
    """The elements of a scene, in the order of their names."""
    return sorted((o for o in scene.objects if is_element(o)), key=lambda o: o.name)


def dress(element, kind):
    """Ticks the looks that a new element of this kind has."""
    for companion in COMPANIONS:
        getattr(element, companion.prop).use = kind in companion.of


CLASSES = (CoiloverPoint, *GROUPS.values(), CoiloverElement, CoiloverScene)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.coilover = PointerProperty(type=CoiloverElement)
    bpy.types.Scene.coilover = PointerProperty(type=CoiloverScene)


def unregister():
    del bpy.types.Scene.coilover
    del bpy.types.Object.coilover
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
