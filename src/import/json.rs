//! A JSON document whose values know where they stand.
//!
//! serde_json's `Value` keeps no positions and merges duplicate keys. Its `RawValue`, however, borrows a slice of the
//! input, so a value's byte offset is known. A [`Node`] is such a slice; objects and arrays are walked one level at a
//! time, only where the scene reader looks. The whole text is checked for syntax once, before the first node exists.

use std::fmt;

use serde::Deserializer as _;
use serde::de::{MapAccess, Visitor};
use serde_json::value::RawValue;

use super::place_in_file;
use crate::scene::desc::{Diagnostic, Escaped, Place};

/// Deepest nesting of arrays and objects that is read.
pub(super) const MAX_DEPTH: usize = 128;

/// Distance in bytes between the positions that are remembered as line and column.
const CHECKPOINT: usize = 1024;

/// Longest excerpt of the file in a message, in characters.
const EXCERPT: usize = 40;

/// The text of a scene file and the map from byte offsets to lines and columns.
pub(super) struct Document<'a> {
    text: &'a str,
    file: &'a str,
    /// Line and column (both from 1) of every `CHECKPOINT`-th byte, so that looking up a place costs the same at the
    /// end of a large file, or of a long line, as at its start.
    checkpoints: Vec<(usize, usize)>,
}

/// A value in the document.
#[derive(Clone, Debug)]
pub(super) struct Node<'a> {
    /// The value as written, without white space around it.
    pub text: &'a str,
    /// Byte offset in the document.
    pub offset: usize,
    /// JSON pointer (RFC 6901).
    pub pointer: String,
}

/// A key and its value in an object.
#[derive(Debug)]
pub(super) struct Entry<'a> {
    /// The key, unescaped.
    pub key: String,
    /// Byte offset of the key in the document.
    pub key_offset: usize,
    /// The value.
    pub value: Node<'a>,
}

/// The types of JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Null,
    Bool,
    Number,
    String,
    Array,
    Object,
}

/// Bytes as text, or the diagnostic that says where they stop being UTF-8.
pub(super) fn decode_utf8<'a>(bytes: &'a [u8], file: &str) -> Result<&'a str, Diagnostic> {
    let error = match std::str::from_utf8(bytes) {
        Ok(text) => return Ok(text),
        Err(error) => error,
    };
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let message = "the file is UTF-16; a scene must be UTF-8 text: save it as UTF-8 without a byte order mark";
        return Err(Diagnostic { at: place_in_file(file, 1, 1), message: message.to_owned() });
    }
    if bytes.contains(&0) {
        let message = "this is a binary file, not a scene; a scene is JSON text";
        return Err(Diagnostic { at: place_in_file(file, 0, 0), message: message.to_owned() });
    }
    let valid = std::str::from_utf8(&bytes[..error.valid_up_to()]).unwrap_or_default();
    let (line, column) = advance((1, 1), valid.as_bytes());
    let byte = bytes[error.valid_up_to()];
    let message = format!("byte 0x{byte:02x} is not UTF-8; a scene must be UTF-8 text");
    Err(Diagnostic { at: place_in_file(file, line, column), message })
}

/// The line and column after `bytes`, which start at `from`.
fn advance(from: (usize, usize), bytes: &[u8]) -> (usize, usize) {
    bytes.iter().fold(from, |(line, column), &byte| match byte {
        b'\n' => (line + 1, 1),
        // A continuation byte belongs to the character before it.
        0x80..=0xbf => (line, column),
        _ => (line, column + 1),
    })
}

impl<'a> Document<'a> {
    /// Checks the syntax of a whole document and returns it with its root.
    pub fn parse(text: &'a str, file: &'a str) -> Result<(Self, Node<'a>), Diagnostic> {
        let mut checkpoints = Vec::with_capacity(text.len() / CHECKPOINT + 1);
        let mut here = (1, 1);
        for chunk in text.as_bytes().chunks(CHECKPOINT) {
            checkpoints.push(here);
            here = advance(here, chunk);
        }
        checkpoints.push(here);
        let document = Self { text, file, checkpoints };
        if text.starts_with('\u{feff}') {
            let message = "the file starts with a byte order mark, which JSON does not allow: save it as UTF-8 without";
            return Err(document.diagnostic(0, message.to_owned()));
        }
        if text.trim_ascii().is_empty() {
            return Err(
                document.diagnostic(0, "the file is empty; expected a JSON object with a \"camera\"".to_owned())
            );
        }
        if let Some(offset) = first_too_deep(text) {
            let message = format!("nested more than {MAX_DEPTH} deep; allowed: at most {MAX_DEPTH} levels");
            return Err(document.diagnostic(offset, message));
        }
        match serde_json::from_str::<&RawValue>(text) {
            Ok(raw) => {
                let root = Node { text: raw.get(), offset: distance(text, raw.get()), pointer: String::new() };
                Ok((document, root))
            }
            Err(error) => Err(document.syntax_error(&error)),
        }
    }

    fn diagnostic(&self, offset: usize, message: String) -> Diagnostic {
        Diagnostic { at: self.place(offset, ""), message }
    }

    /// serde_json's own message, moved to our way of counting columns and completed with what stands there.
    fn syntax_error(&self, error: &serde_json::Error) -> Diagnostic {
        let full = error.to_string();
        let suffix = format!(" at line {} column {}", error.line(), error.column());
        let what = full.strip_suffix(&suffix).unwrap_or(&full);
        if error.is_eof() {
            let message = format!("invalid JSON: {what}: the file ends before the scene does; is it truncated?");
            return self.diagnostic(self.text.len(), message);
        }
        let line_start = match error.line() {
            0 | 1 => 0,
            line => self.text.match_indices('\n').nth(line - 2).map_or(0, |(i, _)| i + 1),
        };
        // Its columns count bytes up to and including the offending one.
        let mut offset = (line_start + error.column().saturating_sub(1)).min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        // What is too much is the comma, which may be on an earlier line than the bracket that shows it.
        if let Some(close @ (b'}' | b']')) = self.text.as_bytes().get(offset) {
            let before = self.text[..offset].trim_ascii_end();
            if before.ends_with(',') {
                let message = format!("invalid JSON: trailing comma before `{}`; delete it", char::from(*close));
                return self.diagnostic(before.len() - 1, message);
            }
        }
        // It may have given up within a word, such as nan: show the whole word.
        let is_word = |b: &u8| b.is_ascii_alphanumeric() || b"+-.".contains(b);
        if self.text.as_bytes().get(offset).is_some_and(is_word) {
            offset -= self.text.as_bytes()[..offset].iter().rev().take_while(|b| is_word(b)).count();
        }
        let what = if what == "expected ident" { "expected value" } else { what };
        let found = self.text[offset..].split(|c: char| c.is_whitespace() || ",]}".contains(c)).next().unwrap_or("");
        let found = if found.is_empty() { self.text[offset..].get(..1).unwrap_or("") } else { found };
        let remedy = match found.trim_start_matches(['+', '-']) {
            word if word.starts_with("//") || word.starts_with("/*") || word.starts_with('#') => {
                "; JSON has no comments: delete it"
            }
            word if word.starts_with('\'') => "; JSON's keys and strings take double quotes (\")",
            word if ["nan", "inf", "infinity"].contains(&word.to_ascii_lowercase().as_str()) => {
                "; JSON has finite numbers only"
            }
            _ => "",
        };
        let message = format!("invalid JSON: {what}, found `{}`{remedy}", printable(found));
        self.diagnostic(offset, message)
    }

    /// The place of a byte offset.
    pub fn place(&self, offset: usize, pointer: &str) -> Place {
        let index = (offset / CHECKPOINT).min(self.checkpoints.len() - 1);
        let until = offset.min(self.text.len());
        let (line, column) = advance(self.checkpoints[index], &self.text.as_bytes()[index * CHECKPOINT..until]);
        Place { file: self.file.to_owned(), line, column, pointer: pointer.to_owned() }
    }
}

/// The offset of the first bracket that opens a level too many.
fn first_too_deep(text: &str) -> Option<usize> {
    let (mut depth, mut in_string, mut escaped) = (0usize, false, false);
    for (offset, byte) in text.bytes().enumerate() {
        if in_string {
            match byte {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' => in_string = false,
                _ => {}
            }
            continue;
        }
        match byte {
            b'"' => in_string = true,
            b'[' | b'{' => {
                depth += 1;
                if depth > MAX_DEPTH {
                    return Some(offset);
                }
            }
            b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    None
}

/// How many bytes into `whole` its slice `part` starts.
fn distance(whole: &str, part: &str) -> usize {
    part.as_ptr() as usize - whole.as_ptr() as usize
}

/// The start of a text, with an ellipsis when something is left off.
pub(super) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(EXCERPT) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// The start of a text with control characters escaped: what a file holds must not steer a terminal.
pub(super) fn printable(text: &str) -> String {
    Escaped(&excerpt(text)).to_string()
}

/// An object's keys and values as slices of the input, duplicates included.
struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = Vec<(&'de RawValue, &'de RawValue)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::with_capacity(map.size_hint().unwrap_or(0));
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(entries)
    }
}

impl<'a> Node<'a> {
    /// The value's type, known from its first byte because the syntax has been checked.
    pub fn kind(&self) -> Kind {
        match self.text.as_bytes().first() {
            Some(b'{') => Kind::Object,
            Some(b'[') => Kind::Array,
            Some(b'"') => Kind::String,
            Some(b't' | b'f') => Kind::Bool,
            Some(b'n') => Kind::Null,
            _ => Kind::Number,
        }
    }

    /// The value for a message.
    pub fn describe(&self) -> String {
        match self.kind() {
            Kind::Null | Kind::Bool => self.text.to_owned(),
            Kind::Number => format!("the number {}", excerpt(self.text)),
            Kind::String => format!("the string {}", excerpt(self.text)),
            Kind::Array => match self.elements().len() {
                0 => "an empty array".to_owned(),
                n => format!("an array of {n}"),
            },
            Kind::Object => "an object".to_owned(),
        }
    }

    /// An array's elements; none for other types.
    pub fn elements(&self) -> Vec<Node<'a>> {
        // The syntax has been checked, so that the only error left is that this is no array.
        let raw: Vec<&'a RawValue> = serde_json::from_str(self.text).unwrap_or_default();
        raw.into_iter().enumerate().map(|(i, raw)| self.child(raw, &i.to_string())).collect()
    }

    /// An object's entries in file order, duplicates included.
    ///
    /// # Errors
    /// The offset and text of a key that is no valid string (an escaped half of a surrogate pair).
    pub fn entries(&self) -> Result<Vec<Entry<'a>>, (usize, String)> {
        let mut deserializer = serde_json::Deserializer::from_str(self.text);
        let raw = deserializer.deserialize_map(Entries).unwrap_or_default();
        raw.into_iter()
            .map(|(key, value)| {
                let key_offset = self.offset + distance(self.text, key.get());
                let key: String = serde_json::from_str(key.get()).map_err(|_| (key_offset, key.get().to_owned()))?;
                let value = self.child(value, &key);
                Ok(Entry { key, key_offset, value })
            })
            .collect()
    }

    /// A string's content, unescaped; `None` for other types and for invalid escapes.
    pub fn string(&self) -> Option<String> {
        serde_json::from_str(self.text).ok()
    }

    /// The JSON pointer of the child called `token`.
    pub fn pointer_to(&self, token: &str) -> String {
        format!("{}/{}", self.pointer, token.replace('~', "~0").replace('/', "~1"))
    }

    fn child(&self, raw: &'a RawValue, token: &str) -> Node<'a> {
        let text = raw.get();
        Node { text, offset: self.offset + distance(self.text, text), pointer: self.pointer_to(token) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(text: &str) -> Node<'_> {
        Document::parse(text, "t.json").unwrap().1
    }

    fn error(text: &str) -> String {
        Document::parse(text, "t.json").err().unwrap().to_string()
    }

    #[test]
    fn children_know_their_offset_and_pointer() {
        let text = " {\n  \"a/b\": [1, {\"~\": true}],\n \"c\": \"é\", \"d\" : null }\n";
        let (document, root) = Document::parse(text, "t.json").unwrap();
        let entries = root.entries().unwrap();
        assert_eq!(entries.iter().map(|e| e.key.as_str()).collect::<Vec<_>>(), ["a/b", "c", "d"]);
        let deep = &entries[0].value.elements()[1].entries().unwrap()[0];
        assert_eq!((deep.value.text, deep.value.pointer.as_str()), ("true", "/a~1b/1/~0"));
        assert_eq!(&text[deep.value.offset..][..4], "true");
        assert_eq!(&text[deep.key_offset..][..3], "\"~\"");
        // Columns count characters: é before "d" is one column and two bytes.
        let place = document.place(entries[2].value.offset, "");
        assert_eq!((place.line, place.column), (3, 18));
    }

    #[test]
    fn duplicate_keys_are_seen() {
        let entries = root(r#"{"a":1,"b":2,"a":3}"#).entries().unwrap();
        assert_eq!(
            entries.iter().map(|e| (e.key.as_str(), e.value.text)).collect::<Vec<_>>(),
            [("a", "1"), ("b", "2"), ("a", "3")]
        );
    }

    #[test]
    fn a_lone_surrogate_in_a_key_is_located() {
        assert_eq!(root(r#"{"a":1, "\ud800":2}"#).entries().unwrap_err(), (8, r#""\ud800""#.to_owned()));
    }

    #[test]
    fn places_agree_with_a_plain_count_across_checkpoints() {
        let mut text = "[".to_owned();
        for i in 0..2000 {
            text.push_str(if i % 97 == 0 { "\"ü\",\n" } else { "\"aü\", " });
        }
        text.push_str("0]");
        let (document, _) = Document::parse(&text, "t.json").unwrap();
        for (offset, _) in text.char_indices() {
            let before = &text[..offset];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap().chars().count() + 1;
            let place = document.place(offset, "");
            assert_eq!((place.line, place.column), (line, column), "offset {offset}");
        }
    }

    #[test]
    fn nesting_is_limited_and_brackets_in_strings_do_not_count() {
        let nested = |n: usize| format!("{}{}", "[".repeat(n), "]".repeat(n));
        assert!(Document::parse(&nested(MAX_DEPTH), "t").is_ok());
        assert!(error(&nested(MAX_DEPTH + 1)).starts_with("t.json:1:129: nested more than 128 deep"));
        assert!(Document::parse(&format!("\"\\\"{}\"", "[".repeat(500)), "t").is_ok());
    }
}
