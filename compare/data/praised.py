"""Writes spring-ratio.csv, heavy-rope.csv, cloth.csv, cloth-100.csv, bridge-1000.csv and tower.csv with SciPy: points joined by linear spring-dampers.

Run: python3 -m venv venv && venv/bin/pip install numpy scipy && venv/bin/python praised.py [--check] [SCENE ...]
One row every 1/240 s, SI units. The scenes are those of ../src/scenes/praised.rs and large.rs. `--check` writes nothing, and tells how far
places at the end move if the solver's tolerance is a hundred times as large, and if the start is off by 1e-7 m.
"""
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse import coo_matrix

HZ = 240


def net(at, mass, links, gravity, seconds, method, rtol=1e-11, off=0.0, moving=None):
    """`mass` 0 is fixed; `links` are rows of end, end, stiffness, damping, rest length. Returns places every 1/240 s."""
    at = np.array(at, dtype=np.float32).astype(float)
    mass = np.array(mass, float)
    links = np.array(links, float)
    a, b = links[:, 0].astype(int), links[:, 1].astype(int)
    k, c, rest = (links[:, [i]] for i in (2, 3, 4))
    inverse = np.where(mass > 0, 1 / np.where(mass > 0, mass, 1), 0)[:, None]
    count = len(at)
    # Sums of what the links pull, as a sparse matrix.
    ends = coo_matrix((np.r_[np.ones(len(a)), -np.ones(len(b))], (np.r_[a, b], np.r_[np.arange(len(a)), np.arange(len(a))])), shape=(count, len(a))).tocsr()
    fall = np.where(inverse > 0, 1.0, 0.0) * np.array(gravity)

    def flow(_, state):
        x, v = state.reshape(2, -1, 3)
        d, w = x[b] - x[a], v[b] - v[a]
        length = np.linalg.norm(d, axis=1, keepdims=True)
        u = d / length
        pull = (k * (length - rest) + c * np.sum(w * u, axis=1, keepdims=True)) * u
        return np.r_[v.ravel(), (inverse * (ends @ pull) + fall).ravel()]

    start = at + off * np.sin(np.arange(3 * count).reshape(-1, 3)) * np.where(inverse > 0, 1, 0)
    times = np.arange(round(seconds * HZ) + 1) / HZ
    solved = solve_ivp(flow, (0, times[-1]), np.r_[start.ravel(), (np.zeros((count, 3)) if moving is None else moving).ravel()], t_eval=times, rtol=rtol, atol=rtol, method=method)
    return times, solved.y[: 3 * count].T.reshape(-1, count, 3)


def spring_ratio(**how):
    """Eight points in a row, their springs stretched by far and a thousand times as stiff every other time."""
    at = [[4.0 * i, 10, 0] for i in range(8)]
    mass = [0.0] + [0.5] * 6 + [0.0]
    links = [[i - 1, i, *((1e3, 30.0) if i % 2 == 0 else (1e6, 1000.0)), 1.1] for i in range(1, 8)]
    return [2, 3, 4], *net(at, mass, links, [0, -10, 0], 3, "Radau", **how)


def heavy_rope(**how):
    """Nineteen links with 900 kg at their end, 1800 times what a link weighs, let go level."""
    at = [[1.0 * i, 0, 0] for i in range(20)]
    mass = [0.0] + [0.5] * 18 + [900.0]
    links = [[i - 1, i, 1e6, 500.0, 1.0] for i in range(1, 20)]
    return [19], *net(at, mass, links, [0, -9.81, 0], 3, "Radau", **how)


def cloth(side=32, seconds=0.5, **how):
    """A cloth that hangs from two corners, let go as a slanted sheet; half a second, for then it folds, and folds are chaotic."""
    at = [[0.05 * (p % side), -0.05 * (p // side) * 0.8, 0.05 * (p // side) * 0.6] for p in range(side * side)]
    at = np.array(at, dtype=np.float32).astype(float)
    mass = np.full(side * side, 0.01)
    mass[[0, side - 1]] = 0
    links = []
    for row in range(side):
        for column in range(side):
            place = row * side + column
            for right, down in ((1, 0), (0, 1), (1, 1), (-1, 1)):
                if 0 <= column + right < side and row + down < side:
                    other = place + down * side + right
                    links.append([place, other, 400.0, 0.5, float(np.float32(np.linalg.norm(at[other] - at[place])))])
    middle = side * side // 2 + side // 2
    return [middle, side * (side - 1), side * side - 1], *net(at, mass, links, [0, -9.81, 0], seconds, "DOP853", **how)


def distance(at, a, b):
    return float(np.float32(np.linalg.norm(at[b] - at[a])))


def bridge(**how):
    """A thousand planks along a parabola, and a load on the middle, let go without tension."""
    at = [[0.2 * i, -(0.2 * i) * (200 - 0.2 * i) * 1e-3, 0] for i in range(1001)]
    at = np.array(at, dtype=np.float32).astype(float)
    mass = np.full(1001, 2.0)
    mass[500] = 502
    mass[[0, 1000]] = 0
    links = [[i - 1, i, 1e7, 2e3, distance(at, i - 1, i)] for i in range(1, 1001)]
    return [250, 500, 501], *net(at, mass, links, [0, -9.81, 0], 2, "DOP853", **how)


def tower(storeys=24, **how):
    """Four columns with beams and diagonals, heavy at the top, struck there."""
    at = np.array([[x, s, z] for s in range(storeys + 1) for x, z in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    mass = np.full(len(at), 5.0)
    mass[:4], mass[-4:] = 0, 105
    moving = np.zeros_like(at)
    moving[-4:, 0] = 2
    pairs = []
    for s in range(1, storeys + 1):
        lower, here = 4 * (s - 1), 4 * s
        for corner in range(4):
            after = (corner + 1) % 4
            pairs += [(lower + corner, here + corner), (here + corner, here + after), (lower + corner, here + after), (lower + after, here + corner)]
        pairs += [(here, here + 2), (here + 1, here + 3)]
    links = [[a, b, 1e7, 2e3, distance(at, a, b)] for a, b in pairs]
    return [4 * storeys, 4 * storeys + 1], *net(at, mass, links, [0, -9.81, 0], 3, "DOP853", moving=moving, **how)


def large_cloth(**how):
    return cloth(100, 0.25, **how)


SCENES = {
    "spring-ratio": spring_ratio,
    "heavy-rope": heavy_rope,
    "cloth": cloth,
    "cloth-100": large_cloth,
    "bridge-1000": bridge,
    "tower": tower,
}


def write(name, positions, bodies, times):
    columns = ["t"] + [f"{a}{b}" for b in bodies for a in "xyz"]
    with open(f"{name}.csv", "w") as file:
        file.write(f"# points {bodies} of the scene {name}; see praised.py\n{','.join(columns)}\n")
        for t, row in zip(times, positions[:, bodies].reshape(len(times), -1)):
            file.write(",".join(f"{x:.9g}" for x in [t, *row]) + "\n")


if __name__ == "__main__":
    wanted = [word for word in sys.argv[1:] if word in SCENES] or SCENES
    for name in wanted:
        scene = SCENES[name]
        if "--check" in sys.argv:
            bodies, _, fine = scene(rtol=1e-10)
            for how in (dict(rtol=1e-8), dict(rtol=1e-10, off=1e-7)):
                _, _, other = scene(**how)
                off = np.linalg.norm(other - fine, axis=2)[:, bodies]
                print(name, how, f"{off.max():.1e} m", flush=True)
        else:
            bodies, times, positions = scene(rtol=1e-10)
            write(name, positions, bodies, times)
            print(name, positions[-1, bodies].round(4).tolist(), flush=True)
