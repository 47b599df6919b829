"""Newton's springs between particles on the scenes that `compare --describe` writes; prints rows of peers.csv.

Usage: python newton_peer.py FOLDER

On the processor, a call per step. Newton calls a particle without mass fixed.
"""
import sys
import time
from importlib.metadata import version

import newton
import numpy as np
import warp as wp
from scenes import scenes

wp.config.quiet = True
SOLVERS = {
    "VBD, 10 iterations": lambda m: newton.solvers.SolverVBD(m, iterations=10),
    "VBD, 40 iterations": lambda m: newton.solvers.SolverVBD(m, iterations=40),
    "XPBD, 10 iterations": lambda m: newton.solvers.SolverXPBD(m, iterations=10, soft_body_relaxation=1.0),
    "semi-implicit": lambda m: newton.solvers.SolverSemiImplicit(m, angular_damping=0.0),
}
RATES = [60, 240]


def model_of(scene):
    builder = newton.ModelBuilder(gravity=tuple(scene["gravity"]))
    for mass, x, y, z, *velocity in scene["bodies"]:
        builder.add_particle(wp.vec3(x, y, z), wp.vec3(*(velocity[:3] if mass else (0.0, 0.0, 0.0))), mass, radius=1e-4)
    for a, b, stiffness, damping, _ in scene["links"]:
        builder.add_spring(int(a), int(b), stiffness, damping, 0.0)
    builder.color()
    model = builder.finalize(device="cpu")
    model.particle_max_velocity = 1e4
    model.spring_rest_length.assign(np.array([link[4] for link in scene["links"]], dtype=np.float32))
    return model


def follow(scene, solver, rate):
    model = model_of(scene)
    solver = SOLVERS[solver](model)
    now, then, control = model.state(), model.state(), model.control()
    worst, spent, steps = 0.0, [], round(scene["seconds"][0] * rate)
    for step in range(1, steps + 1):
        before = time.perf_counter()
        now.clear_forces()
        solver.step(now, then, control, None, 1 / rate)
        now, then = then, now
        spent.append(time.perf_counter() - before)
        row = step * 240 / rate
        if row == round(row) and round(row) in scene["truth"]:
            places = now.particle_q.numpy()[scene["watched"]]
            off = np.linalg.norm(places - scene["truth"][round(row)], axis=1).max()
            worst = off if not off <= worst else worst
            if not worst <= 10 * scene["size"][0]:
                return worst, True, np.median(spent)
    return worst, False, np.median(spent)


for stem, scene in scenes(sys.argv[1]):
    for solver in SOLVERS:
        for rate in RATES:
            error, diverged, step = follow(scene, solver, rate)
            # No comma within a cell.
            setting = solver.replace(",", "")
            print(f"Newton {version('newton')} springs,{setting},{stem},{rate},{error:.3e},{int(diverged)},{1e6 * step:.1f}", flush=True)
