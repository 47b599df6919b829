# SPDX-License-Identifier: MIT OR Apache-2.0
"""The panels: in Physics properties, in the viewport's sidebar, and in the Add menu."""

import bpy

from . import ends, physics
from .fields import COMPANIONS, has_damper, has_spring, is_torsion
from .properties import is_element, variant_prop


class OfObject:
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "physics"


def row_of(layout, group, name, field):
    """One value, with its tick box where it may be left out."""
    if field.kind == "points":
        points(layout, group, name)
    elif field.optional:
        row = layout.row(heading=field.label, align=True)
        row.prop(group, "use_" + name, text="")
        sub = row.row()
        sub.active = getattr(group, "use_" + name)
        sub.prop(group, name, text="")
    else:
        layout.prop(group, name)


def points(layout, group, name):
    for i, point in enumerate(getattr(group, name)):
        row = layout.row(align=True)
        row.prop(point, "x", text=str(i + 1))
        row.prop(point, "y", text="")
    row = layout.row(align=True)
    for label, more in (("Add Point", True), ("Remove", False)):
        button = row.operator("coilover.points", text=label)
        button.path, button.more = f"{group.path_from_id()}.{name}", more


class COILOVER_OT_points(bpy.types.Operator):
    """Adds a point to a table, or removes the last one"""

    bl_idname, bl_label, bl_options = "coilover.points", "Points", {"REGISTER", "UNDO", "INTERNAL"}
    path: bpy.props.StringProperty()
    more: bpy.props.BoolProperty(default=True)

    def execute(self, context):
        table = context.object.path_resolve(self.path)
        if self.more:
            last = table[-1] if table else None
            x, y = (last.x + 0.1, last.y + 100.0) if last else (0.0, 0.0)
            point = table.add()
            point.x, point.y = x, y
        elif table:
            table.remove(len(table) - 1)
        return {"FINISHED"}


class COILOVER_PT_element(OfObject, bpy.types.Panel):
    bl_idname, bl_label = "COILOVER_PT_element", "Spring (Bevy Coilover)"

    @classmethod
    def poll(cls, context):
        return context.object is not None

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        element = context.object.coilover
        layout.prop(element, "kind")
        if not is_element(context.object):
            return
        kind = element.kind
        for end in ("a", "b"):
            row = layout.row(align=True)
            row.prop(element, end)
            if end == "a":
                row.operator("coilover.swap", text="", icon="ARROW_LEFTRIGHT")
        for fault in ends.faults(element):
            layout.label(text=fault, icon="ERROR")

        turning = is_torsion(kind)
        column = layout.column()
        if has_spring(kind):
            column.prop(element, "stiffness", text="Stiffness (N m/rad)" if turning else "Stiffness (N/m)")
        if has_damper(kind):
            column.prop(element, "damping", text="Damping (N m s/rad)" if turning else "Damping (N s/m)")
        if has_spring(kind):
            name = "rest_angle" if turning else "rest_length"
            row = column.row(heading="Rest Angle" if turning else "Rest Length", align=True)
            row.prop(element, "use_rest", text="")
            sub = row.row(align=True)
            sub.active = element.use_rest
            sub.prop(element, name, text="")
            if not turning:
                row.operator("coilover.rest", text="", icon="DRIVER_DISTANCE")
        if turning:
            column.prop(element, "axis")
        found(layout, context, element)


def found(layout, context, element):
    """What follows from the numbers and the masses."""
    mass = physics.effective_mass(element)
    box = layout.box().column(align=True)
    span = None if is_torsion(element.kind) else ends.length(element)
    if span is not None:
        box.label(text=f"Length now: {span:.3f} m")
    if mass is None:
        box.label(text="Frequency: no active rigid body at an end")
        return
    unit = "kg m²" if is_torsion(element.kind) else "kg"
    box.label(text=f"Moves {mass:.4g} {unit} (joints not counted)")
    if has_spring(element.kind) and element.stiffness > 0.0:
        box.label(text=f"Natural frequency: {physics.frequency(element.stiffness, mass):.3f} Hz")
        if has_damper(element.kind):
            ratio = physics.damping_ratio(element.stiffness, element.damping, mass)
            word = "swings" if ratio < 1.0 else "creeps"
            box.label(text=f"Damping ratio: {ratio:.3f} ({word})")
        given = physics.sag(element, context.scene)
        if given is not None:
            box.label(text=f"Sag under all of it: {given:.4g} m")
    if has_spring(element.kind):
        layout.operator("coilover.tune")


class COILOVER_PT_anchors(OfObject, bpy.types.Panel):
    bl_idname, bl_label, bl_parent_id = "COILOVER_PT_anchors", "Anchors", "COILOVER_PT_element"

    @classmethod
    def poll(cls, context):
        return is_element(context.object) and not is_torsion(context.object.coilover.kind)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for end in ("a", "b"):
            layout.prop(context.object.coilover, "anchor_" + end)
            layout.operator("coilover.anchor").end = end


def companion_panel(companion):
    """The sub-panel of one companion, with its tick box in the header."""

    def poll(cls, context):
        return is_element(context.object) and not (companion.linear and is_torsion(context.object.coilover.kind))

    def draw_header(self, context):
        self.layout.prop(getattr(context.object.coilover, companion.prop), "use", text="")

    def draw(self, context):
        group = getattr(context.object.coilover, companion.prop)
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.active = group.use
        for field in companion.fields:
            row_of(layout, group, field.prop, field)
        if companion.variants:
            layout.prop(group, "variant")
            for field in dict(companion.variants)[group.variant]:
                row_of(layout, group, variant_prop(companion, group.variant, field), field)

    name = "COILOVER_PT_" + companion.prop
    return type(name, (OfObject, bpy.types.Panel), {
        "bl_idname": name,
        "bl_label": companion.label,
        "bl_parent_id": "COILOVER_PT_element",
        "bl_options": {"DEFAULT_CLOSED"},
        "poll": classmethod(poll),
        "draw_header": draw_header,
        "draw": draw,
    })


def tools(layout):
    column = layout.column(align=True)
    column.operator("coilover.between", icon="LINKED")
    column.operator("coilover.chain", icon="IPO_LINEAR")
    column.operator("coilover.lattice", icon="MESH_GRID")


class COILOVER_PT_tools(bpy.types.Panel):
    bl_idname, bl_label, bl_category = "COILOVER_PT_tools", "Springs", "Coilover"
    bl_space_type, bl_region_type = "VIEW_3D", "UI"

    def draw(self, context):
        layout = self.layout
        tools(layout)
        column = layout.column(align=True)
        column.operator("coilover.copy", icon="COPYDOWN")
        column.operator("coilover.check", icon="CHECKMARK")
        scene = context.scene.coilover
        column = layout.column()
        column.prop(scene, "show")
        column.prop(scene, "detail")
        row = layout.row(align=True)
        row.operator("coilover.meshes", icon="MESH_DATA").remove = False
        row.operator("coilover.meshes", text="Remove").remove = True
        layout.prop(scene, "bodies")


class COILOVER_MT_add(bpy.types.Menu):
    bl_idname, bl_label = "COILOVER_MT_add", "Spring"

    def draw(self, context):
        tools(self.layout)


def in_add_menu(self, context):
    self.layout.menu("COILOVER_MT_add", icon="FORCE_HARMONIC")


CLASSES = (
    COILOVER_OT_points,
    COILOVER_PT_element,
    COILOVER_PT_anchors,
    *map(companion_panel, COMPANIONS),
    COILOVER_PT_tools,
    COILOVER_MT_add,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_add.append(in_add_menu)


def unregister():
    bpy.types.VIEW3D_MT_add.remove(in_add_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
