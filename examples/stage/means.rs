//! Finds out how the machine can show an example: in a window, as frames, or as read-outs.

use super::offscreen::adapter;
use std::fmt;
use std::path::PathBuf;

/// Which frames to keep.
pub enum Film {
    /// Several over the whole time, numbered, in a folder.
    Frames(PathBuf),
    /// All of the last seconds, numbered, in a folder.
    Last(PathBuf),
    /// The last frame.
    Still(PathBuf),
}

/// How an example is shown, with the reason for the message.
pub enum Means {
    Window,
    Film {
        film: Film,
        adapter: String,
        why: String,
    },
    Headless(String),
}

impl fmt::Display for Means {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Means::Window => write!(f, "opening a window"),
            Means::Film { film, adapter, why } => {
                let place = match film {
                    Film::Frames(folder) => format!("frames into {}", folder.display()),
                    Film::Last(folder) => format!("its last seconds into {}", folder.display()),
                    Film::Still(file) => format!("a picture into {}", file.display()),
                };
                write!(f, "rendering {place} with {adapter}, because {why}")
            }
            Means::Headless(why) => write!(f, "read-outs only, because {why}"),
        }
    }
}

impl Means {
    /// Returns the best that the machine offers: window, frames, or read-outs.
    pub fn find(headless: bool, asked: Option<Film>) -> Self {
        if headless {
            return Means::Headless("--headless was given".into());
        }
        let unasked = asked.is_none();
        let film = asked.unwrap_or(Film::Frames("renders".into()));
        let no_display = match display() {
            Ok(()) if unasked => {
                return match adapter() {
                    Some(_) => Means::Window,
                    None => Means::Headless("there is a display but no graphics adapter".into()),
                };
            }
            Ok(()) => "that was asked for".into(),
            Err(why) => why,
        };
        match adapter() {
            Some(adapter) => Means::Film {
                film,
                adapter,
                why: no_display,
            },
            None => Means::Headless(format!(
                "{no_display}, and there is no Vulkan, Metal or DirectX adapter"
            )),
        }
    }
}

/// Checks whether a window can be opened. Returns the reason if not.
fn display() -> Result<(), String> {
    if cfg!(not(all(unix, not(target_os = "macos")))) {
        return Ok(());
    }
    let name = std::env::var("DISPLAY").unwrap_or_default();
    let Some((host, number)) = name.rsplit_once(':') else {
        return Err("there is no display (DISPLAY is not set; these examples speak X11)".into());
    };
    let number = number.split('.').next().unwrap_or_default();
    #[cfg(unix)]
    if host.is_empty() {
        let socket = format!("/tmp/.X11-unix/X{number}");
        return std::os::unix::net::UnixStream::connect(&socket)
            .map(drop)
            .map_err(|e| format!("display {name} does not answer ({e})"));
    }
    let _ = (host, number);
    Ok(())
}
