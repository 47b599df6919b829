//! The clipboard of the system, or where there is none, one of the workbench's own.

use arboard::Clipboard;
use std::cell::RefCell;

thread_local! {
    /// What was copied is there as long as this is.
    static SYSTEM: RefCell<Option<Clipboard>> = const { RefCell::new(None) };
    /// What was copied last, where the system did not take it.
    static OWN: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps a text for other programs, and says what came of it.
pub(super) fn copy(text: String, what: &str) -> String {
    let kept = with_system(|system| system.set_text(text.as_str()));
    let told = match &kept {
        Ok(()) => format!("copied as {what}"),
        Err(wrong) => format!("copied as {what}, for the workbench alone: {wrong}"),
    };
    OWN.set(kept.is_err().then_some(text));
    told
}

/// The text that was copied last, here or in another program.
pub(super) fn paste() -> Result<String, String> {
    let own = OWN.with_borrow(Clone::clone);
    own.map_or_else(|| with_system(Clipboard::get_text), Ok)
}

fn with_system<T>(
    act: impl FnOnce(&mut Clipboard) -> Result<T, arboard::Error>,
) -> Result<T, String> {
    // Tests run side by side, and leave alone what somebody has copied.
    if cfg!(test) {
        return Err("a test has no clipboard".into());
    }
    SYSTEM.with_borrow_mut(|system| {
        if system.is_none() {
            *system = Some(Clipboard::new().map_err(|wrong| wrong.to_string())?);
        }
        match system {
            Some(system) => act(system).map_err(|wrong| wrong.to_string()),
            None => Err("there is no clipboard".into()),
        }
    })
}
