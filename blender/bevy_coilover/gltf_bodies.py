# SPDX-License-Identifier: MIT OR Apache-2.0
"""Blender's rigid bodies as KHR_physics_rigid_bodies and KHR_implicit_shapes.

Blender's shapes are centred at the object's origin and as large as the bounding box of its mesh. Its engine has the
centre of mass there too, and multiplies friction and restitution of two bodies. All this is said so in the file.
"""

from . import ends, gltf_joints
from .axes import short
from .physics import extent

BODIES, SHAPES = "KHR_physics_rigid_bodies", "KHR_implicit_shapes"


def shape_of(obj, yup=True):
    """The implicit shape of a body in its node's frame; None where it takes its mesh."""
    size = extent(obj)
    radius, height = 0.5 * max(size[0], size[1]), size[2]
    kind = obj.rigid_body.collision_shape
    if kind == "BOX":
        x, y, z = (short(max(float(s), 1e-4)) for s in size)
        return {"type": "box", "box": {"size": [x, z, y] if yup else [x, y, z]}}
    if kind == "SPHERE":
        return {"type": "sphere", "sphere": {"radius": short(0.5 * float(size.max()))}}
    if not yup:
        # Those have an axis, which glTF lays along Y.
        return None
    if kind == "CAPSULE" and height > 2.0 * radius:
        ball = short(radius)
        return {"type": "capsule", "capsule": {
            "height": short(height - 2.0 * radius), "radiusBottom": ball, "radiusTop": ball}}
    if kind == "CAPSULE":
        return {"type": "sphere", "sphere": {"radius": short(radius)}}
    if kind in ("CYLINDER", "CONE"):
        top = 0.0 if kind == "CONE" else radius
        return {"type": "cylinder", "cylinder": {
            "height": short(height), "radiusBottom": short(radius), "radiusTop": short(top)}}
    return None


def motion_of(obj, scene):
    """How the simulation moves it; None for what stands still or is a shape of its parent's body."""
    rigid = obj.rigid_body
    if ends.body(obj) != obj:
        return None
    if rigid.kinematic and (rigid.type == "PASSIVE" or rigid.enabled):
        return {"isKinematic": True}
    if rigid.type == "PASSIVE" or not rigid.enabled:
        return None
    # Without a centre the reader takes that of the shapes, which is another one for a cone, a hull or a compound.
    motion = {"mass": short(rigid.mass), "centerOfMass": [0.0, 0.0, 0.0]}
    world = scene.rigidbody_world
    share = world.effector_weights.gravity if world is not None and world.effector_weights is not None else 1.0
    share = share if scene.use_gravity else 0.0
    if share != 1.0:
        motion["gravityFactor"] = short(share)
    return motion


def material_of(rigid):
    friction = short(rigid.friction)
    return {
        "staticFriction": friction,
        "dynamicFriction": friction,
        "restitution": short(rigid.restitution),
        "frictionCombine": "multiply",
        "restitutionCombine": "multiply",
    }


def layers(rigid):
    """The numbers of the layers that a body is in."""
    return tuple(i + 1 for i, member in enumerate(rigid.collision_collections) if member)


def system(numbers):
    """Name of all bodies that are in just these layers."""
    return "layers " + " ".join(map(str, numbers))


def filter_of(rigid, everyone):
    """In Blender two bodies touch that share a layer. In the file a body has to be named by the other as a whole, so
    each set of layers has a name of its own.
    """
    own = layers(rigid)
    touched = sorted(system(other) for other in everyone if set(own) & set(other))
    # An empty list would be left out of the file, and then it would touch everything.
    return {"collisionSystems": [system(own)], "collideWithSystems": touched or ["nothing"]}


def mesh_node(obj, node, gathered):
    """The number of a node that has the mesh of a body and none else."""
    if not node.children:
        return gathered.number[id(node)]
    # A reader takes the meshes of all nodes below it too, but in Blender a body has its own mesh alone. So that mesh
    # gets one more node, which is in no scene and is not drawn.
    return gathered.add(gltf_joints.new_node((obj.name, "Shape"), mesh=node.mesh))


def collider_of(obj, node, gathered, document, everyone, settings):
    rigid = obj.rigid_body
    if rigid.collision_shape == "COMPOUND":
        return None
    shape = shape_of(obj, settings.get("gltf_yup", True))
    if shape is not None:
        geometry = {"shape": document.shared(SHAPES, "shapes", shape)}
    elif node.mesh is None:
        return None
    else:
        geometry = {"node": mesh_node(obj, node, gathered), "convexHull": rigid.collision_shape != "MESH"}
    collider = {
        "geometry": geometry,
        "physicsMaterial": document.shared(BODIES, "physicsMaterials", material_of(rigid)),
    }
    if everyone != {(1,)}:
        collider["collisionFilter"] = document.shared(BODIES, "collisionFilters", filter_of(rigid, everyone))
    return collider


def write(gathered, document, settings):
    """Bodies and joints into the nodes, unless another exporter has done so."""
    import bpy

    from .gltf_write import warn

    if any(BODIES in (node.extensions or {}) for node in gathered.nodes):
        return
    bodies = [(n, o) for n, o in gathered.pairs if o.rigid_body is not None]
    everyone = {layers(o.rigid_body) for _, o in bodies}
    for node, obj in bodies:
        said = {}
        motion = motion_of(obj, bpy.context.scene)
        if motion is not None:
            said["motion"] = motion
        collider = collider_of(obj, node, gathered, document, everyone, settings)
        if collider is not None:
            said["collider"] = collider
        elif obj.rigid_body.collision_shape != "COMPOUND":
            warn(settings, f"{obj.name}: its shape {obj.rigid_body.collision_shape} needs its mesh in the file")
        parent = ends.body(obj.parent) if obj.parent is not None else None
        if motion is None and ends.body(obj) == obj and ends.moves(parent):
            warn(settings, f"{obj.name}: passive, but below the active {parent.name}; in the file it is part of it")
        if said:
            document.put(node, BODIES, said)
    gltf_joints.write(gathered, document, settings)
