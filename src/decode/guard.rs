//! A fence around decoders that are not ours: damaged files make some of them panic.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread is inside such a decoder. Its panic is caught and told as an error, so that a panic hook has nothing
/// to say about it.
pub fn in_decoder() -> bool {
    INSIDE.get()
}

/// Runs a decoder on this thread; a panic is an error.
pub(super) fn guarded<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    INSIDE.set(true);
    // What a panic leaves half done is dropped with the decoder.
    let result = catch_unwind(AssertUnwindSafe(decode));
    INSIDE.set(false);
    result.unwrap_or_else(|_| Err("its decoder fails on it; the file is damaged, or is hostile".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error() {
        assert_eq!(guarded(|| Ok(7)), Ok(7));
        assert_eq!(guarded(|| Err::<(), _>("no".to_owned())), Err("no".to_owned()));
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !in_decoder() {
                hook(info);
            }
        }));
        let caught = guarded(|| -> Result<(), String> { panic!("as a decoder does") });
        let _ = std::panic::take_hook();
        assert!(caught.unwrap_err().starts_with("its decoder fails on it"));
        assert!(!in_decoder());
    }
}
