"""MuJoCo's spatial tendon on the scenes that `compare --describe` writes; prints rows of peers.csv.

Usage: python mujoco_peer.py FOLDER
"""
import sys
import time

import mujoco
import numpy as np
from scenes import scenes

INTEGRATORS = ["Euler", "implicitfast", "RK4", "discrete"]
RATES = [60, 240, 960]


def model(scene, integrator, rate):
    """Point masses on three slides each, so that nothing turns, and a tendon per spring."""
    bodies, tendons = "", ""
    for i, (mass, x, y, z, *_) in enumerate(scene["bodies"]):
        slides = "".join(f'<joint name="{a}{i}" type="slide" axis="{v}"/>' for a, v in zip("xyz", ["1 0 0", "0 1 0", "0 0 1"]))
        inner = f'{slides}<inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/>' if mass else ""
        bodies += f'<body name="b{i}" pos="{x} {y} {z}">{inner}<site name="s{i}"/></body>'
    for a, b, k, c, rest in scene["links"]:
        tendons += f'<spatial stiffness="{k}" damping="{c}" springlength="{rest}"><site site="s{int(a)}"/><site site="s{int(b)}"/></spatial>'
    gravity = " ".join(map(str, scene["gravity"]))
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{1 / rate!r}" gravity="{gravity}" integrator="{integrator}"/>'
        f"<worldbody>{bodies}</worldbody><tendon>{tendons}</tendon></mujoco>")


def follow(scene, integrator, rate):
    m = model(scene, integrator, rate)
    d = mujoco.MjData(m)
    for i, (mass, *rest) in enumerate(scene["bodies"]):
        if mass:
            start = m.joint(f"x{i}").dofadr[0]
            d.qvel[start:start + 3] = rest[3:6]
    ids = [m.body(f"b{i}").id for i in scene["watched"]]
    worst, spent, steps = 0.0, [], round(scene["seconds"][0] * rate)
    for step in range(1, steps + 1):
        before = time.perf_counter()
        mujoco.mj_step(m, d)
        spent.append(time.perf_counter() - before)
        row = step * 240 / rate
        if row == round(row) and round(row) in scene["truth"]:
            # Places are those of the step before until they are asked for.
            mujoco.mj_kinematics(m, d)
            off = np.linalg.norm(d.xpos[ids] - scene["truth"][round(row)], axis=1).max()
            worst = off if not off <= worst else worst
            if not worst <= 10 * scene["size"][0]:
                return worst, True, np.median(spent)
    return worst, False, np.median(spent)


for stem, scene in scenes(sys.argv[1]):
    for integrator in INTEGRATORS:
        for rate in RATES:
            error, diverged, step = follow(scene, integrator, rate)
            print(f"MuJoCo {mujoco.__version__} tendon,{integrator},{stem},{rate},{error:.3e},{int(diverged)},{1e6 * step:.1f}", flush=True)
