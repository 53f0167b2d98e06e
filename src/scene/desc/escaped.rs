//! Texts of files in messages.

use std::fmt;

/// A text with its control characters escaped: what a file holds, the names it gives among it, must not steer a terminal.
#[derive(Clone, Copy, Debug)]
pub struct Escaped<'a>(pub &'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for part in self.0.split_inclusive(char::is_control) {
            match part.chars().next_back().filter(|c| c.is_control()) {
                Some(c) => write!(f, "{}{}", &part[..part.len() - c.len_utf8()], c.escape_default())?,
                None => f.write_str(part)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_and_nothing_else() {
        assert_eq!(Escaped("a\u{1b}[2Jé\n").to_string(), "a\\u{1b}[2Jé\\n");
        assert_eq!(Escaped("\u{85}\u{85}").to_string(), "\\u{85}\\u{85}");
        assert_eq!(Escaped("").to_string(), "");
    }
}
