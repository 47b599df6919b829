//! Tests that the command works, and that the repository's tables and reports are up to date.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const BEGIN: &str = "<!-- speed_vs_error:begin -->";
const END: &str = "<!-- speed_vs_error:end -->";

/// Rounding errors of single precision, m, by which two builds may differ.
const FLOOR: f64 = 5e-5;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text between the markers.
fn marked(text: &str) -> &str {
    let (_, rest) = text.split_once(BEGIN).expect("a first marker");
    rest.split_once(END).expect("a last marker").0.trim()
}

/// Largest error of every setting in a table. Infinite if it diverged.
fn errors(table: &str) -> HashMap<String, f64> {
    table
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let error = if cells[6] == "1" {
                f64::INFINITY
            } else {
                cells[3].parse().expect("an error")
            };
            (cells[..3].join(","), error)
        })
        .collect()
}

#[test]
fn the_quick_command_works_and_finds_what_the_tables_tell() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("smoke");
    let _ = fs::remove_dir_all(&out);
    fs::create_dir_all(&out).expect("a folder");
    fs::create_dir_all(out.join("docs")).expect("a folder");
    fs::write(
        out.join("docs/accuracy.md"),
        format!("a\n{BEGIN}\n{END}\nb\n"),
    )
    .expect("a file");
    let scenes = ["oscillator", "pendulum-soft"];
    let status = Command::new(env!("CARGO_BIN_EXE_compare"))
        .args(["--quick", "--scene", scenes[0], "--scene", scenes[1]])
        .arg("--out")
        .arg(&out)
        .status()
        .expect("it runs");
    assert!(status.success());
    let report = read(&out.join("docs/speed_vs_error.md"));
    let copied = read(&out.join("docs/accuracy.md"));
    assert!(marked(&report).contains("| Single oscillator |"));
    assert_eq!(marked(&report), marked(&copied));
    for scene in scenes {
        let file = |ending: &str| format!("docs/speed_vs_error/{scene}.{ending}");
        assert!(read(&out.join(file("svg"))).contains("</svg>"));
        let told = errors(&read(&repository().join(file("csv"))));
        let found = errors(&read(&out.join(file("csv"))));
        assert!(!found.is_empty());
        for (setting, found) in found {
            let told = told
                .get(&setting)
                .unwrap_or_else(|| panic!("{scene}: no {setting} in the repository's table"));
            let alike =
                found == *told || (found <= 1.5 * told + FLOOR && *told <= 1.5 * found + FLOOR);
            assert!(
                alike,
                "{scene}, {setting}: error {found:e} m, the table says {told:e} m; run `cargo run --release -p \
                 compare -- --fresh` and commit what it writes"
            );
        }
    }
}

/// Runs the quick scenes with contacts and joints, with the springs of this crate.
#[test]
fn on_the_ground_loads_stand_at_their_height_and_nothing_is_won() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("smoke-ground");
    let _ = fs::remove_dir_all(&out);
    fs::create_dir_all(&out).expect("a folder");
    let status = Command::new(env!("CARGO_BIN_EXE_compare"))
        .args(["--quick", "--scene", "ground", "--method", "ours"])
        .arg("--out")
        .arg(&out)
        .status()
        .expect("it runs");
    assert!(status.success());
    let report = read(&out.join("docs/speed_vs_error.md"));
    assert!(report.contains("## On the ground and on joints"));
    let table = read(&out.join("docs/speed_vs_error/ground.csv"));
    let figure = |scene: &str| -> f64 {
        let line = table.lines().find(|l| l.starts_with(scene));
        let cell = line.and_then(|l| l.split(',').nth(4));
        cell.and_then(|c| c.parse().ok()).expect("a figure")
    };
    assert!((figure("rolling-wheel") - 1.0).abs() < 0.03, "{table}");
    assert!(figure("dropped-foot") < 1.02, "{table}");
    assert!(figure("ragdoll") < 1.02, "{table}");
    assert!(figure("wall") < 1e-3, "{table}");
}

#[test]
fn the_page_on_accuracy_tells_what_the_report_tells() {
    let report = read(&repository().join("docs/speed_vs_error.md"));
    let copied = read(&repository().join("docs/accuracy.md"));
    assert_eq!(marked(&report), marked(&copied));
    assert!(marked(&copied).lines().count() > 8);
}

/// The report without the line on the machine, which tells of the one that writes it.
fn without_machine(report: &str) -> Vec<&str> {
    let lines = report.lines();
    lines
        .filter(|line| !line.starts_with("- **Machine.**"))
        .collect()
}

#[test]
fn the_report_is_what_the_code_makes_of_the_tables() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("smoke-report");
    let _ = fs::remove_dir_all(&out);
    let copies = out.join("docs/speed_vs_error");
    fs::create_dir_all(&copies).expect("a folder");
    let tables = repository().join("docs/speed_vs_error");
    for entry in fs::read_dir(tables).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|ending| ending == "csv") {
            let name = path.file_name().expect("a name");
            fs::copy(&path, copies.join(name)).expect("a copy");
        }
    }
    let status = Command::new(env!("CARGO_BIN_EXE_compare"))
        .arg("--report")
        .arg("--out")
        .arg(&out)
        .status()
        .expect("it runs");
    assert!(status.success());
    let made = read(&out.join("docs/speed_vs_error.md"));
    let stored = read(&repository().join("docs/speed_vs_error.md"));
    let (made, stored) = (without_machine(&made), without_machine(&stored));
    for (made, stored) in made.iter().zip(&stored) {
        assert_eq!(
            made, stored,
            "run `cargo run --release -p compare -- --report` and commit what it writes"
        );
    }
    assert_eq!(made.len(), stored.len());
}
