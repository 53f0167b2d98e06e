//! What a panic means here.

use twinlight::decode::in_decoder;

/// libFuzzer's hook aborts at once; what the program catches by itself is no finding.
pub fn set() {
    let abort = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !in_decoder() {
            abort(info);
        }
    }));
}
