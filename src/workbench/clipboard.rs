//! The system clipboard, or a private clipboard of the workbench if the system has none.

use arboard::Clipboard;
use std::cell::RefCell;

thread_local! {
    /// Handle to the system clipboard. It is kept alive, because on some systems a copied text is lost when it is
    /// dropped.
    static SYSTEM: RefCell<Option<Clipboard>> = const { RefCell::new(None) };
    /// Text that was copied last, if the system clipboard did not take it.
    static OWN: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Copies a text, and returns a message about the result.
pub(super) fn copy(text: String, what: &str) -> String {
    let kept = with_system(|system| system.set_text(text.as_str()));
    let told = match &kept {
        Ok(()) => format!("copied as {what}"),
        Err(wrong) => format!("copied as {what}, for the workbench alone: {wrong}"),
    };
    OWN.set(kept.is_err().then_some(text));
    told
}

/// Returns the text in the private clipboard, or else the text in the system clipboard.
pub(super) fn paste() -> Result<String, String> {
    let own = OWN.with_borrow(Clone::clone);
    own.map_or_else(|| with_system(Clipboard::get_text), Ok)
}

fn with_system<T>(
    act: impl FnOnce(&mut Clipboard) -> Result<T, arboard::Error>,
) -> Result<T, String> {
    // Tests run in parallel, and must not change the user's clipboard.
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
