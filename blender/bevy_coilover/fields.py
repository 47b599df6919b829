# SPDX-License-Identifier: MIT OR Apache-2.0
"""What an element can have: one table, from which properties, panels, export and import are made.

The names in the file are those of the crate's components and fields in lowerCamelCase; see `docs/gltf.md`.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Field:
    """One value. `kind` is number, vector, color, flag, choice or points."""

    key: str
    label: str
    default: object
    about: str
    kind: str = "number"
    #: Blender's name of the unit, where it has one; all values are SI.
    unit: str = "NONE"
    least: float = -3.4e38
    #: May be left out of the file; then there is a tick box before it.
    optional: bool = False
    #: Names of a choice, as the crate has them.
    choices: tuple = ()
    #: What it is where a file leaves it out, if that is not the panel's default.
    absent: object = None
    #: The same beside `"fitted": true`.
    fitted: object = None
    #: Without it, the crate leaves the whole companion out.
    required: bool = False

    @property
    def prop(self):
        return snake(self.key)

    @property
    def tick(self):
        return "use_" + self.prop


@dataclass(frozen=True)
class Companion:
    """A component beside the element. With `variants` it is an enum of Rust: a tuple of (name, fields)."""

    key: str
    label: str
    about: str
    fields: tuple = ()
    variants: tuple = ()
    #: The single field is the whole component: a bare number, or the string of a choice.
    bare: bool = False
    #: Linear elements only.
    linear: bool = False
    #: Starts opened and ticked on new elements of these kinds.
    of: tuple = ()

    @property
    def prop(self):
        return snake(self.key)


def snake(key):
    """minLength -> min_length, pull.linear -> pull_linear"""
    return "".join("_" + c.lower() if c.isupper() else c for c in key.replace(".", "_"))


def number(key, label, default, about, **more):
    return Field(key, label, default, about, **more)


def length(key, label, default, about, **more):
    return Field(key, label, default, about, unit="LENGTH", **more)


def choice(key, label, choices, about):
    return Field(key, label, choices[0], about, kind="choice", choices=choices)


def flag(key, label, about):
    return Field(key, label, False, about, kind="flag")


POINTS = Field("points", "Points", (), "Points of the table, from left to right", kind="points")


def polynomial(key, label):
    """A group of three numbers inside a variant."""
    return (
        number(key + ".linear", label + " k1 (N/m)", 100.0, "Force per stretch", least=0.0, absent=0.0),
        number(key + ".quadratic", label + " k2 (N/m²)", 0.0, "Force per stretch squared", least=0.0),
        number(key + ".cubic", label + " k3 (N/m³)", 0.0, "Force per stretch cubed", least=0.0),
    )


RATIO = number("dampingRatio", "Damping Ratio", 0.3, "0 swings for ever, 1 is critical", least=0.0, absent=0.0)

COMPANIONS = (
    Companion(
        "preload", "Preload", "Constant force, tension positive",
        (number("preload", "Preload (N)", 0.0, "Pulls where positive, pushes where negative"),), bare=True,
    ),
    Companion(
        "holdPose", "Hold Pose", "Finds the preload with which the load rests where it stands",
        (
            choice("load", "Load", ("Moving", "A", "B"), "Which end is carried"),
            number("share", "Share", 1.0, "Share of the load that this element carries", least=1e-6),
            number("mass", "Mass", 1.0, "Mass of the load, where it is not that of the body alone",
                   unit="MASS", least=0.0, optional=True),
        ),
    ),
    Companion(
        "springTuning", "Tuning", "Stiffness and damping found by Bevy at the first step, instead of the numbers above",
        variants=(
            ("Frequency", (
                number("frequency", "Frequency (Hz)", 2.0, "Natural frequency", least=1e-6, required=True), RATIO,
            )),
            ("Sag", (
                length("sag", "Sag", 0.1, "How far it gives way under its load", least=1e-6, required=True), RATIO,
            )),
        ),
    ),
    Companion(
        "springAction", "Action", "Pulls only, as a rope, or pushes only, as a buffer",
        (choice("action", "Action", ("Both", "Pull", "Push"), "Which way it acts"),), bare=True,
    ),
    Companion(
        "springTravel", "Stops", "Lengths beyond which stops act",
        (
            length("minLength", "Shortest", 0.2, "Length at which the lower stop is met", optional=True),
            length("maxLength", "Longest", 1.0, "Length at which the upper stop is met", optional=True),
            number("stopStiffness", "Stiffness (N/m)", 1e5, "Of the stops", least=0.0, absent=0.0),
            number("progression", "Progression (1/m)", 0.0, "How much stiffer stops get", least=0.0),
            number("stopDamping", "Damping (N s/m)", 0.0, "Of the stops", least=0.0),
        ),
    ),
    Companion(
        "maxForce", "Greatest Force", "Limit of spring and damper together",
        (number("force", "Force (N)", 1000.0, "Never more than this", least=1e-6),), bare=True,
    ),
    Companion(
        "breakable", "Breakable", "Breaks at a force or a length",
        (
            number("force", "Force (N)", 1000.0, "Breaks above this force", least=0.0, optional=True),
            length("length", "Length", 2.0, "Breaks beyond this length", least=0.0, optional=True),
            choice("then", "Then", ("Despawn", "Disable"), "What becomes of it"),
        ),
    ),
    Companion(
        "springAxis", "Direction", "Acts along an axis instead of from end to end", linear=True,
        variants=tuple(
            (name, (Field("axis", "Axis", (0.0, 0.0, 1.0), about, kind="vector", required=True),))
            for name, about in (("World", "Axis of the world"), ("BodyA", "Axis of end A's body, which turns with it"))
        ),
    ),
    Companion(
        "springLaw", "Spring Law", "Force over stretch, where it is not stiffness times stretch",
        variants=(
            ("Linear", ()),
            ("Cubic", ()),
            ("Polynomial", polynomial("pull", "Pull") + polynomial("push", "Push")),
            ("Table", (POINTS,)),
        ),
    ),
    Companion(
        "dampingLaw", "Damping Law", "Force over rate, where it is not damping times rate",
        variants=(
            ("Linear", ()),
            ("Sided", (
                number("bump", "Bump (N s/m)", 40.0, "While it gets shorter", least=0.0, absent=0.0),
                number("rebound", "Rebound (N s/m)", 80.0, "While it gets longer", least=0.0, absent=0.0),
            )),
            ("Quadratic", (
                number("linear", "c1 (N s/m)", 10.0, "Per rate", least=0.0, absent=0.0),
                number("quadratic", "c2 (N s²/m²)", 40.0, "Per rate squared", least=0.0, absent=0.0),
            )),
            ("BlowOff", (
                number("damping", "Damping (N s/m)", 80.0, "Up to the knee", least=0.0, absent=0.0),
                number("knee", "Knee (m/s)", 0.1, "Speed at which the valve opens", least=0.0, absent=0.0),
                number("beyond", "Beyond (N s/m)", 20.0, "Of the speed above the knee", least=0.0, absent=0.0),
            )),
            ("Table", (POINTS,)),
        ),
    ),
    Companion(
        "coil", "Coil", "Draws a coil spring between the ends", linear=True, of=("spring", "springDamper"),
        fields=(
            flag("fitted", "Fitted", "Radii are shares of the length between the ends"),
            length("radius", "Radius", 0.13, "From the axis to the middle of the wire", least=1e-6, fitted=0.1),
            length("wireRadius", "Wire Radius", 0.016, "Half the thickness of the wire", least=1e-6, fitted=0.012),
            number("turns", "Turns", 8.0, "From end to end", least=0.25),
            choice("ends", "Ends", ("ClosedGround", "Open", "Closed"), "How the wire ends"),
            choice("handedness", "Winding", ("Right", "Left"), "Which way it is wound"),
            Field("color", "Paint", (0.604, 0.0087, 0.006, 1.0), "Linear colour", kind="color"),
        ),
    ),
    Companion(
        "telescope", "Telescope", "Draws a damper of tube and rod between the ends", linear=True,
        of=("damper", "springDamper"),
        fields=(
            flag("fitted", "Fitted", "Radii and lengths are shares of the length between the ends"),
            length("tubeRadius", "Tube Radius", 0.062, "Of the tube, at end A", least=1e-6, fitted=0.048),
            length("rodRadius", "Rod Radius", 0.026, "Of the rod, at end B; less than the tube's", least=1e-6,
                   fitted=0.02),
            length("tubeLength", "Tube Length", 0.5, "From end A to the mouth", least=1e-6, optional=True),
            length("rodLength", "Rod Length", 0.5, "From end B to the tip", least=1e-6, optional=True),
            length("stroke", "Stroke", 0.5, "From shortest to longest", least=1e-6, optional=True),
            flag("eyes", "Eyes", "Draws an eye at each end"),
            flag("bumpRubber", "Bump Rubber", "Draws a rubber on the rod"),
            Field("color", "Paint", (0.01, 0.0116, 0.0152, 1.0), "Linear colour of the tube", kind="color"),
        ),
    ),
    Companion("disabled", "Disabled", "It does not act until the game enables it"),
    Companion(
        "showSpringGizmos", "Debug Lines", "Bevy draws ends, rest length and forces as lines, or never does",
        (Field("shown", "Shown", True, "Off, they are not even drawn where the game shows those of all", kind="flag"),),
        bare=True,
    ),
)

#: Key in the file, label, what it is.
KINDS = (
    ("spring", "Spring", "Stiffness between two ends"),
    ("damper", "Damper", "Damping between two ends"),
    ("springDamper", "Spring and Damper", "Both side by side"),
    ("torsionSpring", "Torsion Spring", "Stiffness about an axis of end A"),
    ("torsionDamper", "Torsion Damper", "Damping about an axis of end A"),
    ("torsionSpringDamper", "Torsion Spring and Damper", "Both side by side, about an axis of end A"),
)

#: Of the extension in the file.
NAME = "BEVY_coilover"


def is_torsion(kind):
    return kind.startswith("torsion")


def has_spring(kind):
    return "pring" in kind


def has_damper(kind):
    return "amper" in kind
