//! What a scene can be made of, and what can be done to it.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// Ticks that a scene runs.
pub const TICKS: u8 = 60;

/// What an end stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Moved by physics.
    Dynamic,
    /// Never moves.
    Fixed,
    /// The game says where it goes,
    KinematicPlace,
    /// or how fast.
    KinematicSpeed,
    /// No body.
    Point,
}

/// The shape that a body touches others with.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// Touches nothing.
    None,
    /// Radius, m.
    Ball(f32),
    /// Half of a side, m.
    Cube(f32),
}

/// One body.
#[derive(Clone, Debug)]
pub struct BodyPlan {
    /// What moves it.
    pub kind: Kind,
    /// kg.
    pub mass: f32,
    /// m.
    pub place: [f32; 3],
    /// m/s.
    pub speed: [f32; 3],
    /// rad/s.
    pub spin: [f32; 3],
    /// What it touches with.
    pub shape: Shape,
    /// Bits of `LockedAxes`.
    pub locks: u8,
    /// Times the scene's.
    pub gravity: f32,
    /// More solver iterations than others.
    pub iterations: u8,
    /// Index of the body that it stands below, if that comes before it.
    pub below: Option<u8>,
}

/// One element. What kind it is, says `kind`: linear ones are 0 to 2, torsion ones 3 to 5.
#[derive(Clone, Debug)]
pub struct ElementPlan {
    /// Spring, damper, both; and the same for torsion.
    pub kind: u8,
    /// Indices of its bodies.
    pub ends: [u8; 2],
    /// N/m or N m/rad.
    pub stiffness: f32,
    /// N s/m or N m s/rad.
    pub damping: f32,
    /// m or rad.
    pub rest: Option<f32>,
    /// In the frames of its bodies, m.
    pub anchors: Option<[[f32; 3]; 2]>,
    /// The axis of a torsion element.
    pub axis: [f32; 3],
    /// What stands beside it.
    pub companion: Companion,
}

/// What stands beside an element.
#[derive(Clone, Debug)]
pub enum Companion {
    /// Nothing.
    None,
    /// It pulls only.
    Pull,
    /// It pushes only.
    Push,
    /// N.
    Preload(f32),
    /// N.
    MaxForce(f32),
    /// Shortest, longest, and stiffness of the stops.
    Travel(f32, f32, f32),
    /// Along an axis of body A.
    Axis([f32; 3]),
    /// Force at which it breaks, N.
    Breakable(f32),
    /// Linear and cubic stiffness.
    Cubic(f32, f32),
    /// Two points of a table of forces.
    Table([f32; 2], [f32; 2]),
    /// Bump and rebound.
    Sided(f32, f32),
    /// Frequency and damping ratio.
    Tuning(f32, f32),
    /// Keeps its load where it is.
    HoldPose,
}

/// What is done to a scene while it runs. Numbers are indices of bodies or elements.
#[derive(Clone, Debug)]
pub enum Deed {
    /// A body goes, and what stands below it.
    DespawnBody(u8),
    /// An element goes.
    DespawnElement(u8),
    /// Another element comes.
    SpawnElement(ElementPlan),
    /// A body is disabled in the engine, or enabled.
    ToggleBody(u8),
    /// An element is disabled, or enabled.
    ToggleElement(u8),
    /// A body becomes another kind of body.
    Become(u8, Kind),
    /// It is somewhere else.
    Teleport(u8, [f32; 3]),
    /// It is faster.
    Kick(u8, [f32; 3]),
    /// It gets another shape, or none.
    Reshape(u8, Shape),
    /// The game pushes it, N.
    Push(u8, [f32; 3]),
    /// It stands below another one, or below none.
    Below(u8, Option<u8>),
    /// It is larger.
    Scale(u8, f32),
    /// It is heavier.
    Weigh(u8, f32),
    /// Another stiffness.
    Stiffen(u8, f32),
    /// Other ends.
    Retie(u8, [u8; 2]),
    /// Another companion, or one more.
    Accompany(u8, Companion),
    /// Rapier's own joint between two bodies: 0 ball, 1 hinge, 2 slider, 3 fixed, 4 rope, 5 spring.
    Join(u8, [u8; 2]),
    /// Gravity, m/s².
    Gravity([f32; 3]),
    /// Seconds of a tick, and how many steps it is made of.
    Rate(f32, u8),
    /// Physics stands still, or goes on.
    Pause(bool),
    /// Micro-steps, extrapolation, tolerance.
    Settings(u8, bool, Option<f32>),
}

/// A scene, and what is done to it in which tick.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Its bodies.
    pub bodies: Vec<BodyPlan>,
    /// Its elements.
    pub elements: Vec<ElementPlan>,
    /// Tick and deed, in any order.
    pub deeds: Vec<(u8, Deed)>,
    /// There is a ground to fall on.
    pub ground: bool,
    /// Ticks after which snapshots are taken, and ticks before which they are put back.
    pub goes_back: Vec<[u8; 2]>,
}

/// Even in its logarithm.
fn spread(least: f32, most: f32) -> impl Strategy<Value = f32> + Clone {
    (least.ln()..most.ln()).prop_map(f32::exp)
}

/// Mostly sound numbers, and now and then what no element should get.
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

/// All scenes.
pub fn plans() -> impl Strategy<Value = Plan> {
    (
        vec(body(), 1..8),
        vec(element(), 1..8),
        vec((0..TICKS, deed()), 0..8),
        any::<bool>(),
        // Last, so that what comes before is as it was for each seed.
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
