"""Exudyn's spring-damper on the scenes that `compare --describe` writes; prints rows of peers.csv.

Usage: python exudyn_peer.py FOLDER
"""
import sys
import time
import warnings

import exudyn as exu
import numpy as np
from exudyn.itemInterface import SensorBody
from scenes import scenes

warnings.simplefilter("ignore")  # Names of settings that it will drop some day.
SOLVERS = {
    "generalized alpha": exu.DynamicSolverType.GeneralizedAlpha,
    "trapezoidal": exu.DynamicSolverType.TrapezoidalIndex2,
    "RK44": exu.DynamicSolverType.RK44,
}
RATES = [60, 240, 960]
# From so many bodies on a sparse matrix is cheaper than a full one.
MANY = 100


def follow(scene, solver, rate):
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    bodies = []
    for mass, x, y, z, *velocity in scene["bodies"]:
        if mass:
            bodies.append(mbs.CreateMassPoint(
                referencePosition=[x, y, z], initialVelocity=velocity, physicsMass=mass, gravity=scene["gravity"]))
        else:
            bodies.append(mbs.CreateGround(referencePosition=[x, y, z]))
    for a, b, stiffness, damping, rest in scene["links"]:
        mbs.CreateSpringDamper(
            bodyNumbers=[bodies[int(a)], bodies[int(b)]], referenceLength=rest, stiffness=stiffness, damping=damping)
    sensors = [
        mbs.AddSensor(SensorBody(
            bodyNumber=bodies[i], storeInternal=True, outputVariableType=exu.OutputVariableType.Position))
        for i in scene["watched"]]
    mbs.Assemble()
    steps = round(scene["seconds"][0] * rate)
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = steps / rate
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.automaticStepSize = False
    settings.solutionSettings.writeSolutionToFile = False
    if len(bodies) > MANY:
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
    settings.solutionSettings.sensorsWritePeriod = 1 / rate
    before = time.perf_counter()
    try:
        mbs.SolveDynamic(settings, solverType=solver, showHints=False)
    except Exception:  # Newton's iteration gave up, or numbers overflowed.
        return float("inf"), True, 1e6 * (time.perf_counter() - before) / steps
    spent = 1e6 * (time.perf_counter() - before) / steps
    places = [mbs.GetSensorStoredData(sensor) for sensor in sensors]
    worst = 0.0
    for row, truth in scene["truth"].items():
        step = row * rate / 240
        if row == 0 or step != round(step) or round(step) > steps:
            continue
        seen = np.array([table[np.argmin(abs(table[:, 0] - row / 240)), 1:4] for table in places])
        off = np.linalg.norm(seen - truth, axis=1).max()
        worst = off if not off <= worst else worst
    return worst, not worst <= 10 * scene["size"][0], spent


for stem, scene in scenes(sys.argv[1]):
    for name, solver in SOLVERS.items():
        for rate in RATES:
            error, diverged, spent = follow(scene, solver, rate)
            print(f"Exudyn {exu.__version__} spring-damper,{name},{stem},{rate},{error:.3e},{int(diverged)},{spent:.1f}", flush=True)
