//! A search through random scenes for one in which this crate panics, makes a number that is not
//! finite, or leaves something behind.
//!
//! `cargo test --workspace --test attack` runs a few. `cargo test --release --workspace --test attack -- --scenes 100000`
//! is the long search. `--seed N` starts at another seed than 0. This is a program of its own and not a list of tests, so
//! that it prints its findings as it goes on.

use attack::judge::{Verdict, judge};
use attack::plan::plans;
use lexopt::prelude::*;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::BTreeMap;
use std::process::ExitCode;

/// Number of scenes of a short search.
const SCENES: u64 = 200;

/// Seeds whose scenes failed once. Every search runs them first.
const ONCE_WRONG: [u64; 8] = [
    7, 503, 2738, 51_601, 505_511, 1_006_820, 1_045_674, 1_064_950,
];

/// Number of smaller scenes that are tried for a failing one.
const SHRINKS: usize = 600;

fn main() -> ExitCode {
    match search() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(wrong) => {
            eprintln!("{wrong}\n[--scenes N] [--seed N]");
            ExitCode::FAILURE
        }
    }
}

/// Returns whether no fault of this crate was found.
fn search() -> Result<bool, lexopt::Error> {
    let (mut scenes, mut seed) = (SCENES, 0_u64);
    let mut words = lexopt::Parser::from_env();
    while let Some(word) = words.next()? {
        match word {
            Long("scenes") => scenes = words.value()?.parse()?,
            Long("seed") => seed = words.value()?.parse()?,
            // Arguments that Cargo passes to every test program.
            Value(filter) if !"attack".contains(&*filter.to_string_lossy()) => return Ok(true),
            Value(_) | Long("nocapture" | "quiet") | Short('q') => {}
            other => return Err(other.unexpected()),
        }
    }
    let mut engines = BTreeMap::<String, u64>::new();
    let mut ours = BTreeMap::<String, u64>::new();
    let seeds = ONCE_WRONG
        .into_iter()
        .chain(seed..seed.saturating_add(scenes));
    for (scene, seed) in (1..).zip(seeds) {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
        let mut runner = TestRunner::new_with_rng(Config::default(), rng);
        let Ok(mut tree) = plans().new_tree(&mut runner) else {
            continue;
        };
        match judge(&tree.current()) {
            Verdict::Sound => {}
            Verdict::Engines(wrong) => *engines.entry(kind(&wrong)).or_default() += 1,
            Verdict::Ours(wrong) => {
                let kind = kind(&wrong);
                let count = ours.entry(kind.clone()).or_default();
                *count += 1;
                println!("seed {seed}: {wrong}");
                if *count > 1 {
                    continue;
                }
                let smallest = shrink(&mut tree, &kind);
                println!("as small as can be: {smallest}\n");
            }
        }
        if scene % 1000 == 0 {
            println!("{scene} scenes, ours {ours:?}, the engine's {engines:?}");
        }
    }
    println!("{scenes} scenes from seed {seed}: ours {ours:#?}, the engine's {engines:#?}");
    Ok(ours.is_empty())
}

/// A failure message without its numbers, to count failures by.
fn kind(wrong: &str) -> String {
    match wrong.find("panicked at ") {
        Some(at) => wrong[at..].chars().take(100).collect(),
        None => wrong
            .split(|c: char| c == ':' || c.is_ascii_digit())
            .map(str::trim)
            .find(|part| part.len() > 6)
            .unwrap_or("not a number")
            .into(),
    }
}

/// Shrinks a scene while it fails in the same way. Returns the smallest failing scene that was tried, and its verdict.
fn shrink(tree: &mut impl ValueTree<Value = attack::plan::Plan>, wanted: &str) -> String {
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
        let verdict = judge(&plan);
        fails = matches!(&verdict, Verdict::Ours(wrong) if kind(wrong) == wanted);
        if fails {
            best = format!("{plan:#?}\n{verdict:?}");
        }
    }
    best
}
