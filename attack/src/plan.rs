//! Descriptions of random scenes: bodies, elements, and what is done to them while the scene runs.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// Number of ticks that a scene runs.
pub const TICKS: u8 = 60;

/// Kind of body of an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A body that physics moves.
    Dynamic,
    /// A body that never moves.
    Fixed,
    /// A kinematic body whose position the game sets.
    KinematicPlace,
    /// A kinematic body whose velocity the game sets.
    KinematicSpeed,
    /// An entity without a body.
    Point,
}

/// Collider of a body.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// No collider.
    None,
    /// A ball of this radius, m.
    Ball(f32),
    /// A cube of this half edge, m.
    Cube(f32),
}

/// One body.
#[derive(Clone, Debug)]
pub struct BodyPlan {
    /// Kind of the body.
    pub kind: Kind,
    /// Mass, kg.
    pub mass: f32,
    /// Position, m.
    pub place: [f32; 3],
    /// Velocity, m/s.
    pub speed: [f32; 3],
    /// Angular velocity, rad/s.
    pub spin: [f32; 3],
    /// Collider.
    pub shape: Shape,
    /// Bits of `LockedAxes`.
    pub locks: u8,
    /// Factor on the scene's gravity.
    pub gravity: f32,
    /// Additional solver iterations.
    pub iterations: u8,
    /// Index of the parent body, which has to come before this one.
    pub below: Option<u8>,
}

/// One element.
#[derive(Clone, Debug)]
pub struct ElementPlan {
    /// 0 spring, 1 damper, 2 spring and damper; 3 to 5 are these for torsion.
    pub kind: u8,
    /// Indices of its bodies.
    pub ends: [u8; 2],
    /// Stiffness, N/m or N m/rad.
    pub stiffness: f32,
    /// Damping, N s/m or N m s/rad.
    pub damping: f32,
    /// Rest length in m or rest angle in rad. `None` takes it from the pose.
    pub rest: Option<f32>,
    /// Anchors in the frames of the bodies, m.
    pub anchors: Option<[[f32; 3]; 2]>,
    /// Axis of a torsion element.
    pub axis: [f32; 3],
    /// Companion component.
    pub companion: Companion,
}

/// Companion component of an element.
#[derive(Clone, Debug)]
pub enum Companion {
    /// No companion.
    None,
    /// The element only pulls.
    Pull,
    /// The element only pushes.
    Push,
    /// Preload, N.
    Preload(f32),
    /// Force limit, N.
    MaxForce(f32),
    /// Minimum and maximum length in m, and stiffness of the stops in N/m.
    Travel(f32, f32, f32),
    /// The element acts along an axis of body A.
    Axis([f32; 3]),
    /// Force at which it breaks, N.
    Breakable(f32),
    /// Polynomial law: linear stiffness in N/m and cubic stiffness in N/m³.
    Cubic(f32, f32),
    /// Table law: a point below and a point above zero, each of stretch in m and force in N.
    Table([f32; 2], [f32; 2]),
    /// Sided damper: bump and rebound damping, N s/m.
    Sided(f32, f32),
    /// Tuning: frequency in Hz and damping ratio.
    Tuning(f32, f32),
    /// The element holds its load where it is.
    HoldPose,
}

/// A change to a scene while it runs. Numbers of type `u8` are indices of bodies or elements.
#[derive(Clone, Debug)]
pub enum Deed {
    /// Despawns a body and its children.
    DespawnBody(u8),
    /// Despawns an element.
    DespawnElement(u8),
    /// Spawns an element.
    SpawnElement(ElementPlan),
    /// Disables a body in the engine, or enables it.
    ToggleBody(u8),
    /// Disables an element, or enables it.
    ToggleElement(u8),
    /// Changes the kind of a body.
    Become(u8, Kind),
    /// Moves a body to a position, m.
    Teleport(u8, [f32; 3]),
    /// Adds to the velocity of a body, m/s.
    Kick(u8, [f32; 3]),
    /// Gives a body another collider, or none.
    Reshape(u8, Shape),
    /// Sets the user's force on a body, N.
    Push(u8, [f32; 3]),
    /// Makes a body the child of another one, or of none.
    Below(u8, Option<u8>),
    /// Sets the scale of a body.
    Scale(u8, f32),
    /// Sets the mass of a body, kg.
    Weigh(u8, f32),
    /// Sets the stiffness of an element.
    Stiffen(u8, f32),
    /// Gives an element other ends.
    Retie(u8, [u8; 2]),
    /// Replaces or adds a companion of an element.
    Accompany(u8, Companion),
    /// Adds one of Rapier's joints between two bodies: 0 ball, 1 hinge, 2 slider, 3 fixed, 4 rope, 5 spring.
    Join(u8, [u8; 2]),
    /// Sets gravity, m/s².
    Gravity([f32; 3]),
    /// Sets the length of a tick in s, and its number of substeps.
    Rate(f32, u8),
    /// Pauses physics (`true`) or continues it.
    Pause(bool),
    /// Sets micro-steps, extrapolation and tolerance.
    Settings(u8, bool, Option<f32>),
}

/// A scene and its changes.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Bodies of the scene.
    pub bodies: Vec<BodyPlan>,
    /// Elements of the scene.
    pub elements: Vec<ElementPlan>,
    /// Changes with their ticks, in any order.
    pub deeds: Vec<(u8, Deed)>,
    /// Whether the scene has a ground.
    pub ground: bool,
    /// Pairs of ticks: a snapshot is taken after the first, and restored before the second.
    pub goes_back: Vec<[u8; 2]>,
}

/// Random numbers with a uniform logarithm.
fn spread(least: f32, most: f32) -> impl Strategy<Value = f32> + Clone {
    (least.ln()..most.ln()).prop_map(f32::exp)
}

/// Mostly valid numbers, and now and then a number that no element should get.
fn number(least: f32, most: f32) -> impl Strategy<Value = f32> + Clone {
    prop_oneof![
        40 => spread(least, most),
        2 => Just(0.0),
        2 => select(&[
            f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e12, 1e-40, 1e38, -1e38, f32::MAX,
        ][..]),
    ]
}

fn vector(size: f32) -> impl Strategy<Value = [f32; 3]> + Clone {
    [-size..size, -size..size, -size..size]
}

fn shape() -> impl Strategy<Value = Shape> + Clone {
    prop_oneof![
        2 => Just(Shape::None),
        1 => (0.02_f32..0.8).prop_map(Shape::Ball),
        1 => (0.02_f32..0.8).prop_map(Shape::Cube),
    ]
}

fn kind() -> impl Strategy<Value = Kind> + Clone {
    prop_oneof![
        6 => Just(Kind::Dynamic),
        1 => Just(Kind::Fixed),
        1 => Just(Kind::KinematicPlace),
        1 => Just(Kind::KinematicSpeed),
        1 => Just(Kind::Point),
    ]
}

fn body() -> impl Strategy<Value = BodyPlan> + Clone {
    let rest = prop_oneof![3 => Just(0.0_f32), 1 => Just(1.0_f32)];
    let motion = (vector(5.0), vector(5.0), rest)
        .prop_map(|(speed, spin, moves)| [speed, spin].map(|v| v.map(|x| moves * x)));
    (
        (kind(), spread(1e-3, 1e4), vector(2.0), motion, shape()),
        (
            prop_oneof![4 => Just(0_u8), 1 => any::<u8>().prop_map(|bits| bits & 63)],
            prop_oneof![4 => Just(1.0_f32), 1 => -2.0_f32..3.0],
            prop_oneof![5 => Just(0_u8), 1 => 0_u8..12],
            prop_oneof![5 => Just(None), 1 => (0_u8..8).prop_map(Some)],
        ),
    )
        .prop_map(
            |((kind, mass, place, [speed, spin], shape), (locks, gravity, iterations, below))| {
                BodyPlan {
                    kind,
                    mass,
                    place,
                    speed,
                    spin,
                    shape,
                    locks,
                    gravity,
                    iterations,
                    below,
                }
            },
        )
}

fn companion() -> impl Strategy<Value = Companion> + Clone {
    prop_oneof![
        8 => Just(Companion::None),
        1 => Just(Companion::Pull),
        1 => Just(Companion::Push),
        1 => number(1e-2, 1e5).prop_map(Companion::Preload),
        1 => number(1e-2, 1e5).prop_map(Companion::MaxForce),
        1 => (number(1e-2, 1.0), number(1e-1, 10.0), number(1.0, 1e8))
            .prop_map(|(a, b, c)| Companion::Travel(a, b, c)),
        1 => vector(1.0).prop_map(Companion::Axis),
        1 => number(1e-1, 1e5).prop_map(Companion::Breakable),
        1 => (number(1.0, 1e6), number(1.0, 1e6)).prop_map(|(a, b)| Companion::Cubic(a, b)),
        1 => [number(1e-3, 1e3), number(1e-3, 1e3), number(1e-3, 1e3), number(1e-3, 1e3)]
            .prop_map(|[a, b, c, d]| Companion::Table([-a, -b], [c, d])),
        1 => (number(1e-1, 1e6), number(1e-1, 1e6)).prop_map(|(a, b)| Companion::Sided(a, b)),
        1 => (number(1e-1, 60.0), number(1e-2, 3.0)).prop_map(|(a, b)| Companion::Tuning(a, b)),
        1 => Just(Companion::HoldPose),
    ]
}

fn element() -> impl Strategy<Value = ElementPlan> + Clone {
    (
        (
            0_u8..6,
            [0_u8..8, 0..8],
            number(1e-1, 1e8),
            number(1e-2, 1e6),
        ),
        (
            prop_oneof![Just(None), number(1e-2, 10.0).prop_map(Some)],
            prop_oneof![2 => Just(None), 1 => [vector(1.0), vector(1.0)].prop_map(Some)],
            prop_oneof![20 => vector(1.0), 1 => Just([0.0; 3])],
            companion(),
        ),
    )
        .prop_map(
            |((kind, ends, stiffness, damping), (rest, anchors, axis, companion))| ElementPlan {
                kind,
                ends,
                stiffness,
                damping,
                rest,
                anchors,
                axis,
                companion,
            },
        )
}

fn deed() -> impl Strategy<Value = Deed> + Clone {
    let b = || 0_u8..8;
    prop_oneof![
        b().prop_map(Deed::DespawnBody),
        b().prop_map(Deed::DespawnElement),
        element().prop_map(Deed::SpawnElement),
        b().prop_map(Deed::ToggleBody),
        b().prop_map(Deed::ToggleElement),
        (b(), kind()).prop_map(|(b, kind)| Deed::Become(b, kind)),
        (b(), vector(5.0)).prop_map(|(b, at)| Deed::Teleport(b, at)),
        (b(), vector(20.0)).prop_map(|(b, by)| Deed::Kick(b, by)),
        (b(), shape()).prop_map(|(b, shape)| Deed::Reshape(b, shape)),
        (b(), vector(1e3)).prop_map(|(b, by)| Deed::Push(b, by)),
        (b(), prop::option::of(b())).prop_map(|(b, below)| Deed::Below(b, below)),
        (b(), spread(0.1, 10.0)).prop_map(|(b, by)| Deed::Scale(b, by)),
        (b(), spread(1e-3, 1e4)).prop_map(|(b, mass)| Deed::Weigh(b, mass)),
        (b(), number(1e-1, 1e8)).prop_map(|(e, stiffness)| Deed::Stiffen(e, stiffness)),
        (b(), [b(), b()]).prop_map(|(e, ends)| Deed::Retie(e, ends)),
        (b(), companion()).prop_map(|(e, companion)| Deed::Accompany(e, companion)),
        (0_u8..6, [b(), b()]).prop_map(|(kind, ends)| Deed::Join(kind, ends)),
        vector(30.0).prop_map(Deed::Gravity),
        (spread(1e-3, 0.1), 1_u8..4).prop_map(|(time, steps)| Deed::Rate(time, steps)),
        any::<bool>().prop_map(Deed::Pause),
        (
            0_u8..20,
            any::<bool>(),
            prop::option::of(number(1e-6, 1e-1))
        )
            .prop_map(|(n, extrapolates, tolerance)| Deed::Settings(
                n,
                extrapolates,
                tolerance
            )),
    ]
}

/// Strategy for random scenes.
pub fn plans() -> impl Strategy<Value = Plan> {
    (
        vec(body(), 1..8),
        vec(element(), 1..8),
        vec((0..TICKS, deed()), 0..8),
        any::<bool>(),
        // This stays last, so that each seed keeps its bodies, elements and changes.
        prop_oneof![2 => Just(Vec::new()), 1 => vec([0..TICKS, 0..TICKS], 1..4)],
    )
        .prop_map(|(bodies, elements, deeds, ground, goes_back)| Plan {
            bodies,
            elements,
            deeds,
            ground,
            goes_back,
        })
}
