//! Carries out requests of the view that need the world or the system: clock, clipboard and files.

use super::bench::{Ask, Bench};
use super::{CoiloverWorkbench, clipboard};
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, save_to_disk};
use std::path::{Path, PathBuf};

/// Carries out all requests of this frame.
pub(super) fn obey(world: &mut World) {
    let mut bench = world.resource_mut::<Bench>();
    let asks = std::mem::take(&mut bench.asks);
    let title = bench.subject.as_ref().map(|subject| subject.title.clone());
    let title = file_name(&title.unwrap_or_default());
    if asks.is_empty() {
        return;
    }
    let folder = world.resource::<CoiloverWorkbench>().folder.clone();
    for ask in asks {
        let said = match ask {
            Ask::Pause(pause) => {
                if let Some(mut clock) = world.get_resource_mut::<Time<Virtual>>() {
                    if pause {
                        clock.pause();
                    } else {
                        clock.unpause();
                    }
                }
                None
            }
            Ask::Step => {
                step(world);
                None
            }
            Ask::Speed(speed) => {
                if let Some(mut clock) = world.get_resource_mut::<Time<Virtual>>() {
                    clock.set_relative_speed(speed);
                }
                None
            }
            Ask::Copy(text, what) => Some(clipboard::copy(text, what)),
            Ask::Paste => match clipboard::paste() {
                Ok(text) => {
                    world.resource_mut::<Bench>().load("what was copied", &text);
                    None
                }
                Err(wrong) => Some(format!("nothing to paste: {wrong}")),
            },
            Ask::Csv(text) => {
                let file = free(&folder, &title, "csv");
                Some(said(write(&file, &text).map(|()| file)))
            }
            Ask::Picture => {
                let file = free(&folder, &title, "png");
                Some(said(picture(world, file.clone()).map(|()| file)))
            }
            Ask::Save(name, text) => {
                let file = preset(&folder, &name);
                Some(said(write(&file, &text).map(|()| file)))
            }
            Ask::Load(name) => match text_of(&folder, &name) {
                Ok(text) => {
                    world.resource_mut::<Bench>().load(&name, &text);
                    None
                }
                Err(wrong) => Some(format!("{name}: {wrong}")),
            },
        };
        let mut bench = world.resource_mut::<Bench>();
        if said.is_some() {
            bench.message = said;
        }
        bench.presets = presets(&folder);
    }
}

/// Runs one tick in the next frame and leaves the game paused.
fn step(world: &mut World) {
    if let Some(mut clock) = world.get_resource_mut::<Time<Virtual>>() {
        clock.pause();
    }
    if let Some(mut fixed) = world.get_resource_mut::<Time<Fixed>>() {
        let missing = fixed.timestep().saturating_sub(fixed.overstep());
        fixed.accumulate_overstep(missing);
    }
}

fn picture(world: &mut World, file: PathBuf) -> std::io::Result<()> {
    make_folder(&file)?;
    world
        .spawn(Screenshot::primary_window())
        .observe(save_to_disk(file));
    Ok(())
}

fn write(file: &Path, text: &str) -> std::io::Result<()> {
    make_folder(file)?;
    std::fs::write(file, text)
}

fn make_folder(file: &Path) -> std::io::Result<()> {
    file.parent().map_or(Ok(()), std::fs::create_dir_all)
}

fn said(done: std::io::Result<PathBuf>) -> String {
    match done {
        Ok(file) => format!("saved {}", file.display()),
        Err(wrong) => format!("not saved: {wrong}"),
    }
}

/// Turns a title into a file name that is valid on every file system.
fn file_name(title: &str) -> String {
    let fits = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    let name: String = title
        .chars()
        .map(|c| if fits(c) { c } else { '_' })
        .take(60)
        .collect();
    if name.is_empty() {
        "element".into()
    } else {
        name
    }
}

/// Returns the first path `name_1`, `name_2`, … that does not exist.
fn free(folder: &Path, name: &str, ending: &str) -> PathBuf {
    let file = |i: u32| folder.join(format!("{name}_{i}.{ending}"));
    (1..10_000)
        .map(file)
        .find(|file| !file.exists())
        .unwrap_or_else(|| file(10_000))
}

/// Returns the path to which a preset is saved: a RON file if the name ends with `.ron`, else a JSON file.
fn preset(folder: &Path, name: &str) -> PathBuf {
    let (name, ending) = match name.strip_suffix(".ron") {
        Some(name) => (name, "ron"),
        None => (name.strip_suffix(".json").unwrap_or(name), "json"),
    };
    folder
        .join("presets")
        .join(format!("{}.{ending}", file_name(name)))
}

/// Returns the names of the saved presets, sorted.
pub(super) fn presets(folder: &Path) -> Vec<String> {
    saved(folder).into_iter().map(|(name, _)| name).collect()
}

/// Returns the text of a preset with one of these names.
fn text_of(folder: &Path, name: &str) -> std::io::Result<String> {
    let listed = saved(folder).into_iter().find(|(saved, _)| saved == name);
    std::fs::read_to_string(listed.map_or_else(|| preset(folder, name), |(_, file)| file))
}

/// Returns the names and the files of the presets, sorted. A file that a person put there may have a name that the
/// workbench would not give it, such as one with a space.
fn saved(folder: &Path) -> Vec<(String, PathBuf)> {
    let files = std::fs::read_dir(folder.join("presets"));
    let named = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.ok()?.path();
        let file = path.file_name()?.to_str()?;
        let name = match path.extension()?.to_str()? {
            // Without the ending, `a.ron.json` would be named as `a.ron` is.
            "json" => {
                let name = file.strip_suffix(".json").unwrap_or(file);
                if name.ends_with(".ron") { file } else { name }
            }
            "ron" => file,
            _ => return None,
        };
        Some((name.to_owned(), path))
    };
    let mut found: Vec<_> = files.into_iter().flatten().filter_map(named).collect();
    found.sort();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_names_of_files() {
        assert_eq!(file_name("../a b/ü"), "___a_b_ü");
        assert_eq!(file_name(""), "element");
        let folder = Path::new("there_is_no_such_folder");
        assert_eq!(free(folder, "a", "csv"), folder.join("a_1.csv"));
        assert!(presets(folder).is_empty());
        let file = |name| preset(Path::new(""), name);
        assert_eq!(file("a.b"), Path::new("presets/a_b.json"));
        assert_eq!(file("a.json"), Path::new("presets/a.json"));
        assert_eq!(file("../a.ron"), Path::new("presets/___a.ron"));
    }

    #[test]
    fn each_preset_that_is_listed_is_the_one_that_is_loaded() {
        let folder = format!("coilover_presets_{}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        let presets_and_files = [
            ("a.ron", "a.ron"),
            ("a.ron.json", "a.ron.json"),
            ("my soft", "my soft.json"),
            ("v1.2", "v1.2.json"),
            ("v1.2.ron", "v1.2.ron"),
        ];
        let files = presets_and_files.map(|(_, file)| file);
        for file in files.into_iter().chain(["notes.txt"]) {
            let path = folder.join("presets").join(file);
            assert!(write(&path, file).is_ok());
        }
        assert_eq!(presets(&folder), presets_and_files.map(|(name, _)| name));
        for (name, file) in presets_and_files {
            let text = text_of(&folder, name);
            assert_eq!(text.expect("it is listed"), file);
        }
        assert!(text_of(&folder, "v1").is_err());
        assert!(std::fs::remove_dir_all(folder).is_ok());
    }
}
