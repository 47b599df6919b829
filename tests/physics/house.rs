//! Does the source stay easy to read? No large import cycles, and no file that is too long.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

fn sources(folder: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    files(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join(folder),
        &mut found,
    );
    found.sort();
    found
}

/// Path of a module in the crate, as a list of names.
fn module(path: &Path) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let path = path.strip_prefix(root).expect("in src").with_extension("");
    let mut names: Vec<_> = path
        .iter()
        .map(|p| p.to_string_lossy().into_owned())
        .collect();
    if names.last().is_some_and(|last| last == "mod") {
        names.pop();
    }
    names
}

/// Modules that the `use` lines of a file name, without the file's own children and without its tests.
fn imports(of: &[String], text: &str, known: &BTreeSet<Vec<String>>) -> BTreeSet<Vec<String>> {
    let text = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or(text);
    let mut found = BTreeSet::new();
    for statement in text.split(';') {
        let Some(at) = statement.rfind("use ").filter(|at| {
            statement[..*at]
                .lines()
                .next_back()
                .is_none_or(|line| line.trim().is_empty() || line.trim_start().starts_with("pub"))
        }) else {
            continue;
        };
        let path = statement[at + 4..].split_whitespace().collect::<String>();
        let (head, names) = match path.split_once("::{") {
            Some((head, names)) => (head, names.trim_end_matches('}')),
            None => (path.as_str(), ""),
        };
        let mut segments: Vec<&str> = head.split("::").collect();
        let mut base = match segments.first() {
            Some(&"crate") => Vec::new(),
            Some(&"super") => of.to_vec(),
            _ => continue,
        };
        while segments.first() == Some(&"super") {
            base.pop();
            segments.remove(0);
        }
        base.extend(
            segments
                .into_iter()
                .filter(|s| *s != "crate")
                .map(str::to_owned),
        );
        for name in names.split(',') {
            let mut target = base.clone();
            target.extend((!name.is_empty()).then(|| name.to_owned()));
            while !target.is_empty() && !known.contains(&target) {
                target.pop();
            }
            if target.len() > 1 && target != of && !target.starts_with(of) {
                found.insert(target);
            }
        }
    }
    found
}

/// Modules that can be reached from a module.
fn reach(
    from: &[String],
    graph: &BTreeMap<Vec<String>, BTreeSet<Vec<String>>>,
) -> BTreeSet<Vec<String>> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from.to_vec()];
    while let Some(next) = open.pop() {
        for target in graph.get(&next).into_iter().flatten() {
            if seen.insert(target.clone()) {
                open.push(target.clone());
            }
        }
    }
    seen
}

#[test]
fn no_more_than_three_files_import_each_other() {
    let paths = sources("src");
    let known: BTreeSet<_> = paths.iter().map(|path| module(path)).collect();
    let graph: BTreeMap<_, _> = paths
        .iter()
        .map(|path| {
            let of = module(path);
            let text = fs::read_to_string(path).expect("readable");
            let imports = imports(&of, &text, &known);
            (of, imports)
        })
        .collect();
    assert!(
        graph.values().any(|imports| imports.len() > 3),
        "imports are found"
    );
    for of in &known {
        let back = |other: &&Vec<String>| *other != of && reach(other, &graph).contains(of);
        let reached = reach(of, &graph);
        let circle: Vec<_> = reached.iter().filter(back).collect();
        assert!(circle.len() < 3, "{of:?} is in a circle with {circle:?}");
    }
}

#[test]
fn one_folder_of_the_physics_names_rapier() {
    for folder in [
        "src/element",
        "src/input",
        "src/scene",
        "src/dynamics",
        "src/backend",
    ] {
        let paths = sources(folder);
        let outside = paths.iter().filter(|path| {
            let module = module(path);
            !module.starts_with(&["backend".to_owned(), "rapier".to_owned()])
        });
        for path in outside {
            let text = fs::read_to_string(path).expect("readable");
            let code = text
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"));
            let named: Vec<_> = code.filter(|line| line.contains("rapier")).collect();
            // Permitted: the lines that list the engines, and the function that tests compare with.
            let only = |line: &&str| {
                line.contains("mod rapier")
                    || line.contains("fn ")
                    || line.contains("rotation::turn")
            };
            assert!(named.iter().all(only), "{path:?}: {named:?}");
        }
    }
}

#[test]
fn no_file_is_longer_than_four_hundred_lines() {
    for folder in [
        "src",
        "tests",
        "examples",
        "benches",
        "compare",
        "attack",
        "authoring",
        "pictures",
    ] {
        for path in sources(folder) {
            let lines = fs::read_to_string(&path).expect("readable").lines().count();
            assert!(lines <= 400, "{path:?} has {lines} lines");
        }
    }
}
