//! A search through random scenes for one in which this crate panics, makes a number that is not
//! finite, or leaves something behind.
//!
//! `cargo test --workspace --test attack` runs a few. `cargo test --release --workspace --test attack -- --scenes 100000`
//! is the long search. `--minutes N` ends the search after that time, whatever the number of scenes. `--seed N` starts at
//! another seed than 0. This is a program of its own and not a list of tests, so that it prints its findings as it goes on.
//! It also fails if it met nothing of a kind that it is to judge, such as a snapshot that fits.

use attack::judge::{Met, Verdict, judge};
use attack::plan::{Plan, plans};
use lexopt::prelude::*;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::BTreeMap;
use std::error::Error;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Number of scenes of a short search. A search of fewer scenes, as for one seed, need not meet everything.
const SCENES: u64 = 200;

/// Seeds whose scenes failed once. Every search runs them first.
const ONCE_WRONG: [u64; 15] = [
    7, 503, 2738, 51_601, 505_511, 1_006_820, 1_045_674, 1_064_950, 5_982_261, 7_190_153,
    7_207_433, 7_214_486, 6_451_552, 7_331_730, 7_573_205,
];

/// Number of smaller scenes that are tried for a failing one.
const SHRINKS: usize = 600;

fn main() -> ExitCode {
    match search() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(wrong) => {
            eprintln!("{wrong}\n[--scenes N] [--minutes N] [--seed N]");
            ExitCode::FAILURE
        }
    }
}

/// What the command line asks for.
struct Wishes {
    scenes: u64,
    /// First seed.
    seed: u64,
    /// Time after which no further scene begins.
    time: Option<Duration>,
}

impl Wishes {
    /// Reads the command line. `None` if it asks for other tests than this one.
    fn read() -> Result<Option<Self>, Box<dyn Error>> {
        let (mut scenes, mut seed, mut time) = (None, 0, None);
        let mut words = lexopt::Parser::from_env();
        while let Some(word) = words.next()? {
            match word {
                Long("scenes") => scenes = Some(words.value()?.parse()?),
                Long("seed") => seed = words.value()?.parse()?,
                Long("minutes") => {
                    let minutes: f64 = words.value()?.parse()?;
                    time = Some(Duration::try_from_secs_f64(60.0 * minutes)?);
                }
                // Arguments that Cargo passes to every test program.
                Value(filter) if !"attack".contains(&*filter.to_string_lossy()) => return Ok(None),
                Value(_) | Long("nocapture" | "quiet") | Short('q') => {}
                other => return Err(other.unexpected().into()),
            }
        }
        let most = if time.is_some() { u64::MAX } else { SCENES };
        Ok(Some(Self {
            scenes: scenes.unwrap_or(most),
            seed,
            time,
        }))
    }
}

/// Returns whether no fault of this crate was found, and everything was met that the search is to judge.
fn search() -> Result<bool, Box<dyn Error>> {
    let Some(Wishes { scenes, seed, time }) = Wishes::read()? else {
        println!("attack: filtered out, no scene was run");
        return Ok(true);
    };
    let begin = Instant::now();
    let mut engines = BTreeMap::<String, u64>::new();
    let mut ours = BTreeMap::<String, u64>::new();
    let mut met = Met::default();
    let mut run = 0;
    let new = seed..seed.saturating_add(scenes);
    for seed in ONCE_WRONG.into_iter().chain(new) {
        if time.is_some_and(|time| begin.elapsed() > time) {
            break;
        }
        let mut tree = scene_of(seed)?;
        match judge(&tree.current(), &mut met) {
            Verdict::Sound => {}
            Verdict::Engines(fault) => {
                println!("seed {seed}, a fault of the engine: {}", fault.kind);
                *engines.entry(fault.kind).or_default() += 1;
            }
            Verdict::Ours(fault) => {
                println!("seed {seed}: {fault}");
                let count = ours.entry(fault.kind.clone()).or_default();
                *count += 1;
                if *count == 1 {
                    let smallest = shrink(&mut tree, &fault.kind);
                    println!("as small as can be: {smallest}\n");
                }
            }
        }
        run += 1;
        if run % 1000 == 0 {
            println!("{run} scenes, ours {ours:?}, the engine's {engines:?}");
        }
    }
    println!(
        "{run} scenes, the new ones from seed {seed}: ours {ours:#?}, the engine's {engines:#?}, {met:?}"
    );
    let missing = if run < SCENES {
        Vec::new()
    } else {
        met.missing()
    };
    for name in &missing {
        println!("the search shows too little: {name}");
    }
    Ok(ours.is_empty() && missing.is_empty())
}

/// The scene of a seed, and all smaller ones.
fn scene_of(seed: u64) -> Result<impl ValueTree<Value = Plan>, String> {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let tree = plans().new_tree(&mut runner);
    tree.map_err(|why| format!("seed {seed} gives no scene: {why}"))
}

/// Shrinks a scene while it fails in the same way. Returns the smallest failing scene that was tried, and its verdict.
fn shrink(tree: &mut impl ValueTree<Value = Plan>, wanted: &str) -> String {
    // If no smaller scene fails, the scene itself is shown.
    let mut best = format!("{:#?}", tree.current());
    let mut fails = true;
    for _ in 0..SHRINKS {
        if !(if fails {
            tree.simplify()
        } else {
            tree.complicate()
        }) {
            break;
        }
        let plan = tree.current();
        let verdict = judge(&plan, &mut Met::default());
        fails = matches!(&verdict, Verdict::Ours(fault) if fault.kind == wanted);
        if fails {
            best = format!("{plan:#?}\n{verdict:?}");
        }
    }
    best
}
