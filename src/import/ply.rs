//! PLY, the Stanford polygon format: text, and binary of either byte order.
//!
//! Read are the vertices' `x y z`, `nx ny nz` and `u v` (or `s t`, `texture_u texture_v`), and the faces'
//! `vertex_indices` (or `vertex_index`); other elements and properties are skipped. Polygons are cut into fans.

use super::ply_header::{self, Element, Encoding, Header, Property, Scalar};
use super::scan::{MeshError, Scanned, Scanner, Spot};
use crate::scene::desc::MeshDesc;

/// Names of the vertex properties that are read, by slot; the later names of a slot are synonyms.
const SLOTS: [&[&str]; 8] =
    [&["x"], &["y"], &["z"], &["nx"], &["ny"], &["nz"], &["u", "s", "texture_u"], &["v", "t", "texture_v"]];

/// Names of the property that holds a face's corners.
const CORNERS: &[&str] = &["vertex_indices", "vertex_index"];

/// Where the elements' values come from.
enum Source<'a> {
    Text(Scanner<'a>),
    Binary { bytes: &'a [u8], pos: usize, big_endian: bool },
}

impl Source<'_> {
    fn here(&mut self) -> Spot {
        match self {
            Self::Text(s) => {
                s.skip_blanks();
                s.here()
            }
            Self::Binary { pos, .. } => Spot::Byte(*pos),
        }
    }

    #[inline]
    fn take<const N: usize>(bytes: &[u8], pos: &mut usize, name: &str) -> Scanned<[u8; N]> {
        match bytes.get(*pos..).and_then(|rest| rest.first_chunk::<N>()) {
            Some(chunk) => {
                *pos += N;
                Ok(*chunk)
            }
            None => {
                Err(MeshError::byte(bytes.len(), format!("the file ends within property `{name}`; is it truncated?")))
            }
        }
    }

    /// A value as f64, which holds every type's values exactly.
    #[inline]
    fn binary(bytes: &[u8], pos: &mut usize, big_endian: bool, scalar: Scalar, name: &str) -> Scanned<f64> {
        macro_rules! read {
            ($type:ty) => {{
                let raw = Self::take::<{ size_of::<$type>() }>(bytes, pos, name)?;
                f64::from(if big_endian { <$type>::from_be_bytes(raw) } else { <$type>::from_le_bytes(raw) })
            }};
        }
        Ok(match scalar {
            // Most files hold nothing but these two.
            Scalar::Float(4) => read!(f32),
            Scalar::Int(4) => read!(i32),
            Scalar::Int(1) => read!(i8),
            Scalar::Int(_) => read!(i16),
            Scalar::Uint(1) => read!(u8),
            Scalar::Uint(2) => read!(u16),
            Scalar::Uint(_) => read!(u32),
            Scalar::Float(_) => read!(f64),
        })
    }

    /// A coordinate: a finite number in 32 bits.
    #[inline]
    fn coordinate(&mut self, scalar: Scalar, name: &str) -> Scanned<f32> {
        match self {
            Self::Text(s) => s.float(name),
            Self::Binary { bytes, pos, big_endian } => {
                let at = *pos;
                let value = Self::binary(bytes, pos, *big_endian, scalar, name)?;
                if (value as f32).is_finite() {
                    return Ok(value as f32);
                }
                Err(MeshError::byte(at, format!("{name} {value} is not finite; allowed: -3.4e38 to 3.4e38")))
            }
        }
    }

    /// A whole number.
    #[inline]
    fn integer(&mut self, scalar: Scalar, name: &str) -> Scanned<i64> {
        match self {
            Self::Text(s) => s.integer(name),
            Self::Binary { bytes, pos, big_endian } => {
                Self::binary(bytes, pos, *big_endian, scalar, name).map(|x| x as i64)
            }
        }
    }

    fn length(&mut self, scalar: Scalar, name: &str) -> Scanned<usize> {
        let at = self.here();
        let length = self.integer(scalar, name)?;
        usize::try_from(length).map_err(|_| {
            let message = format!("list `{name}` has the length {length}; allowed: 0 or more");
            MeshError::new(at, message)
        })
    }

    /// Reads a property over.
    fn skip(&mut self, property: &Property) -> Scanned<()> {
        let count = property.list.map_or(Ok(1), |length| self.length(length, &property.name))?;
        match self {
            Self::Text(s) => {
                for _ in 0..count {
                    if s.line_is_done() {
                        return s.error(format!("the line ends within property `{}`", property.name));
                    }
                    s.word();
                }
            }
            Self::Binary { bytes, pos, .. } => {
                let end = count.checked_mul(property.scalar.bytes()).and_then(|size| pos.checked_add(size));
                *pos = end.filter(|&end| end <= bytes.len()).ok_or_else(|| {
                    let message = format!("the file ends within property `{}`; is it truncated?", property.name);
                    MeshError::byte(bytes.len(), message)
                })?;
            }
        }
        Ok(())
    }

    /// Goes to the start of an element.
    fn start_element(&mut self, name: &str, number: usize) -> Scanned<()> {
        if let Self::Text(s) = self {
            while s.line_is_done() {
                if s.at_end() {
                    return s.error(format!("the file ends before {name} {number}; is it truncated?"));
                }
                s.next_line();
            }
        }
        Ok(())
    }

    fn finish_element(&mut self, name: &str) -> Scanned<()> {
        match self {
            Self::Text(s) => s.finish_line(name),
            Self::Binary { .. } => Ok(()),
        }
    }

    /// Demands that nothing follows the last element.
    fn finish(&mut self) -> Scanned<()> {
        match self {
            Self::Text(s) => {
                while !s.at_end() {
                    s.finish_line("the last element")?;
                }
                Ok(())
            }
            Self::Binary { bytes, pos, .. } if *pos < bytes.len() => {
                let extra = bytes.len() - *pos;
                Err(MeshError::byte(*pos, format!("{extra} bytes follow the last element; allowed: none")))
            }
            Self::Binary { .. } => Ok(()),
        }
    }
}

/// Reads a PLY file.
pub(super) fn parse(bytes: &[u8]) -> Scanned<MeshDesc> {
    let header = ply_header::parse(bytes)?;
    let vertices = find(&header, "vertex")?.count;
    find(&header, "face")?;
    if u32::try_from(vertices).is_err() {
        return Err(MeshError::file(format!("{vertices} vertices; allowed: at most 2^32 − 1")));
    }
    let mut source = match header.encoding {
        Encoding::Ascii => Source::Text(Scanner::new(bytes, header.data, header.data_line)),
        encoding => Source::Binary { bytes, pos: header.data, big_endian: encoding == Encoding::BigEndian },
    };
    let mut mesh = MeshDesc::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut source, element, &mut mesh)?,
            "face" => read_faces(&mut source, element, vertices, &mut mesh.triangles)?,
            _ => {
                for number in 0..element.count {
                    source.start_element(&element.name, number)?;
                    element.properties.iter().try_for_each(|p| source.skip(p))?;
                    source.finish_element(&element.name)?;
                }
            }
        }
    }
    source.finish()?;
    if mesh.triangles.is_empty() {
        return Err(MeshError::file("the mesh has no faces; it needs at least one"));
    }
    check_normals(&mesh)?;
    Ok(mesh)
}

fn find<'h>(header: &'h Header, name: &str) -> Scanned<&'h Element> {
    let found = header.elements.iter().find(|e| e.name == name);
    found.ok_or_else(|| MeshError::file(format!("the header has no element `{name}`")))
}

fn read_vertices(source: &mut Source<'_>, element: &Element, mesh: &mut MeshDesc) -> Scanned<()> {
    let slots: Vec<Option<usize>> = element
        .properties
        .iter()
        .map(|p| SLOTS.iter().position(|names| p.list.is_none() && names.contains(&p.name.as_str())))
        .collect();
    let has = |slot: usize| slots.contains(&Some(slot));
    let group = |range: std::ops::Range<usize>| -> Scanned<bool> {
        let present = range.clone().filter(|&slot| has(slot)).count();
        if present > 0 && present < range.len() {
            let names: Vec<&str> = range.map(|slot| SLOTS[slot][0]).collect();
            let message = format!("the vertices have only some of {}; allowed: all or none", names.join(", "));
            return Err(MeshError::file(message));
        }
        Ok(present > 0)
    };
    if !group(0..3)? {
        return Err(MeshError::file("the vertices have no x, y, z"));
    }
    let (has_normals, has_uvs) = (group(3..6)?, group(6..8)?);
    // The counts have been checked against the file's size.
    mesh.positions.reserve_exact(element.count);
    mesh.normals.reserve_exact(if has_normals { element.count } else { 0 });
    mesh.uvs.reserve_exact(if has_uvs { element.count } else { 0 });
    for number in 0..element.count {
        source.start_element("vertex", number)?;
        let mut v = [0.0f32; SLOTS.len()];
        for (property, slot) in element.properties.iter().zip(&slots) {
            match slot {
                Some(slot) => v[*slot] = source.coordinate(property.scalar, &property.name)?,
                None => source.skip(property)?,
            }
        }
        source.finish_element("the vertex")?;
        mesh.positions.push([v[0], v[1], v[2]]);
        if has_normals {
            mesh.normals.push([v[3], v[4], v[5]]);
        }
        if has_uvs {
            mesh.uvs.push([v[6], v[7]]);
        }
    }
    Ok(())
}

fn read_faces(
    source: &mut Source<'_>,
    element: &Element,
    vertices: usize,
    triangles: &mut Vec<[u32; 3]>,
) -> Scanned<()> {
    let is_corners = |p: &Property| p.list.is_some() && CORNERS.contains(&p.name.as_str());
    let corners = element.properties.iter().position(is_corners);
    let corners = corners.ok_or_else(|| MeshError::file("the faces have no list `vertex_indices`"))?;
    if matches!(element.properties[corners].scalar, Scalar::Float(_)) {
        return Err(MeshError::file("`vertex_indices` must be of a whole-number type"));
    }
    triangles.reserve(element.count);
    for number in 0..element.count {
        source.start_element("face", number)?;
        for (i, property) in element.properties.iter().enumerate() {
            match property.list.filter(|_| i == corners) {
                Some(length) => polygon(source, property, length, vertices, triangles)?,
                None => source.skip(property)?,
            }
        }
        source.finish_element("the face")?;
    }
    Ok(())
}

/// Reads a face's corners and adds its fan of triangles.
#[inline]
fn polygon(
    source: &mut Source<'_>,
    property: &Property,
    length: Scalar,
    vertices: usize,
    triangles: &mut Vec<[u32; 3]>,
) -> Scanned<()> {
    let at = source.here();
    let count = source.length(length, &property.name)?;
    if count < 3 {
        return Err(MeshError::new(at, format!("a face of {count} corners; allowed: 3 or more")));
    }
    let (mut first, mut last) = (0, 0);
    for corner in 0..count {
        let at = source.here();
        let index = source.integer(property.scalar, &property.name)?;
        let vertex = match u32::try_from(index) {
            Ok(vertex) if (vertex as usize) < vertices => vertex,
            _ => {
                let allowed = match vertices {
                    0 => "there are no vertices".to_owned(),
                    n => format!("allowed: 0 to {}", n - 1),
                };
                return Err(MeshError::new(at, format!("vertex index {index} is out of range; {allowed}")));
            }
        };
        match corner {
            0 => first = vertex,
            1 => {}
            _ => triangles.push([first, last, vertex]),
        }
        last = vertex;
    }
    Ok(())
}

/// A normal that a triangle uses must have a direction; tools write zero for vertices that nothing uses.
fn check_normals(mesh: &MeshDesc) -> Scanned<()> {
    if mesh.normals.iter().all(|n| *n != [0.0; 3]) {
        return Ok(());
    }
    match mesh.triangles.iter().flatten().find(|&&i| mesh.normals[i as usize] == [0.0; 3]) {
        Some(i) => {
            Err(MeshError::file(format!("the normal of vertex {i} is [0, 0, 0]; a normal must have a direction")))
        }
        None => Ok(()),
    }
}
