//! The header of a PLY file: which elements, how many of each, and what properties they have.

use super::scan::{MeshError, Scanned, Scanner, show};
use crate::scene::desc::Escaped;

/// How the elements are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The scalar types, each by its width in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    Int(u8),
    Uint(u8),
    Float(u8),
}

impl Scalar {
    /// Size in a binary file.
    pub fn bytes(self) -> usize {
        match self {
            Self::Int(n) | Self::Uint(n) | Self::Float(n) => usize::from(n),
        }
    }

    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::Int(1),
            b"short" | b"int16" => Self::Int(2),
            b"int" | b"int32" => Self::Int(4),
            b"uchar" | b"uint8" => Self::Uint(1),
            b"ushort" | b"uint16" => Self::Uint(2),
            b"uint" | b"uint32" => Self::Uint(4),
            b"float" | b"float32" => Self::Float(4),
            b"double" | b"float64" => Self::Float(8),
            _ => return None,
        })
    }
}

/// A property of an element.
#[derive(Debug)]
pub(super) struct Property {
    /// Its name.
    pub name: String,
    /// The type of its value, or of a list's items.
    pub scalar: Scalar,
    /// For a list, the type of its length.
    pub list: Option<Scalar>,
}

/// A kind of element.
#[derive(Debug)]
pub(super) struct Element {
    /// Its name.
    pub name: String,
    /// How many there are.
    pub count: usize,
    /// What each has, in order.
    pub properties: Vec<Property>,
}

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    /// How the elements are written.
    pub encoding: Encoding,
    /// The elements in file order.
    pub elements: Vec<Element>,
    /// Offset of the first byte after the header.
    pub data: usize,
    /// Line of that byte, from 1.
    pub data_line: usize,
}

/// Reads the header and checks its counts against the size of the file, before anything is allocated for them.
pub(super) fn parse(bytes: &[u8]) -> Scanned<Header> {
    let mut s = Scanner::new(bytes, 0, 1);
    if s.word() != b"ply" {
        return s.error("not a PLY file: the first line must be `ply`");
    }
    s.next_line();
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        if s.at_end() {
            return s.error("the header has no `end_header`; is the file truncated?");
        }
        let keyword = s.word();
        match keyword {
            b"comment" | b"obj_info" | b"" => {}
            b"format" => encoding = Some(format(&mut s)?),
            b"element" => {
                let element = element(&mut s)?;
                if elements.iter().any(|e| e.name == element.name) {
                    return s.error(format!("duplicate element `{}`", show(element.name.as_bytes())));
                }
                elements.push(element);
            }
            b"property" => {
                let Some(element) = elements.last_mut() else {
                    return s.error("a property before the first element");
                };
                element.properties.push(property(&mut s)?);
            }
            b"end_header" => break,
            _ => {
                let allowed = "format, element, property, comment, obj_info, end_header";
                return s.error(format!("unknown header line `{}`; allowed: {allowed}", show(keyword)));
            }
        }
        s.next_line();
    }
    s.next_line();
    let Some(encoding) = encoding else { return s.error("the header has no `format` line") };
    let header = Header { encoding, elements, data: s.offset(), data_line: s.line() };
    check_counts(&header, bytes.len())?;
    Ok(header)
}

fn format(s: &mut Scanner<'_>) -> Scanned<Encoding> {
    let encoding = match s.word() {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        word => {
            let allowed = "ascii, binary_little_endian, binary_big_endian";
            return s.error(format!("unknown format `{}`; allowed: {allowed}", show(word)));
        }
    };
    match s.word() {
        b"1.0" => Ok(encoding),
        version => s.error(format!("unknown version `{}`; allowed: 1.0", show(version))),
    }
}

fn element(s: &mut Scanner<'_>) -> Scanned<Element> {
    let name = Escaped(&String::from_utf8_lossy(s.word())).to_string();
    let count = s.integer("the element's count")?;
    let count = match usize::try_from(count) {
        Ok(count) => count,
        Err(_) => {
            return s.error(format!("element `{}` has the count {count}; allowed: 0 or more", show(name.as_bytes())));
        }
    };
    Ok(Element { name, count, properties: Vec::new() })
}

fn property(s: &mut Scanner<'_>) -> Scanned<Property> {
    let word = s.word();
    let (list, item) = if word == b"list" {
        let length = scalar(s, None)?;
        if matches!(length, Scalar::Float(_)) {
            return s.error("a list's length must be of a whole-number type");
        }
        (Some(length), scalar(s, None)?)
    } else {
        (None, scalar(s, Some(word))?)
    };
    let name = show(s.word());
    Ok(Property { name, scalar: item, list })
}

fn scalar(s: &mut Scanner<'_>, word: Option<&[u8]>) -> Scanned<Scalar> {
    let word = word.unwrap_or_else(|| s.word());
    match Scalar::parse(word) {
        Some(scalar) => Ok(scalar),
        None => {
            let allowed = "char, uchar, short, ushort, int, uint, float, double, or int8 … float64";
            s.error(format!("unknown type `{}`; allowed: {allowed}", show(word)))
        }
    }
}

fn check_counts(header: &Header, file_size: usize) -> Scanned<()> {
    let mut left = file_size - header.data.min(file_size);
    for element in header.elements.iter().filter(|e| e.count > 0) {
        // The least an element can take: empty lists; in text one digit and a separator each.
        let least: usize = match header.encoding {
            Encoding::Ascii => 2 * element.properties.len(),
            _ => element.properties.iter().map(|p| p.list.unwrap_or(p.scalar).bytes()).sum(),
        };
        if least == 0 {
            return Err(MeshError::file(format!("element `{}` has no properties", show(element.name.as_bytes()))));
        }
        // The last line of a text needs no separator at its end.
        let available = (left + usize::from(header.encoding == Encoding::Ascii)) / least;
        if element.count > available {
            let (name, count) = (show(element.name.as_bytes()), element.count);
            let message = format!(
                "the header counts {count} of element `{name}`, {least} bytes or more each, but only {left} bytes \
                 follow; is the file truncated?"
            );
            return Err(MeshError::file(message));
        }
        left = left.saturating_sub(element.count * least);
    }
    Ok(())
}
