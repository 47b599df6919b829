"""Reads the scenes of points that `compare --describe` writes."""
import pathlib

import numpy as np

# Of more bodies MuJoCo cannot allocate its matrix, and the others take hours with a call from Python per step.
MOST_BODIES = 2000


def read(path):
    scene = dict(bodies=[], links=[], truth={})
    for line in path.read_text().splitlines():
        key, *words = line.split()
        numbers = [float(w) for w in words]
        if key == "body":
            scene["bodies"].append(numbers)
        elif key == "link":
            scene["links"].append(numbers)
        elif key == "at":
            scene["truth"][round(numbers[0] * 240)] = np.array(numbers[1:]).reshape(-1, 3)
        else:
            scene[key] = numbers
    scene["watched"] = [int(b) for b in scene["watched"]]
    return scene


def scenes(folder):
    """Names and scenes of a folder."""
    for path in sorted(pathlib.Path(folder).glob("*.txt")):
        scene = read(path)
        if len(scene["bodies"]) <= MOST_BODIES:
            yield path.stem, scene
