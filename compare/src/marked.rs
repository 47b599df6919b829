//! The one table that both the report and `docs/accuracy.md` show.

use std::path::Path;
use std::{fs, io};

const BEGIN: &str = "<!-- speed_vs_error:begin -->";
const END: &str = "<!-- speed_vs_error:end -->";

/// Puts a text between the markers.
pub fn mark(text: &str) -> String {
    format!("{BEGIN}\n{}\n{END}", text.trim())
}

/// The text between the markers, markers included.
pub fn marked(text: &str) -> Option<&str> {
    let from = text.find(BEGIN)?;
    let length = text[from..].find(END)? + END.len();
    Some(&text[from..from + length])
}

/// Replaces the marked text of a file by `new`. Does nothing if there is no file or if it has no markers.
pub fn copy(file: &Path, new: &str) -> io::Result<()> {
    let Ok(text) = fs::read_to_string(file) else {
        return Ok(());
    };
    match marked(&text) {
        Some(old) if old != new => fs::write(file, text.replacen(old, new, 1)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::{mark, marked};

    #[test]
    fn what_is_marked_is_found() {
        let text = format!("before\n{}\nafter", mark("| a |"));
        assert_eq!(marked(&text), Some(mark("| a |").as_str()));
        assert_eq!(marked("nothing"), None);
    }
}
