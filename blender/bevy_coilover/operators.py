# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a designer clicks."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty

from . import ends, make, physics, preview
from .fields import KINDS
from .properties import elements, is_element

UNDO = {"REGISTER", "UNDO"}


class Numbers:
    """What every operator asks that makes elements."""

    kind: EnumProperty(name="Element", items=KINDS, default="springDamper")
    stiffness: FloatProperty(name="Stiffness (N/m)", default=1000.0, min=0.0)
    damping: FloatProperty(name="Damping (N s/m)", default=60.0, min=0.0)

    def add(self, context, a, b):
        obj = make.new_element(context.scene, a, b, self.kind)
        obj.coilover.stiffness, obj.coilover.damping = self.stiffness, self.damping
        return obj

    def done(self, context, made):
        for obj in context.selected_objects:
            obj.select_set(False)
        for obj in made:
            obj.select_set(True)
        if made:
            context.view_layer.objects.active = made[-1]
        self.report({"INFO"}, f"{len(made)} element{'s' if len(made) != 1 else ''} added")
        return {"FINISHED"}


def others(context):
    """The selected objects that can be ends, but for the active one."""
    return sorted((o for o in context.selected_objects if o != context.active_object and not is_element(o)),
                  key=lambda o: o.name)


class COILOVER_OT_between(Numbers, bpy.types.Operator):
    """Adds an element from the active object (end A) to each other selected object. With one object, to a hook above it"""

    bl_idname, bl_label, bl_options = "coilover.between", "Add Spring Between Selected", UNDO

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and context.active_object is not None and not is_element(context.active_object)

    def execute(self, context):
        active = context.active_object
        found = others(context)
        if found:
            return self.done(context, [self.add(context, active, o) for o in found])
        hook = bpy.data.objects.new(active.name + " Hook", None)
        context.collection.objects.link(hook)
        hook.location = active.matrix_world.translation
        hook.location.z += max(1.0, 1.5 * active.dimensions.z)
        hook.empty_display_type, hook.empty_display_size = "SPHERE", 0.05
        context.view_layer.update()
        return self.done(context, [self.add(context, hook, active)])


class COILOVER_OT_chain(Numbers, bpy.types.Operator):
    """Adds elements from the active object to the nearest selected one, from there to the next, and so on"""

    bl_idname, bl_label, bl_options = "coilover.chain", "Chain Through Selected", UNDO
    closed: BoolProperty(name="Closed", description="From the last to the first as well")

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and context.active_object is not None and bool(others(context))

    def execute(self, context):
        pairs = make.chain(context.active_object, others(context), self.closed)
        return self.done(context, [self.add(context, a, b) for a, b in pairs])


class COILOVER_OT_lattice(Numbers, bpy.types.Operator):
    """Makes a ball of each corner of the active mesh and an element of each edge. Selected corners are held, unless all are"""

    bl_idname, bl_label, bl_options = "coilover.lattice", "Lattice From Mesh Edges", UNDO
    mass: FloatProperty(name="Mass of All", default=1.0, min=1e-6, unit="MASS")
    radius: FloatProperty(name="Ball Radius", default=0.05, min=1e-4, unit="LENGTH")
    group: StringProperty(name="Held", description="Vertex group whose corners are held; without one, the selected ones")
    diagonals: BoolProperty(name="Diagonals", description="Elements across the faces too")
    hide: BoolProperty(name="Hide Mesh", default=True, description="Hide the mesh that it was made from")

    @classmethod
    def poll(cls, context):
        active = context.active_object
        return context.mode == "OBJECT" and active is not None and active.type == "MESH"

    def execute(self, context):
        source = context.active_object
        if not source.data.edges:
            self.report({"ERROR"}, f"{source.name} has no edges")
            return {"CANCELLED"}
        try:
            held = make.pins(source, self.group)
        except ValueError as wrong:
            self.report({"ERROR"}, str(wrong))
            return {"CANCELLED"}
        _, made = make.lattice(context, source, self.kind, self.mass, self.radius, held, self.diagonals,
                               self.stiffness, self.damping)
        if self.hide:
            source.hide_set(True)
            source.hide_render = True
        return self.done(context, made)


class OfElement:
    """Needs an element as the active object."""

    @classmethod
    def poll(cls, context):
        return is_element(context.object)


class COILOVER_OT_tune(OfElement, bpy.types.Operator):
    """Sets stiffness and damping from a natural frequency and a damping ratio, for the masses of the ends"""

    bl_idname, bl_label, bl_options = "coilover.tune", "Set From Frequency", UNDO
    frequency: FloatProperty(name="Frequency (Hz)", default=2.0, min=1e-4)
    ratio: FloatProperty(name="Damping Ratio", default=0.3, min=0.0)

    def invoke(self, context, event):
        element = context.object.coilover
        mass = physics.effective_mass(element)
        if mass is not None and element.stiffness > 0.0:
            self.frequency = physics.frequency(element.stiffness, mass)
            self.ratio = physics.damping_ratio(element.stiffness, element.damping, mass)
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        element = context.object.coilover
        mass = physics.effective_mass(element)
        if mass is None:
            self.report({"ERROR"}, "Neither end is an active rigid body, so there is no mass to swing")
            return {"CANCELLED"}
        element.stiffness, element.damping = physics.coefficients(self.frequency, self.ratio, mass)
        return {"FINISHED"}


class COILOVER_OT_rest(OfElement, bpy.types.Operator):
    """Makes the length of now the rest length"""

    bl_idname, bl_label, bl_options = "coilover.rest", "Take Rest Length From Now", UNDO

    def execute(self, context):
        make.take_rest(context.object.coilover)
        return {"FINISHED"}


class COILOVER_OT_swap(OfElement, bpy.types.Operator):
    """Exchanges end A and end B"""

    bl_idname, bl_label, bl_options = "coilover.swap", "Swap Ends", UNDO

    def execute(self, context):
        e = context.object.coilover
        e.a, e.b = e.b, e.a
        e.anchor_a, e.anchor_b = tuple(e.anchor_b), tuple(e.anchor_a)
        return {"FINISHED"}


class COILOVER_OT_anchor(OfElement, bpy.types.Operator):
    """Holds this end at the 3D cursor"""

    bl_idname, bl_label, bl_options = "coilover.anchor", "Anchor At 3D Cursor", UNDO
    end: EnumProperty(items=[("a", "End A", ""), ("b", "End B", "")])

    def execute(self, context):
        element = context.object.coilover
        if getattr(element, self.end) is None:
            self.report({"ERROR"}, f"End {self.end.upper()} is missing")
            return {"CANCELLED"}
        make.anchor_at(element, self.end, context.scene.cursor.location)
        return {"FINISHED"}


class COILOVER_OT_copy(OfElement, bpy.types.Operator):
    """Gives the other selected elements all the numbers of the active one, but for ends and anchors"""

    bl_idname, bl_label, bl_options = "coilover.copy", "Copy Numbers To Selected", UNDO

    def execute(self, context):
        from .gltf_read import fill
        from .gltf_write import describe

        source = context.object
        content = describe(source.coilover)
        content.pop("anchors", None)
        found = [o for o in context.selected_objects if o != source and is_element(o)]
        for obj in found:
            fill(obj.coilover, content)
        self.report({"INFO"}, f"{len(found)} elements changed")
        return {"FINISHED"}


class COILOVER_OT_meshes(bpy.types.Operator):
    """Makes meshes of the coils and telescopes as they are now, for a picture. They are left out of a glTF file"""

    bl_idname, bl_label, bl_options = "coilover.meshes", "Make Meshes", UNDO
    remove: BoolProperty(name="Remove", description="Remove them instead")

    def execute(self, context):
        made = 0
        for obj in elements(context.scene):
            if self.remove:
                preview.clear_meshes(obj)
            else:
                made += len(preview.make_meshes(obj, context.scene))
        self.report({"INFO"}, "Meshes removed" if self.remove else f"{made} meshes made")
        return {"FINISHED"}


class COILOVER_OT_check(bpy.types.Operator):
    """Looks through all elements of the scene for what Bevy would call a fault"""

    bl_idname, bl_label = "coilover.check", "Check All"

    def execute(self, context):
        found = [(obj.name, fault) for obj in elements(context.scene) for fault in ends.faults(obj.coilover)]
        for name, fault in found:
            self.report({"WARNING"}, f"{name}: {fault}")
        if not found:
            self.report({"INFO"}, "All elements can act")
        return {"FINISHED"}


CLASSES = (
    COILOVER_OT_between,
    COILOVER_OT_chain,
    COILOVER_OT_lattice,
    COILOVER_OT_tune,
    COILOVER_OT_rest,
    COILOVER_OT_swap,
    COILOVER_OT_anchor,
    COILOVER_OT_copy,
    COILOVER_OT_meshes,
    COILOVER_OT_check,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
