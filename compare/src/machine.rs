//! Describes the machine that runs this program.

use std::fs;

/// Number of cores, processor model, system and build, without host or user names.
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

/// The value of the first line that starts with `key`, in a file of lines with key, `sign` and value.
pub fn field(file: &str, key: &str, sign: char) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|l| l.starts_with(key))?;
    Some(line.split_once(sign)?.1.trim().to_owned())
}
