"""Writes dumbbell.csv and star.csv with SciPy's DOP853: rigid bodies and points joined by linear spring-dampers.

Run: python3 -m venv venv && venv/bin/pip install numpy scipy && venv/bin/python references.py
One row every 1/240 s, SI units. The scenes are those of ../src/scenes/dumbbell.rs and ../src/scenes/star.rs.
"""
import numpy as np
from scipy.integrate import solve_ivp

HZ = 240


def rotation(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def rate_of(q, w):
    """Of a quaternion (w, x, y, z), for an angular velocity in the body's frame."""
    return 0.5 * np.array([-q[1] * w[0] - q[2] * w[1] - q[3] * w[2], q[0] * w[0] + q[2] * w[2] - q[3] * w[1],
                           q[0] * w[1] - q[1] * w[2] + q[3] * w[0], q[0] * w[2] + q[1] * w[1] - q[2] * w[0]])


def dumbbell(times):
    """Two bricks that spin and swing, held off-centre, without gravity. Rotations start as none."""
    mass = [2.0, 0.5]
    inertia = np.array([[0.2, 0.3, 0.45], [0.02, 0.05, 0.06]])
    anchor = np.array([[0.4, 0.2, 0.1], [-0.3, 0.1, 0.2]])
    stiffness, rest = 20.0, 1.0
    #         position         velocity            quaternion  angular velocity
    start = [[0, 0, 0,         0, -0.25, -0.125,   1, 0, 0, 0, 1, -2, 0.5],
             [2, 0.3, -0.1,    0, 1, 0.5,          1, 0, 0, 0, -1, 0.5, 3]]

    def flow(_, state):
        s = state.reshape(2, 13)
        r = [rotation(b[6:10]) for b in s]
        arm = [r[i] @ anchor[i] for i in range(2)]
        d = s[1, :3] + arm[1] - s[0, :3] - arm[0]
        length = np.linalg.norm(d)
        pull = stiffness * (length - rest) * d / length
        out = np.zeros((2, 13))
        for i, force in ((0, pull), (1, -pull)):
            w = s[i, 10:]
            out[i] = np.r_[s[i, 3:6], force / mass[i], rate_of(s[i, 6:10], w),
                           (r[i].T @ np.cross(arm[i], force) - np.cross(w, inertia[i] * w)) / inertia[i]]
        return out.ravel()

    solved = solve_ivp(flow, (0, times[-1]), np.array(start, float).ravel(), t_eval=times, rtol=1e-12, atol=1e-13, method="DOP853")
    return solved.y.T.reshape(-1, 2, 13)[:, :, :3]


def star(times, count=50):
    """A hub with satellites all round it, every one at its own speed across its spring, without gravity."""
    i = np.arange(count)
    z = 1 - (2 * i + 1) / count
    turn = i * np.pi * (3 - np.sqrt(5))
    out = np.c_[np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z]
    mass = np.r_[5.0, np.full(count, 0.1)]
    stiffness, damping, rest = 100.0, 0.2, 1.0
    x0 = np.r_[np.zeros((1, 3)), out * (1.0 + 0.05 * (i % 5))[:, None]]
    # Single precision, as a game's components hold it.
    x0 = x0.astype(np.float32).astype(float)
    v0 = np.zeros_like(x0)
    v0[1:] = np.cross(out, [0, 0, 1.0]) * (0.5 * (1 + i % 3))[:, None]
    v0 = v0.astype(np.float32).astype(float)

    def flow(_, state):
        x, v = state.reshape(2, -1, 3)
        d, w = x[1:] - x[0], v[1:] - v[0]
        length = np.linalg.norm(d, axis=1)
        u = d / length[:, None]
        pull = (stiffness * (length - rest) + damping * np.einsum("ij,ij->i", w, u))[:, None] * u
        return np.r_[v.ravel(), (np.r_[pull.sum(0)[None], -pull] / mass[:, None]).ravel()]

    solved = solve_ivp(flow, (0, times[-1]), np.r_[x0.ravel(), v0.ravel()], t_eval=times, rtol=1e-11, atol=1e-12, method="DOP853")
    return solved.y[: 3 * len(mass)].T.reshape(-1, len(mass), 3)


def write(name, note, positions, bodies, times):
    columns = ["t"] + [f"{a}{b}" for b in bodies for a in "xyz"]
    with open(f"{name}.csv", "w") as file:
        file.write(f"# {note}\n{','.join(columns)}\n")
        for t, row in zip(times, positions[:, bodies].reshape(len(times), -1)):
            file.write(",".join(f"{x:.9g}" for x in [t, *row]) + "\n")


if __name__ == "__main__":
    times = np.arange(3 * HZ + 1) / HZ
    write("dumbbell", "two spinning bricks on one undamped spring with off-centre anchors; see references.py", dumbbell(times), [0, 1], times)
    write("star", "a hub with 50 satellites on springs; the hub and satellites 1, 18 and 50; see references.py", star(times), [0, 1, 18, 50], times)
