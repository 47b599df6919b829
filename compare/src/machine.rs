//! What the times were taken on.

use std::fs;

/// Cores, model and system, without names.
pub fn describe() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let model = field("/proc/cpuinfo", "model name", ':').unwrap_or_else(|| "unknown model".into());
    let system = field("/etc/os-release", "PRETTY_NAME", '=')
        .unwrap_or_else(|| std::env::consts::OS.to_owned());
    let build = if cfg!(debug_assertions) {
        "dev"
    } else {
        "release"
    };
    format!(
        "{cores} cores ({}, {model}), {}, {build} build, one thread",
        std::env::consts::ARCH,
        system.trim_matches('"')
    )
}

/// The first value of a key in a file of key and value lines.
pub fn field(file: &str, key: &str, sign: char) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|l| l.starts_with(key))?;
    Some(line.split_once(sign)?.1.trim().to_owned())
}
