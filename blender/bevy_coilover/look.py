# SPDX-License-Identifier: MIT OR Apache-2.0
"""Which solids an element is drawn as, and how they slide with its length: the crate's `Layout`, without Blender."""

from dataclasses import dataclass, field

from . import shape

SHORT = 1e-5
#: However far they are pulled, the tube holds this share of the rod; and at full stroke, that one.
LEAST_OVERLAP, OVERLAP = 0.05, 0.15
STEEL = (0.62, 0.62, 0.65, 1.0)
RUBBER = (0.02, 0.02, 0.02, 1.0)


@dataclass
class Coil:
    radius: float = 0.13
    wire_radius: float = 0.016
    turns: float = 8.0
    ends: str = "ClosedGround"
    handedness: str = "Right"
    color: tuple = (0.604, 0.0087, 0.006, 1.0)
    fitted: bool = False


@dataclass
class Telescope:
    tube_radius: float = 0.062
    rod_radius: float = 0.026
    tube_length: float = None
    rod_length: float = None
    stroke: float = None
    eyes: bool = False
    bump_rubber: bool = False
    color: tuple = (0.01, 0.0116, 0.0152, 1.0)
    fitted: bool = False


@dataclass
class Part:
    """A solid in metres along +Z, and its paint."""

    name: str
    mesh: shape.Mesh = field(repr=False)
    color: tuple = STEEL


def parts(coil, telescope, length, first, detail=24):
    """The solids of an element of this length that was `first` long when it was first drawn."""
    length, first = max(length, SHORT), max(first, SHORT)
    size = lambda look, value: value * first if look.fitted else value
    out, foot, body = [], 0.0, 0.0
    around = max(6, detail // 2)
    if telescope is not None:
        tube_radius = size(telescope, telescope.tube_radius)
        rod_radius = size(telescope, telescope.rod_radius)
        given = lambda value: None if value is None else size(telescope, value)
        eye = 1.25 * tube_radius if telescope.eyes else 0.0
        body = 0.8 * eye
        foot = body + (1.5 * size(coil, coil.wire_radius) if coil is not None else 0.0)
        stroke = min(given(telescope.stroke) or 0.5 * first, 1.9 * first)
        shortest, longest = first - 0.5 * stroke, first + 0.5 * stroke
        tube = given(telescope.tube_length) or max(shortest - foot - 0.5 * tube_radius, 0.6 * shortest)
        room = max(shortest - body, 0.5 * shortest)
        rod = given(telescope.rod_length) or min(longest - tube * (1.0 - OVERLAP), room)
        mouth = min(tube, max(length - foot, 0.5 * length))
        least = length - mouth * (1.0 - LEAST_OVERLAP)
        tip = min(max(rod, least), max(length - body, least))

        def solid(name, radius, low, high, color):
            out.append(Part(name, shape.cylinder(radius, low, max(high, low + SHORT), detail), color))

        solid("Tube", tube_radius, body, mouth, telescope.color)
        solid("Collar", 1.12 * tube_radius, max(mouth - 0.5 * tube_radius, body), mouth, telescope.color)
        solid("Rod", rod_radius, length - tip, length - body, STEEL)
        if telescope.bump_rubber:
            bump = 0.25 * max(first - tube - foot, 0.0)
            if bump > SHORT:
                top = length - foot
                solid("Bump", 0.5 * (tube_radius + rod_radius), max(top - bump, mouth), top, RUBBER)
        if coil is not None:
            plate = size(coil, coil.radius + 1.5 * coil.wire_radius)
            solid("Seat A", plate, body, foot, telescope.color)
            solid("Seat B", plate, length - foot, length - body, telescope.color)
        if telescope.eyes:
            for name, at in (("Eye A", 0.0), ("Eye B", length)):
                mesh = shape.ring(0.7 * eye, 0.3 * eye, detail, around)
                mesh.points[:, 2] += at
                out.append(Part(name, mesh, STEEL))
    if coil is not None:
        span = max(length - 2.0 * foot, SHORT)
        mesh = shape.coil(
            size(coil, coil.radius), size(coil, coil.wire_radius), coil.turns, span,
            coil.ends, coil.handedness, detail, around,
        )
        mesh.points[:, 2] += foot
        out.append(Part("Coil", mesh, tuple(coil.color)))
    if not out:
        out.append(Part("Line", shape.cylinder(0.01 * first, 0.0, length, 8), (0.9, 0.5, 0.1, 1.0)))
    return out
