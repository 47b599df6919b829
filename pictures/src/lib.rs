//! Shared by tests and films: how to run an example.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::time::SystemTime;

/// Returns the root folder of the repository, which contains the examples.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Does `what` for each of the scenes, two at a time, since an example uses one thread. Put those that take longest first.
pub fn two_at_a_time<T: Sync>(scenes: &[T], what: impl Fn(&T) + Sync) {
    let waiting = Mutex::new(scenes.iter());
    let next = || waiting.lock().ok()?.next();
    std::thread::scope(|both| {
        for _ in 0..2 {
            both.spawn(|| {
                while let Some(scene) = next() {
                    what(scene);
                }
            });
        }
    });
}

/// Returns the command that runs an example in the root folder. It uses the program built along with this one if that
/// is newer than all sources. Otherwise it uses cargo, which for a whole workspace would first rebuild Bevy with the
/// features of one package.
pub fn command(scene: &str) -> Command {
    let root = root();
    let mut command = match built(&root, scene) {
        Some(built) => Command::new(built),
        None => {
            let mut cargo = Command::new("cargo");
            cargo.args(["run", "--quiet", "--example", scene, "--"]);
            cargo
        }
    };
    command.current_dir(root);
    command
}

fn built(root: &Path, scene: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    let name = format!("{scene}{}", std::env::consts::EXE_SUFFIX);
    // Tests are in the folder `deps` of their profile, programs beside it.
    let built = program
        .ancestors()
        .skip(1)
        .take(2)
        .map(|folder| folder.join("examples").join(&name))
        .find(|built| built.exists())?;
    let age = built.metadata().ok()?.modified().ok()?;
    // Shaders are compiled in.
    let folders = ["src", "examples", "assets"].map(|folder| newest(&root.join(folder)));
    let sources = folders.into_iter().max().flatten();
    (age >= sources?).then_some(built)
}

/// Returns the time of the last change in a folder.
fn newest(folder: &Path) -> Option<SystemTime> {
    let mut latest = None;
    for entry in std::fs::read_dir(folder).ok()?.flatten() {
        let path = entry.path();
        let time = if path.is_dir() {
            newest(&path)
        } else {
            entry.metadata().ok().and_then(|m| m.modified().ok())
        };
        latest = latest.max(time);
    }
    latest
}
