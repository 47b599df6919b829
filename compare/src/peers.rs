//! Reports what the scripts in `compare/peers` have measured with engines that run outside this process.

use crate::front::find;
use crate::method::{Dial, Method, Setting};
use crate::scenes::Scene;
use crate::table::Row;
use crate::words::digits;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// One line of `peers.csv`.
struct Peer {
    /// Names of the engine and of its setting.
    name: [String; 2],
    scene: String,
    rate: u32,
    /// Largest error, m. `None` if the engine diverged.
    error: Option<f64>,
}

impl Peer {
    fn parse(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        let [engine, setting, scene, rate, error, diverged, _] = cells.as_slice() else {
            return None;
        };
        let error = error.parse::<f64>().ok();
        let error = error.filter(|error| *diverged == "0" && error.is_finite());
        Some(Self {
            name: [engine, setting].map(|name| (*name).to_owned()),
            scene: (*scene).to_owned(),
            rate: rate.parse().ok()?,
            error,
        })
    }
}

fn millimetres(error: Option<f64>) -> String {
    error.map_or("diverges".into(), |error| digits(1e3 * error))
}

/// Tables with the errors of the other engines and of bevy_coilover at 60 and 240 steps per second. Empty if
/// there is no `peers.csv`.
pub fn section(folder: &Path, scenes: &[(&Scene, Vec<Row>)]) -> String {
    let Ok(csv) = fs::read_to_string(folder.join("peers.csv")) else {
        return String::new();
    };
    let peers: Vec<Peer> = csv.lines().skip(1).filter_map(Peer::parse).collect();
    let told: BTreeSet<&str> = peers.iter().map(|p| p.scene.as_str()).collect();
    let scenes: Vec<_> = scenes
        .iter()
        .filter(|(scene, _)| told.contains(scene.name))
        .collect();
    let mut text = String::from(
        "## Engines outside of Bevy\n\nMeasured by `compare/peers/run`, on the same scenes of points, with the same \
         stiffness and damping: MuJoCo's spatial tendon, Exudyn's spring-damper, Jolt's distance constraint (in \
         WebAssembly), Box3D's distance joint, springs between Newton's particles, and edges of the soft bodies that newer \
         versions of Rapier have. Box3D and Rapier state a spring as a frequency and a damping ratio, which are worked out \
         from stiffness, damping and masses. Each engine runs in its own language, so their times, in `speed_vs_error/peers.csv`, are \
         not comparable with those above. Their errors are: largest distance from the truth, in millimetres. \
         An engine that diverges or gives up is said to diverge; a dash means that it was not run.\n\n",
    );
    for rate in [60, 240] {
        let _ = write!(text, "At {rate} steps a second:\n\n| engine | setting |");
        for (scene, _) in &scenes {
            let _ = write!(text, " {} |", scene.title);
        }
        let _ = writeln!(text, "\n|---|---|{}", "---|".repeat(scenes.len()));
        for dial in [Method::Ours.default_dial(), Dial::Extrapolated(1)] {
            let setting = Setting {
                method: Method::Ours,
                dial,
                rate,
            };
            let _ = write!(text, "| **{}** | {dial} |", Method::Ours.title());
            for (_, rows) in &scenes {
                let row = find(rows, setting);
                let cell = row.map_or("–".into(), |row| {
                    millimetres(Some(row.strayed.error).filter(|_| !row.strayed.diverged))
                });
                let _ = write!(text, " {cell} |");
            }
            text.push('\n');
        }
        let mut names: Vec<&[String; 2]> = Vec::new();
        for peer in peers.iter().filter(|p| p.rate == rate) {
            if !names.contains(&&peer.name) {
                names.push(&peer.name);
            }
        }
        for name in names {
            let _ = write!(text, "| {} | {} |", name[0], name[1]);
            for (scene, _) in &scenes {
                let peer = peers
                    .iter()
                    .find(|p| p.name == *name && p.rate == rate && p.scene == scene.name);
                let cell = peer.map_or("–".into(), |peer| millimetres(peer.error));
                let _ = write!(text, " {cell} |");
            }
            text.push('\n');
        }
        text.push('\n');
    }
    text
}
