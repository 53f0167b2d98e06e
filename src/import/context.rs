//! What the readers of a scene share: the document, the diagnostics found so far, and how objects are checked.
//!
//! A reader that meets an error reports it here and returns `None`; its caller carries on with the next value, so that
//! one run shows all the mistakes of a file.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::json::{Document, Entry, Kind, Node, excerpt};
use super::synonyms::translated;
use super::textures::Textures;
use crate::scene::desc::{Diagnostic, Place, SceneError};

/// Diagnostics kept; a file with more is told how many were left off.
const MAX_DIAGNOSTICS: usize = 100;

/// dirt's ways to fill a camera or a surface with a medium.
const MEDIA_KEYS: &[&str] = &["medium", "medium_interface", "interior_medium", "exterior_medium"];

/// The state of reading one scene file.
pub(super) struct Context<'a> {
    document: Document<'a>,
    /// Where the files named by the scene lie.
    pub base_dir: &'a Path,
    /// Bytes that meshes may take, and do so far.
    pub memory: [u64; 2],
    /// The textures read so far.
    pub textures: Textures<'a>,
    /// What the reader should know but need not mend, with the offset it belongs to.
    notes: Vec<(usize, String)>,
    /// Diagnostics with the offset in the scene file that they belong to.
    diagnostics: Vec<(usize, Diagnostic)>,
    left_off: usize,
    /// The names of materials and textures, by kind, with the offsets at which they are defined: also of those not yet read.
    declared: HashMap<(&'static str, String), usize>,
    /// Keys that are missing but have been told of by an unknown key near them, with their object's offset.
    misspelt: HashSet<(usize, String)>,
}

/// The keys an object may have.
#[derive(Clone, Copy)]
pub(super) struct Keys<'k> {
    /// Those that can change something: messages list them.
    pub allowed: &'k [&'k str],
    /// Those that are read but ignored, or an error of their own: nothing to advise anyone.
    pub idle: &'k [&'k str],
    /// Those that the format has and that are not supported yet.
    pub later: &'k [&'k str],
}

impl<'k> Keys<'k> {
    /// These keys and no others.
    pub fn only(allowed: &'k [&'k str]) -> Self {
        Self { allowed, idle: &[], later: &[] }
    }
}

/// What an object's `type` says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    /// This type; or the one that was surely meant, the slip being reported.
    Known(&'static str),
    /// It is missing (which is not reported yet), or nothing like any type (which is).
    Unknown,
    /// A type that is not supported yet, as has been reported: nothing is known about its keys.
    Later,
}

/// An object of the document, without duplicate keys.
pub(super) struct Object<'a> {
    /// The object itself.
    pub node: Node<'a>,
    entries: Vec<Entry<'a>>,
}

impl<'a> Object<'a> {
    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&Node<'a>> {
        self.entries.iter().find(|e| e.key == key).map(|e| &e.value)
    }

    /// Whether there is no key at all.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Whether a key is present.
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }
}

impl<'a> Context<'a> {
    /// A reader of a document whose file names are relative to `base_dir`, and whose meshes may take so many bytes.
    pub fn new(document: Document<'a>, base_dir: &'a Path, memory: u64) -> Self {
        Self {
            document,
            base_dir,
            memory: [memory, 0],
            textures: Textures::default(),
            notes: Vec::new(),
            diagnostics: Vec::new(),
            left_off: 0,
            declared: HashMap::new(),
            misspelt: HashSet::new(),
        }
    }

    /// Notes the names that the elements of an array define.
    pub fn declare(&mut self, kind: &'static str, nodes: &[Node<'a>]) {
        for node in nodes {
            let name = node.entries().unwrap_or_default().into_iter().find(|entry| entry.key == "name");
            if let Some((name, offset)) = name.and_then(|entry| Some((entry.value.string()?, entry.value.offset))) {
                self.declared.entry((kind, name)).or_insert(offset);
            }
        }
    }

    /// What is to be said of a name that is used before the line that defines it, if one does.
    pub fn defined_below(&self, kind: &'static str, name: &str, node: &Node<'a>) -> Option<String> {
        let offset = *self.declared.get(&(kind, name.to_owned()))?;
        let line = self.document.place(offset, "").line;
        (offset > node.offset).then(|| {
            format!(
                "the {kind} {:?} is defined below, on line {line}; move it before what is made of it",
                excerpt(name)
            )
        })
    }

    /// Ends reading: everything found wrong or, if nothing is, the notes; both in file order.
    pub fn finish(mut self) -> Result<Vec<String>, SceneError> {
        if self.diagnostics.is_empty() {
            self.notes.sort_by_key(|(offset, _)| *offset);
            return Ok(self.notes.into_iter().map(|(_, note)| note).collect());
        }
        self.diagnostics.sort_by_key(|(offset, _)| *offset);
        let mut diagnostics: Vec<Diagnostic> = self.diagnostics.into_iter().map(|(_, d)| d).collect();
        if self.left_off > 0 {
            let at = Place { line: 0, ..self.document.place(0, "") };
            diagnostics.push(Diagnostic { at, message: format!("{} more errors are not shown", self.left_off) });
        }
        Err(SceneError { diagnostics })
    }

    /// The place of a value.
    pub fn place(&self, node: &Node<'_>) -> Place {
        self.document.place(node.offset, &node.pointer)
    }

    /// Reports an error at a value.
    pub fn error(&mut self, node: &Node<'_>, message: impl Into<String>) {
        let at = self.place(node);
        self.push(node.offset, Diagnostic { at, message: message.into() });
    }

    /// Reports an error in a file that a value of the scene names.
    pub fn error_in_asset(&mut self, node: &Node<'_>, at: Place, message: String) {
        self.push(node.offset, Diagnostic { at, message });
    }

    fn push(&mut self, offset: usize, diagnostic: Diagnostic) {
        if self.diagnostics.len() < MAX_DIAGNOSTICS {
            self.diagnostics.push((offset, diagnostic));
        } else {
            self.left_off += 1;
        }
    }

    /// Records something about a value that needs no mending.
    pub fn note(&mut self, node: &Node<'_>, message: &str) {
        let at = self.place(node);
        self.notes.push((node.offset, format!("{at}: {message}")));
    }

    /// Reports a value of the wrong type.
    pub fn wrong_type(&mut self, node: &Node<'_>, expected: &str) {
        let found = node.describe();
        self.error(node, format!("expected {expected}, found {found}"));
    }

    /// Reads an object and reports its duplicate keys.
    pub fn object(&mut self, node: &Node<'a>, expected: &str) -> Option<Object<'a>> {
        if node.kind() != Kind::Object {
            self.wrong_type(node, expected);
            return None;
        }
        let all = match node.entries() {
            Ok(all) => all,
            Err((offset, key)) => {
                let message = format!("the key {} is not a valid string", excerpt(&key));
                self.error(&Node { offset, ..node.clone() }, message);
                return None;
            }
        };
        let mut entries: Vec<Entry<'a>> = Vec::with_capacity(all.len());
        for entry in all {
            match entries.iter().find(|e| e.key == entry.key) {
                Some(first) => {
                    let at = self.document.place(first.key_offset, "");
                    let message = format!("duplicate key {:?}; it is already given on line {}", entry.key, at.line);
                    self.error(&Node { offset: entry.key_offset, ..entry.value }, message);
                }
                None => entries.push(entry),
            }
        }
        Some(Object { node: node.clone(), entries })
    }

    /// Reads the elements of an array.
    pub fn array(&mut self, node: &Node<'a>, expected: &str) -> Option<Vec<Node<'a>>> {
        if node.kind() == Kind::Array {
            return Some(node.elements());
        }
        self.wrong_type(node, expected);
        None
    }

    /// Reports keys that are not allowed. To be called before `required`, which does not report what a slip in a key's
    /// name explains.
    pub fn check_keys(&mut self, object: &Object<'a>, keys: &Keys<'_>) {
        let known = || keys.allowed.iter().chain(keys.idle).copied();
        for entry in &object.entries {
            let key = entry.key.as_str();
            if known().any(|k| k == key) {
                continue;
            }
            let allowed = list(keys.allowed);
            let message = if MEDIA_KEYS.contains(&key) {
                format!("{key:?}: participating media are not supported; supported here: {allowed}")
            } else if keys.later.contains(&key) {
                format!("{key:?} is not supported yet; supported here: {allowed}")
            } else {
                // A key that is not there yet is what was meant, rather than one that is.
                let absent: Vec<&str> = known().filter(|k| !object.has(k)).collect();
                let all: Vec<&str> = known().collect();
                let meant = translated(key, &absent).or_else(|| nearest(key, &absent));
                if let Some(meant) = meant {
                    self.misspelt.insert((object.node.offset, meant.to_owned()));
                }
                let hint = did_you_mean(meant.or_else(|| translated(key, &all)).or_else(|| nearest(key, &all)));
                format!("unknown key {:?};{hint} allowed: {allowed}", excerpt(key))
            };
            self.error(&Node { offset: entry.key_offset, ..entry.value.clone() }, message);
        }
    }

    /// Whether a key is missing, and `check_keys` has not told of it as a slip in another key's name.
    pub fn is_untold(&self, object: &Object<'a>, key: &str) -> bool {
        !object.has(key) && !self.misspelt.contains(&(object.node.offset, key.to_owned()))
    }

    /// The value of a key that must be there.
    pub fn required<'o>(&mut self, object: &'o Object<'a>, key: &str) -> Option<&'o Node<'a>> {
        if self.is_untold(object, key) {
            self.error(&object.node, format!("{key:?} is missing"));
        }
        object.get(key)
    }

    /// Reads a string that must be one of `supported`; `later` are the format's words for what is not built yet. A slip
    /// is reported and read as what it is near to, so that what depends on the word is checked all the same.
    pub fn choice(
        &mut self,
        node: &Node<'a>,
        what: &str,
        supported: &[&'static str],
        later: &[&str],
    ) -> Option<&'static str> {
        let word = self.string(node)?;
        if let Some(&found) = supported.iter().find(|&&s| s == word) {
            return Some(found);
        }
        if later.contains(&word.as_str()) {
            self.error(node, format!("{what} {word:?} is not supported yet; supported: {}", list(supported)));
            return None;
        }
        let meant = translated(&word, supported).or_else(|| nearest(&word, supported));
        let (shown, hint) = (excerpt(&word), did_you_mean(meant));
        self.error(node, format!("unknown {what} {shown:?};{hint} allowed: {}", list(supported)));
        supported.iter().copied().find(|&s| Some(s) == meant)
    }

    /// An object's `type`. That it is missing is left to `required`, once the keys have been checked.
    pub fn type_of(&mut self, object: &Object<'a>, what: &str, supported: &[&'static str], later: &[&str]) -> Type {
        let Some(node) = object.get("type") else { return Type::Unknown };
        match self.choice(node, what, supported, later) {
            Some(found) => Type::Known(found),
            None if node.kind() == Kind::String && node.string().is_some_and(|s| later.contains(&s.as_str())) => {
                Type::Later
            }
            None => Type::Unknown,
        }
    }
}

/// Words as `a, b, c`.
pub(super) fn list<S: AsRef<str>>(words: &[S]) -> String {
    words.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ")
}

/// The candidate nearest to a word, or `None` when none is near.
pub(super) fn nearest<'c, S: AsRef<str>>(word: &str, candidates: &'c [S]) -> Option<&'c str> {
    // A third of the letters may be wrong: enough for a slip, too few to turn one word into another.
    let limit = (word.chars().count() / 3).max(1);
    candidates
        .iter()
        .map(|c| (edit_distance(word, c.as_ref()), c.as_ref()))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
}

/// ` did you mean "x"?`, or nothing when nothing is near.
pub(super) fn did_you_mean(meant: Option<&str>) -> String {
    meant.map_or_else(String::new, |meant| format!(" did you mean {meant:?}?"))
}

/// Levenshtein's distance, ignoring case; a swap of two neighbours counts once (optimal string alignment).
fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().take(64).collect();
    let b: Vec<char> = b.to_lowercase().chars().take(64).collect();
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let change = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = change.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggestions_are_near() {
        let keys = ["albedo", "name", "type", "two_sided"];
        for (word, meant) in [("albdeo", Some("albedo")), ("Type", Some("type")), ("twosided", Some("two_sided"))] {
            assert_eq!(nearest(word, &keys), meant);
        }
        assert_eq!(nearest("roughness", &keys), None);
        assert_eq!(did_you_mean(Some("type")), " did you mean \"type\"?");
    }

    #[test]
    fn edit_distances() {
        for (a, b, d) in [("", "abc", 3), ("abc", "abc", 0), ("abc", "acb", 1), ("kitten", "sitting", 3)] {
            assert_eq!(edit_distance(a, b), d, "{a} {b}");
            assert_eq!(edit_distance(b, a), d, "{b} {a}");
        }
    }
}
