# SPDX-License-Identifier: MIT OR Apache-2.0
"""Blender's rigid bodies and constraints, as KHR_physics_rigid_bodies."""

import json
import math

import bpy
import pytest
from test_file import again, global_matrix
from mathutils import Matrix, Quaternion, Vector

BODIES, SHAPES = "KHR_physics_rigid_bodies", "KHR_implicit_shapes"


def shape(glb, name):
    index = glb.said(name, BODIES)["collider"]["geometry"]["shape"]
    return glb.json["extensions"][SHAPES]["shapes"][index]


@pytest.mark.parametrize("kind, size, wanted", [
    ("BOX", (1.0, 2.0, 3.0), {"type": "box", "box": {"size": [1, 3, 2]}}),
    ("SPHERE", (1.0, 2.0, 3.0), {"type": "sphere", "sphere": {"radius": 1.5}}),
    ("CYLINDER", (1.0, 0.5, 3.0), {"type": "cylinder", "cylinder": {"height": 3, "radiusBottom": 0.5, "radiusTop": 0.5}}),
    ("CONE", (1.0, 0.5, 3.0), {"type": "cylinder", "cylinder": {"height": 3, "radiusBottom": 0.5, "radiusTop": 0}}),
    ("CAPSULE", (1.0, 0.5, 3.0), {"type": "capsule", "capsule": {"height": 2, "radiusBottom": 0.5, "radiusTop": 0.5}}),
    ("CAPSULE", (1.0, 0.5, 0.5), {"type": "sphere", "sphere": {"radius": 0.5}}),
])
def test_shapes_have_the_size_of_the_mesh_with_y_up(scene, kind, size, wanted):
    scene.body("Body", (0, 0, 0), size=size, shape=kind)
    glb = scene.export()
    assert shape(glb, "Body") == wanted
    assert {BODIES, SHAPES} <= set(glb.json["extensionsUsed"])


@pytest.mark.parametrize("kind, hull", [("CONVEX_HULL", True), ("MESH", False)])
def test_hulls_and_meshes_collide_as_their_own_node(scene, kind, hull):
    scene.body("Body", (0, 0, 0), shape=kind)
    glb = scene.export()
    geometry = glb.said("Body", BODIES)["collider"]["geometry"]
    assert glb.name(geometry["node"]) == "Body" and geometry["convexHull"] is hull


@pytest.mark.parametrize("kind", ["CONVEX_HULL", "MESH"])
def test_a_chassis_with_a_child_collides_as_its_own_mesh_alone(scene, kind):
    """A reader takes the meshes of all nodes below the one that a collider names."""
    chassis = scene.body("Chassis", (0, 0, 1), shape=kind)
    bpy.ops.mesh.primitive_cone_add(location=(0, 0, 3))
    bpy.context.object.name, bpy.context.object.parent = "Mast", chassis
    first = scene.export("first.glb")
    number = first.said("Chassis", BODIES)["collider"]["geometry"]["node"]
    assert first.json["nodes"][number]["mesh"] == first.node("Chassis")["mesh"]
    assert not {"children", "translation", "rotation", "scale"} & set(first.json["nodes"][number])
    drawn = [n for s in first.json["scenes"] + first.json["nodes"] for n in s.get("nodes", s.get("children", []))]
    assert number not in drawn

    again(scene, "first.glb")
    assert {obj.name for obj in bpy.data.objects} == {"Chassis", "Mast"}
    assert bpy.data.objects["Chassis"].rigid_body.collision_shape == kind
    second = scene.export("second.glb")
    assert [n["name"] for n in second.json["nodes"]] == [n["name"] for n in first.json["nodes"]]
    assert second.said("Chassis", BODIES) == first.said("Chassis", BODIES)


def test_a_chassis_with_a_child_and_a_joint_comes_back_with_both(scene):
    chassis, ground = scene.body("Chassis", (0, 0, 1), shape="CONVEX_HULL"), scene.body("Ground", (0, 0, 0), active=False)
    scene.empty("Eye", (0, 0, 1), parent=chassis)
    joint(scene, "Hinge", "HINGE", ground, chassis)
    scene.export("first.glb")
    again(scene, "first.glb")
    assert {obj.name for obj in bpy.data.objects} == {"Chassis", "Ground", "Eye", "Hinge"}
    rigid = bpy.data.objects["Hinge"].rigid_body_constraint
    assert (rigid.type, rigid.object1.name, rigid.object2.name) == ("HINGE", "Ground", "Chassis")


@pytest.mark.parametrize("pin, turns", [(0.0, False), (0.5, True)])
def test_the_centre_of_mass_is_at_the_origin_as_in_blenders_own_simulation(scene, pin, turns):
    """A hull about a point beside its origin hangs still by the origin, and turns where it hangs by that point."""
    bar = scene.body("Bar", (0, 0, 0), shape="CONVEX_HULL")
    for vertex in bar.data.vertices:
        vertex.co.x += 0.5
    bar.data.update()
    joint(scene, "Joint", "POINT", scene.body("Frame", (0, 3, 0), active=False), bar, (pin, 0, 0))
    assert scene.export().said("Bar", BODIES)["motion"]["centerOfMass"] == [0, 0, 0]
    for number in range(1, 20):
        bpy.context.scene.frame_set(number)
    matrix = bar.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world
    along = matrix.to_3x3() @ Vector((1, 0, 0))
    assert (along.x < 0.9) is turns and (along.x > 0.999) is not turns


def test_what_moves_and_what_stands_is_as_in_blender(scene):
    load = scene.body("Load", (0, 0, 0), mass=7.5)
    scene.body("Ground", (0, 0, -1), active=False)
    lift, asleep = scene.body("Lift", (1, 0, 0), active=False), scene.body("Off", (2, 0, 0))
    lift.rigid_body.kinematic = True
    asleep.rigid_body.enabled = False
    load.rigid_body.friction, load.rigid_body.restitution = 0.8, 0.25
    glb = scene.export()
    assert glb.said("Load", BODIES)["motion"] == {"mass": 7.5, "centerOfMass": [0, 0, 0]}
    assert "motion" not in glb.said("Ground", BODIES) and "motion" not in glb.said("Off", BODIES)
    assert glb.said("Lift", BODIES)["motion"] == {"isKinematic": True}
    material = glb.json["extensions"][BODIES]["physicsMaterials"][glb.said("Load", BODIES)["collider"]["physicsMaterial"]]
    assert material == {"staticFriction": 0.8, "dynamicFriction": 0.8, "restitution": 0.25,
                        "frictionCombine": "multiply", "restitutionCombine": "multiply"}


def test_without_gravity_bodies_float(scene):
    scene.body("Load", (0, 0, 0))
    bpy.context.scene.use_gravity = False
    assert scene.export().said("Load", BODIES)["motion"]["gravityFactor"] == 0


def test_a_compound_body_is_one_body_of_several_colliders(scene):
    frame = scene.body("Frame", (0, 0, 1), mass=3.0, shape="COMPOUND")
    scene.body("Left", (-1, 0, 0), parent=frame)
    scene.body("Right", (1, 0, 0), parent=frame, active=False)
    glb = scene.export()
    assert glb.said("Frame", BODIES) == {"motion": {"mass": 3, "centerOfMass": [0, 0, 0]}}
    assert set(glb.said("Left", BODIES)) == set(glb.said("Right", BODIES)) == {"collider"}


def test_equal_shapes_and_materials_are_written_once(scene):
    for i in range(5):
        scene.body(f"Body {i}", (i, 0, 0))
    root = scene.export().json["extensions"]
    assert len(root[SHAPES]["shapes"]) == len(root[BODIES]["physicsMaterials"]) == 1
    assert "collisionFilters" not in root[BODIES]


def test_collision_layers_become_filters(scene):
    members = {"One": {0}, "Two": {1, 2}, "Both": {0, 1}, "None": set(), "Three": {2}}
    for x, (name, layers) in enumerate(members.items()):
        body = scene.body(name, (x, 0, 0))
        body.rigid_body.collision_collections = [i in layers for i in range(20)]
    glb = scene.export("first.glb")
    filters = glb.json["extensions"][BODIES]["collisionFilters"]
    of = lambda name: filters[glb.said(name, BODIES)["collider"]["collisionFilter"]]

    def touches(a, b):
        """As the specification has it: all of a's systems are among those that b collides with."""
        return set(of(a)["collisionSystems"]) <= set(of(b)["collideWithSystems"])

    for a in members:
        for b in members:
            assert (touches(a, b) and touches(b, a)) == bool(members[a] & members[b]), (a, b)
    again(scene, "first.glb")
    for name, layers in members.items():
        assert {i for i in range(20) if bpy.data.objects[name].rigid_body.collision_collections[i]} == layers


def test_bodies_can_be_left_to_another_exporter(scene):
    scene.body("Load", (0, 0, 0))
    bpy.context.scene.coilover.bodies = "NEVER"
    assert BODIES not in scene.export().json.get("extensionsUsed", [])


def test_bodies_that_another_exporter_has_written_are_kept(scene):
    import sys
    import types

    class Other:
        def gather_node_hook(self, node, obj, settings):
            if obj.name == "Load":
                node.extensions[BODIES] = {"motion": {"mass": 99.0}}

    module = types.ModuleType("other_exporter")
    module.glTF2ExportUserExtension = Other
    sys.modules["other_exporter"] = module
    bpy.context.preferences.addons.new().module = "other_exporter"
    try:
        scene.body("Load", (0, 0, 0))
        scene.body("Rest", (1, 0, 0))
        glb = scene.export()
    finally:
        bpy.context.preferences.addons.remove(bpy.context.preferences.addons["other_exporter"])
        del sys.modules["other_exporter"]
    assert glb.said("Load", BODIES) == {"motion": {"mass": 99}}
    assert glb.said("Rest", BODIES) is None


def joint(scene, name, kind, a, b, place=(0, 0, 0), turn=(0, 0, 0)):
    obj = scene.empty(name, place)
    obj.rotation_euler = turn
    scene.select(obj)
    bpy.ops.rigidbody.constraint_add()
    rigid = obj.rigid_body_constraint
    rigid.type, rigid.object1, rigid.object2 = kind, a, b
    bpy.context.view_layer.update()
    return rigid


def described(glb):
    return glb.json["extensions"][BODIES]["physicsJoints"]


def test_a_hinge_turns_about_the_axis_that_it_has_in_blender(scene):
    frame, door = scene.body("Frame", (0, 0, 0), active=False), scene.body("Door", (0.5, 0, 0))
    door.rotation_euler, door.scale = (0.1, 0.2, 0.3), (2, 2, 2)
    rigid = joint(scene, "Hinge", "HINGE", frame, door, (0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    rigid.use_limit_ang_z, rigid.limit_ang_z_lower, rigid.limit_ang_z_upper = True, -0.5, 1.0
    axis = to_gltf(bpy.data.objects["Hinge"].matrix_world.to_3x3() @ Vector((0, 0, 1)))
    glb = scene.export()
    assert described(glb) == [{"limits": [
        {"linearAxes": [0, 1, 2], "min": 0, "max": 0},
        {"angularAxes": [0, 2], "min": 0, "max": 0},
        {"angularAxes": [1], "min": -1, "max": 0.5},
    ]}]
    said = glb.said("Hinge Joint A", BODIES)["joint"]
    assert glb.name(said["connectedNode"]) == "Hinge Joint B"
    for name in ("Hinge Joint A", "Hinge Joint B"):
        matrix = global_matrix(glb, [n["name"] for n in glb.json["nodes"]].index(name))
        assert tuple(matrix.translation) == pytest.approx(to_gltf((0.1, 0.2, 0.3)), abs=1e-5)
        free = matrix.to_quaternion() @ Vector((0, 1, 0))
        assert tuple(free) == pytest.approx(tuple(axis), abs=1e-5)


def to_gltf(v):
    return (v[0], v[2], -v[1])


def read_turn(glb, name):
    """How a reader of the file turns a node, in glTF's axes: the rotations of the nodes above it, with the signs of their
    scales but not their sizes. A mirrored one has its X axis reversed, as Bevy takes such a matrix apart."""
    parents = {c: i for i, n in enumerate(glb.json["nodes"]) for c in n.get("children", [])}
    turn, index = Matrix.Identity(3), [n["name"] for n in glb.json["nodes"]].index(name)
    while index is not None:
        node = glb.json["nodes"][index]
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        signs = Matrix.Diagonal([math.copysign(1.0, s) for s in node.get("scale", (1, 1, 1))])
        turn, index = Quaternion((w, x, y, z)).to_matrix() @ signs @ turn, parents.get(index)
    return turn @ Matrix.Diagonal((-1, 1, 1)) if turn.determinant() < 0.0 else turn


@pytest.mark.parametrize("scale", [(1.0, 3.0, 0.5), (-2.0, 2.0, 2.0), (1.0, -3.0, 0.5)])
def test_the_frame_of_a_joint_is_turned_as_in_blender_on_uneven_and_mirrored_bodies(scene, scale):
    arm = scene.empty("Arm", (1, 2, 3))
    arm.rotation_euler, arm.scale = (0.3, 0.1, -0.7), (2.0, 2.0, 2.0)
    frame, door = scene.body("Frame", (0, 0, 0), active=False), scene.body("Door", (0.5, 0, 0), parent=arm)
    door.rotation_euler, door.scale = (0.1, 0.2, 0.3), scale
    bpy.context.view_layer.update()
    joint(scene, "Hinge", "HINGE", frame, door, (0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    own = bpy.data.objects["Hinge"].matrix_world.to_3x3()
    glb = scene.export()
    for name in ("Hinge Joint A", "Hinge Joint B"):
        turn = read_turn(glb, name)
        for axis in (Vector((1, 0, 0)), Vector((0, 1, 0)), Vector((0, 0, 1))):
            wanted = to_gltf(own @ axis)
            assert tuple(turn @ Vector(to_gltf(axis))) == pytest.approx(wanted, abs=1e-5), (name, axis)
        place = global_matrix(glb, [n["name"] for n in glb.json["nodes"]].index(name)).translation
        assert tuple(place) == pytest.approx(to_gltf((0.1, 0.2, 0.3)), abs=1e-5)


def test_each_constraint_takes_what_it_takes_in_blender(scene):
    a, b = scene.body("A", (0, 0, 0), active=False), scene.body("B", (1, 0, 0))
    place, still = {"linearAxes": [0, 1, 2], "min": 0, "max": 0}, {"angularAxes": [0, 1, 2], "min": 0, "max": 0}
    line = {"linearAxes": [1, 2], "min": 0, "max": 0}
    for kind, limits in (("FIXED", [place, still]), ("POINT", [place]), ("SLIDER", [line, still]),
                         ("PISTON", [line, {"angularAxes": [1, 2], "min": 0, "max": 0}])):
        rigid = joint(scene, kind, kind, a, b)
        assert described(scene.export()) == [{"limits": limits}], kind
        bpy.data.objects.remove(bpy.data.objects[kind])
    del rigid


def test_a_range_along_blenders_y_changes_its_sign_with_the_axis(scene):
    a, b = scene.body("A", (0, 0, 0), active=False), scene.body("B", (1, 0, 0))
    rigid = joint(scene, "J", "GENERIC_SPRING", a, b)
    rigid.use_limit_lin_y, rigid.limit_lin_y_lower, rigid.limit_lin_y_upper = True, -0.2, 0.5
    rigid.use_spring_z, rigid.spring_stiffness_z, rigid.spring_damping_z = True, 300.0, 4.0
    (said,) = described(scene.export())
    assert said["limits"] == [{"linearAxes": [2], "min": -0.5, "max": 0.2}]
    assert said["drives"] == [{"type": "linear", "mode": "force", "axis": 1, "positionTarget": 0, "velocityTarget": 0,
                               "stiffness": 300, "damping": 4}]


def test_a_motor_is_left_out_with_a_warning(scene, capfd):
    a, b = scene.body("A", (0, 0, 0), active=False), scene.body("B", (1, 0, 0))
    joint(scene, "M", "MOTOR", a, b)
    assert "physicsJoints" not in scene.export().json["extensions"][BODIES]
    assert "M: a constraint of type MOTOR cannot be written" in "".join(capfd.readouterr())


def test_bodies_and_joints_come_back_and_go_out_the_same(scene):
    a = scene.body("A", (0, 0, 0), active=False, shape="MESH")
    b = scene.body("B", (1, 0, 0), mass=2.5, shape="CYLINDER", size=(0.3, 0.3, 0.7))
    frame = scene.body("Frame", (0, 0, 3), mass=3.0, shape="COMPOUND")
    scene.body("Part", (0.5, 0, 0), parent=frame, shape="SPHERE")
    b.rigid_body.friction = 0.9
    hinge = joint(scene, "Hinge", "HINGE", a, b, (0.5, 0, 0), (0.1, 0.2, 0.3))
    hinge.use_limit_ang_z, hinge.limit_ang_z_lower, hinge.limit_ang_z_upper = True, -0.25, math.pi / 4
    hinge.disable_collisions = False
    joint(scene, "Arm", "GENERIC_SPRING", b, frame).use_spring_ang_y = True
    first = scene.export("first.glb")
    again(scene, "first.glb")
    second = scene.export("second.glb")
    by_name = lambda glb: {n["name"]: n.get("extensions") for n in glb.json["nodes"]}
    assert set(by_name(first)) == set(by_name(second))
    assert first.json["extensions"] == second.json["extensions"]
    for name in ("A", "B", "Frame", "Part"):
        one, other = first.said(name, BODIES), second.said(name, BODIES)
        for said in (one, other):
            said.get("collider", {}).get("geometry", {}).pop("node", None)
        assert one == other, name
    for name in ("Hinge", "Arm"):
        one, other = (g.said(name + " Joint A", BODIES)["joint"] for g in (first, second))
        assert one["joint"] == other["joint"] and one.get("enableCollision") == other.get("enableCollision")


@pytest.mark.parametrize("kind, part, name", [
    ("HINGE", "ang", "z"), ("SLIDER", "lin", "x"), ("PISTON", "lin", "x"), ("PISTON", "ang", "x"),
    *(("GENERIC", part, name) for part in ("lin", "ang") for name in "xyz"),
    *(("GENERIC_SPRING", part, name) for part in ("lin", "ang") for name in "xyz"),
])
def test_limits_in_the_file_are_where_blenders_own_simulation_stops(scene, kind, part, name):
    """A body falls along an axis, or about it by the right hand, until its limit; the file's limit is the same number."""
    frame = scene.body("Frame", (0, 0, 0), active=False, size=(0.05, 0.05, 0.05))
    axis = Vector([float(n == name) for n in "xyz"])
    turn = axis.rotation_difference(Vector((0, 0, -1) if part == "lin" else (0, 1, 0)))
    size, place = ((0.2, 0.2, 0.2), (0, 0, 0)) if part == "lin" else ((0.8, 0.05, 0.05), (0.5, 0, 0))
    bar = scene.body("Bar", place, size=size)
    rigid = joint(scene, "Joint", kind, frame, bar, (0, 0, 0), turn.to_euler())
    if kind.startswith("GENERIC"):
        for every in (p + "_" + n for p in ("lin", "ang") for n in "xyz"):
            setattr(rigid, "use_limit_" + every, True)
            setattr(rigid, f"limit_{every}_lower", 0.0)
            setattr(rigid, f"limit_{every}_upper", 0.0)
    setattr(rigid, f"use_limit_{part}_{name}", True)
    setattr(rigid, f"limit_{part}_{name}_lower", -0.1)
    setattr(rigid, f"limit_{part}_{name}_upper", 0.3)
    (said,) = described(scene.export())
    for frame_number in range(1, 100):
        bpy.context.scene.frame_set(frame_number)
    matrix = bar.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world
    along = matrix.to_3x3() @ Vector((1, 0, 0))
    found = -matrix.translation.z if part == "lin" else math.atan2(-along.z, along.x)

    # The direction of the fall in the axes of the file.
    number, sign = {"x": (0, 1.0), "y": (2, -1.0), "z": (1, 1.0)}[name]
    key = {"lin": "linearAxes", "ang": "angularAxes"}[part]
    (limit,) = [x for x in said["limits"] if x.get(key) == [number] and x["max"] != x["min"]]
    assert found == pytest.approx(limit["max"] if sign > 0 else -limit["min"], abs=0.02)


def test_a_body_without_a_mesh_is_told_of_and_its_spring_is_read_all_the_same(scene, capfd):
    """As Bevy's export writes them."""
    document = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["BEVY_coilover", BODIES],
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2, 3]}],
        "nodes": [
            {"name": "Hook", "translation": [0, 2, 0]},
            {"name": "Lamp", "extensions": {BODIES: {"motion": {"mass": 2}}}},
            {"name": "Spring", "extensions": {"BEVY_coilover": {"springDamper": {"a": 0, "b": 1, "stiffness": 120}}}},
            {"name": "Hinge", "extensions": {BODIES: {"joint": {"connectedNode": 1, "joint": 0}}}},
        ],
        "extensions": {BODIES: {"physicsJoints": [{}]}},
    }
    (scene.folder / "lamp.gltf").write_text(json.dumps(document))
    again(scene, "lamp.gltf")
    element = bpy.data.objects["Spring"].coilover
    assert (element.a.name, element.b.name, element.stiffness, element.damping) == ("Hook", "Lamp", 120.0, 1.0)
    told = "".join(capfd.readouterr())
    assert "Lamp: this body has no mesh" in told
    assert "Hinge: this joint was not written by this add-on" in told
