# SPDX-License-Identifier: MIT OR Apache-2.0
"""Every panel draws, with every kind of element: its properties and operators are there. (`bpy` has no window.)"""

from types import SimpleNamespace

import bpy
import pytest

from bevy_coilover import fields, panel


class Layout:
    """Takes what a panel draws, and looks whether it exists."""

    def __init__(self, seen):
        self.seen = seen

    def prop(self, data, name, **_):
        assert name in data.bl_rna.properties, f"{data} has no {name}"
        self.seen.append((data.bl_rna.identifier, name))

    def operator(self, name, **_):
        group, own = name.split(".")
        kind = getattr(getattr(bpy.ops, group), own).get_rna_type()
        return SimpleNamespace(**{p.identifier: None for p in kind.properties})

    def label(self, **more):
        self.seen.append(("label", more["text"]))

    def menu(self, name, **_):
        assert hasattr(bpy.types, name)

    def row(self, **_):
        return self

    column = box = row


def drawn(obj):
    """What all panels of an object show."""
    seen = []
    context = SimpleNamespace(object=obj, scene=bpy.context.scene)
    for cls in panel.CLASSES:
        if issubclass(cls, bpy.types.Panel) and getattr(cls, "bl_context", "") == "physics" and cls.poll(context):
            own = SimpleNamespace(layout=Layout(seen))
            if hasattr(cls, "draw_header"):
                cls.draw_header(own, context)
            cls.draw(own, context)
    return seen


@pytest.mark.parametrize("kind", [k for k, _, _ in fields.KINDS])
def test_every_panel_shows_every_field_of_every_variant(scene, kind):
    obj = scene.spring(scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1)), kind=kind)
    element, shown = obj.coilover, set()
    longest = max(len(c.variants) for c in fields.COMPANIONS)
    for turn in range(longest):
        for companion in fields.COMPANIONS:
            group = getattr(element, companion.prop)
            group.use = True
            if companion.variants:
                group.variant = companion.variants[turn % len(companion.variants)][0]
                for name, inner in companion.variants:
                    for field in inner:
                        table = getattr(group, panel.variant_prop(companion, name, field))
                        if field.kind == "points" and not table:
                            table.add()
        shown |= set(drawn(obj))
    for companion in fields.COMPANIONS:
        if companion.linear and fields.is_torsion(kind):
            continue
        group = getattr(element, companion.prop)
        for prop in group.bl_rna.properties:
            wanted = (group.bl_rna.identifier, prop.identifier)
            if prop.type != "COLLECTION" and prop.identifier not in ("rna_type", "name"):
                assert wanted in shown, wanted


def test_the_panel_says_frequency_and_damping_ratio(scene):
    hook, load = scene.empty("Hook", (0, 0, 2)), scene.body("Load", (0, 0, 1), mass=2.0)
    obj = scene.spring(hook, load, stiffness=80.0, damping=1.0)
    said = [text for kind, text in drawn(obj) if kind == "label"]
    assert "Natural frequency: 1.007 Hz" in said
    assert "Damping ratio: 0.040 (swings)" in said
    assert "Sag under all of it: 0.2453 m" in said


def test_the_panel_says_what_is_wrong(scene):
    obj = scene.spring(scene.empty("A"), scene.empty("B", (0, 0, 1)))
    assert ("label", "Neither end is an active rigid body: nothing will move") in drawn(obj)


def test_an_object_that_is_no_element_shows_the_choice_alone(scene):
    assert [name for _, name in drawn(scene.empty("E"))] == ["kind"]


def test_points_are_added_and_removed(scene):
    obj = scene.spring(scene.body("A", (0, 0, 0)), scene.body("B", (0, 0, 1)))
    path = "coilover.spring_law.table_points"
    for _ in range(3):
        bpy.ops.coilover.points(path=path, more=True)
    bpy.ops.coilover.points(path=path, more=False)
    points = obj.coilover.spring_law.table_points
    assert [round(p.x, 3) for p in points] == [0.0, 0.1]
    assert points[1].y > points[0].y


def test_the_sidebar_and_the_add_menu_draw(scene):
    seen = []
    for cls in (panel.COILOVER_PT_tools, panel.COILOVER_MT_add):
        cls.draw(SimpleNamespace(layout=Layout(seen)), SimpleNamespace(object=None, scene=bpy.context.scene))
    assert ("CoiloverScene", "show") in seen
    panel.in_add_menu(SimpleNamespace(layout=Layout(seen)), None)
