"""Box3D's distance joint on the scenes that `compare --describe` writes; prints rows of peers.csv.

Usage: python box3d_peer.py FOLDER

Its spring is stated as a frequency and a damping ratio of the mass that it moves, so both are worked out from stiffness,
damping and the two point masses.
"""
import math
import sys
import time
from importlib.metadata import version

import numpy as np
from robox3d._ffi import ffi, lib
from scenes import scenes

SUBSTEPS = [4, 16]
RATES = [60, 240, 960]


def world_of(scene):
    definition = lib.b3DefaultWorldDef()
    definition.gravity = ffi.new("b3Vec3 *", scene["gravity"])[0]
    definition.enableSleep = False
    return lib.b3CreateWorld(ffi.new("b3WorldDef *", definition))


def add_bodies(scene, world):
    """Point masses that do not turn."""
    bodies = []
    for mass, x, y, z, *velocity in scene["bodies"]:
        definition = ffi.new("b3BodyDef *", lib.b3DefaultBodyDef())
        definition.type = lib.b3_dynamicBody if mass else lib.b3_staticBody
        definition.position = ffi.new("b3Pos *", [x, y, z])[0]
        definition.enableSleep = False
        locks = definition.motionLocks
        locks.angularX = locks.angularY = locks.angularZ = True
        if mass:
            definition.linearVelocity = ffi.new("b3Vec3 *", velocity[:3])[0]
        body = lib.b3CreateBody(world, definition)
        if mass:
            data = ffi.new("b3MassData *")
            data.mass = mass
            data.inertia.cx.x = data.inertia.cy.y = data.inertia.cz.z = mass
            lib.b3Body_SetMassData(body, data[0])
        bodies.append(body)
    return bodies


def add_springs(scene, world, bodies):
    for a, b, stiffness, damping, rest in scene["links"]:
        a, b = int(a), int(b)
        inverse_mass = sum(1 / scene["bodies"][i][0] for i in (a, b) if scene["bodies"][i][0])
        omega = math.sqrt(stiffness * inverse_mass)
        definition = ffi.new("b3DistanceJointDef *", lib.b3DefaultDistanceJointDef())
        definition.base.bodyIdA, definition.base.bodyIdB = bodies[a], bodies[b]
        definition.length = rest
        definition.enableSpring = True
        definition.hertz = omega / (2 * math.pi)
        definition.dampingRatio = damping * inverse_mass / (2 * omega)
        lib.b3CreateDistanceJoint(world, definition)


def follow(scene, substeps, rate):
    world = world_of(scene)
    bodies = add_bodies(scene, world)
    add_springs(scene, world, bodies)
    worst, spent, steps = 0.0, [], round(scene["seconds"][0] * rate)
    diverged = False
    for step in range(1, steps + 1):
        before = time.perf_counter()
        lib.b3World_Step(world, 1 / rate, substeps)
        spent.append(time.perf_counter() - before)
        row = step * 240 / rate
        if row == round(row) and round(row) in scene["truth"]:
            places = [lib.b3Body_GetPosition(bodies[i]) for i in scene["watched"]]
            places = np.array([[p.x, p.y, p.z] for p in places])
            off = np.linalg.norm(places - scene["truth"][round(row)], axis=1).max()
            worst = off if not off <= worst else worst
            if not worst <= 10 * scene["size"][0]:
                diverged = True
                break
    lib.b3DestroyWorld(world)
    return worst, diverged, np.median(spent)


for stem, scene in scenes(sys.argv[1]):
    for substeps in SUBSTEPS:
        for rate in RATES:
            error, diverged, step = follow(scene, substeps, rate)
            name = f"Box3D (robox3d {version('robox3d')}) distance"
            print(f"{name},{substeps} substeps,{stem},{rate},{error:.3e},{int(diverged)},{1e6 * step:.1f}", flush=True)
