# SPDX-License-Identifier: MIT OR Apache-2.0
"""Takes the pictures of `docs/guide/blender.md`, in a Blender with a window:

    xvfb-run -s "-screen 0 1280x800x24" blender --factory-startup --window-geometry 0 0 1280 800 \\
        --python blender/pictures.py -- docs/guide

The package `bpy` has no window, so this needs a whole Blender, 3.4 or newer. A screen of software will do.
"""

import sys
from pathlib import Path

import addon_utils
import bpy
from mathutils import Euler

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
FOLDER = Path(sys.argv[-1]).resolve()


def area(kind):
    screen = bpy.context.window_manager.windows[0].screen
    return next(a for a in screen.areas if a.type == kind)


def within(kind):
    found = area(kind)
    region = next(r for r in found.regions if r.type == "WINDOW")
    return bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=found, region=region)


def clear():
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)


def lamp():
    """Steps 1 to 5 of the guide: a load, a hook, and a coilover between them."""
    clear()
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0, 0, 0.5))
    load = bpy.context.object
    load.name = "Load"
    bpy.ops.rigidbody.object_add()
    load.rigid_body.mass, load.rigid_body.collision_shape = 2.0, "BOX"
    bpy.ops.coilover.between(stiffness=80.0, damping=1.0)
    made = bpy.context.object
    made.name = "Spring"
    made.coilover.anchor_b = (0, 0, 0.25)
    made.coilover.telescope.eyes = True
    # Not marked as selected, so that it is seen in its own paint.
    made.select_set(False)


def trampoline():
    """Step 9: a mesh, its edges made springs."""
    clear()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=2.0)
    grid = bpy.context.object
    grid.name = "Net"
    for v in grid.data.vertices:
        v.select = max(abs(v.co.x), abs(v.co.y)) > 0.99
    bpy.ops.coilover.lattice(kind="spring", mass=2.0, radius=0.03, stiffness=900.0)
    for obj in bpy.context.selected_objects:
        obj.select_set(False)


def show(axis, distance, height):
    view = area("VIEW_3D").spaces[0]
    view.overlay.show_relationship_lines = False
    view.overlay.show_floor = axis != "FRONT"
    view.show_region_ui = False
    with within("VIEW_3D"):
        if axis == "FRONT":
            bpy.ops.view3d.view_axis(type="FRONT")
        else:
            view.region_3d.view_perspective = "PERSP"
            view.region_3d.view_rotation = Euler((1.0, 0.0, 0.6)).to_quaternion()
        view.region_3d.view_location = (0.0, 0.0, height)
        view.region_3d.view_distance = distance
    area("PROPERTIES").spaces[0].context = "PHYSICS"


def picture(name):
    bpy.ops.screen.screenshot(filepath=str(FOLDER / name))


STEPS = [
    lambda: (addon_utils.enable("bevy_coilover", default_set=True), widen()),
    lambda: divide(),
    lambda: (lamp(), show("FRONT", 3.0, 1.0)),
    lambda: picture("blender_panel.png"),
    lambda: (trampoline(), show("PERSP", 2.6, 0.0)),
    lambda: picture("blender_lattice.png"),
    bpy.ops.wm.quit_blender,
]


def widen():
    """Room for the properties: instead of the timeline below and the narrow column at the right."""
    window = bpy.context.window_manager.windows[0]
    for kind in ("DOPESHEET_EDITOR", "OUTLINER", "PROPERTIES"):
        with bpy.context.temp_override(window=window, area=area(kind)):
            bpy.ops.screen.area_close()
    with within("VIEW_3D"):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.64)


def divide():
    """Their sizes are known only when they have been drawn."""
    views = [a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == "VIEW_3D"]
    min(views, key=lambda a: a.width).type = "PROPERTIES"


def step():
    try:
        STEPS.pop(0)()
    except Exception as wrong:  # noqa: BLE001  (a timer would swallow it, and the window stay for ever)
        print("FAILED", repr(wrong))
        bpy.ops.wm.quit_blender()
    return 2.0 if STEPS else None


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(step, first_interval=2.0)
