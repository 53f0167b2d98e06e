//! Wavefront OBJ: `v`, `vt`, `vn`, `f`. Groups, materials and smoothing are read over; a mesh has one material here.
//!
//! Format: Wavefront's "Advanced Visualizer" manual, appendix B1. Indices count from 1, or back from −1. Polygons are
//! cut into fans, which is right for convex ones.

use super::scan::{MeshError, Scanned, Scanner, show};
use crate::scene::desc::MeshDesc;

/// Statements that say nothing about triangles and their corners.
const IGNORED: &[&[u8]] =
    &[b"g", b"o", b"s", b"usemtl", b"mtllib", b"l", b"p", b"vp", b"mg", b"usemap", b"maplib", b"lod", b"bevel"];

/// "No index": the end of a chain, or an attribute that a corner does not have.
const NONE: u32 = u32::MAX;

/// The vertices found so far. A corner is a triple of indices; equal triples become one vertex.
#[derive(Default)]
struct Vertices {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// For each position its first vertex, or `NONE`: the head of a chain through `next`. Chains are short (a position
    /// has few normals and texture coordinates), so that no hashing is needed.
    first: Vec<u32>,
    corners: Vec<Corner>,
}

/// A vertex of the mesh to be.
struct Corner {
    position: u32,
    uv: u32,
    normal: u32,
    /// The next vertex at the same position, or `NONE`.
    next: u32,
}

impl Vertices {
    /// The vertex of a triple of indices.
    #[inline]
    fn vertex(&mut self, position: u32, uv: u32, normal: u32) -> Scanned<u32> {
        let mut at = self.first[position as usize];
        while at != NONE {
            let corner = &self.corners[at as usize];
            if corner.uv == uv && corner.normal == normal {
                return Ok(at);
            }
            at = corner.next;
        }
        let new = u32::try_from(self.corners.len()).ok().filter(|&i| i != NONE);
        let new = new.ok_or_else(|| MeshError::file("more than 2^32 − 2 vertices; allowed: fewer"))?;
        let next = std::mem::replace(&mut self.first[position as usize], new);
        self.corners.push(Corner { position, uv, normal, next });
        Ok(new)
    }

    fn into_mesh(self, triangles: Vec<[u32; 3]>) -> MeshDesc {
        let has_uvs = self.corners.iter().any(|c| c.uv != NONE);
        let has_normals = self.corners.iter().any(|c| c.normal != NONE);
        let mut mesh = MeshDesc { triangles, ..MeshDesc::default() };
        mesh.positions = self.corners.iter().map(|c| self.positions[c.position as usize]).collect();
        // Where some faces have an attribute and others do not, those get zero: "no normal", and a corner of the texture.
        if has_uvs {
            mesh.uvs = self.corners.iter().map(|c| self.uvs.get(c.uv as usize).copied().unwrap_or_default()).collect();
        }
        if has_normals {
            let normal = |c: &Corner| self.normals.get(c.normal as usize).copied().unwrap_or_default();
            mesh.normals = self.corners.iter().map(normal).collect();
        }
        mesh
    }
}

/// Reads an OBJ file.
pub(super) fn parse(bytes: &[u8]) -> Scanned<MeshDesc> {
    let mut s = Scanner::new(bytes, 0, 1);
    let mut vertices = Vertices::default();
    let mut triangles = Vec::new();
    while !s.at_end() {
        if s.line_is_done() {
            s.next_line();
            continue;
        }
        let start = s.here();
        match s.word() {
            b"v" => {
                let position = [s.float("x")?, s.float("y")?, s.float("z")?];
                // A weight, a colour, or both may follow.
                skip_floats(&mut s, 4)?;
                s.finish_line("the position")?;
                vertices.positions.push(position);
                vertices.first.push(NONE);
            }
            b"vn" => {
                let normal = [s.float("nx")?, s.float("ny")?, s.float("nz")?];
                s.finish_line("the normal")?;
                vertices.normals.push(normal);
            }
            b"vt" => {
                let u = s.float("u")?;
                let v = if s.line_is_done() { 0.0 } else { s.float("v")? };
                skip_floats(&mut s, 1)?;
                s.finish_line("the texture coordinates")?;
                vertices.uvs.push([u, v]);
            }
            b"f" => {
                let corners = face(&mut s, &mut vertices, &mut triangles)?;
                if corners < 3 {
                    let message = format!("a face of {corners} corners; allowed: 3 or more");
                    return Err(MeshError::new(start, message));
                }
                s.finish_line("the face")?;
            }
            word if IGNORED.contains(&word) => s.next_line(),
            word => {
                let message =
                    format!("unknown statement `{}`; allowed: v, vt, vn, f, l, p, g, o, s, usemtl, mtllib", show(word));
                return Err(MeshError::new(start, message));
            }
        }
    }
    if triangles.is_empty() {
        return Err(MeshError::file("the mesh has no faces; it needs at least one `f` line"));
    }
    Ok(vertices.into_mesh(triangles))
}

fn skip_floats(s: &mut Scanner<'_>, most: usize) -> Scanned<()> {
    for _ in 0..most {
        if s.line_is_done() {
            break;
        }
        s.float("a further coordinate")?;
    }
    Ok(())
}

/// Reads a face's corners, adds its fan of triangles, and returns how many corners it has.
#[inline]
fn face(s: &mut Scanner<'_>, vertices: &mut Vertices, triangles: &mut Vec<[u32; 3]>) -> Scanned<usize> {
    let (mut count, mut first, mut last) = (0, 0, 0);
    // What the first corner has, the others must have: (texture coordinates, normal).
    let mut form = (false, false);
    while !s.line_is_done() {
        let here = s.here();
        let position = index(s, "vertex", vertices.positions.len())?;
        let (mut uv, mut normal) = (NONE, NONE);
        if s.slash() {
            if s.at_integer() {
                uv = index(s, "texture coordinate", vertices.uvs.len())?;
            }
            if s.slash() {
                let here = s.here();
                normal = index(s, "normal", vertices.normals.len())?;
                if vertices.normals[normal as usize] == [0.0; 3] {
                    let message =
                        format!("normal {} is [0, 0, 0]; a normal must have a direction", u64::from(normal) + 1);
                    return Err(MeshError::new(here, message));
                }
            }
        }
        let this_form = (uv != NONE, normal != NONE);
        if count == 0 {
            form = this_form;
        } else if form != this_form {
            let message = "the corners of a face must all have the same form: v, v/vt, v//vn or v/vt/vn";
            return Err(MeshError::new(here, message));
        }
        let vertex = vertices.vertex(position, uv, normal)?;
        match count {
            0 => first = vertex,
            1 => {}
            _ => triangles.push([first, last, vertex]),
        }
        last = vertex;
        count += 1;
    }
    Ok(count)
}

/// Reads a reference to one of the `count` items defined so far and returns it counted from 0.
#[inline]
fn index(s: &mut Scanner<'_>, what: &str, count: usize) -> Scanned<u32> {
    s.skip_blanks();
    let here = s.here();
    let written = s.integer(what)?;
    let from_zero = if written < 0 { count as i64 + written } else { written - 1 };
    if (0..count as i64).contains(&from_zero) && from_zero < i64::from(NONE) {
        return Ok(from_zero as u32);
    }
    let allowed = match count {
        0 => "none is defined before this line".to_owned(),
        n => format!("allowed: 1 to {n}, or -{n} to -1 (those defined before this line)"),
    };
    Err(MeshError::new(here, format!("{what} index {written} is out of range; {allowed}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn quads_and_polygons_become_fans() {
        let mesh = parse(format!("{QUAD}v 0.5 2 0\nf 1 2 3 4\nf 1 2 3 5 4").as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 4], [0, 4, 3]]);
        assert_eq!(mesh.positions[4], [0.5, 2.0, 0.0]);
        assert!(mesh.normals.is_empty() && mesh.uvs.is_empty());
    }

    #[test]
    fn equal_corners_are_one_vertex_and_others_are_not() {
        let text = format!(
            "{QUAD}vt 0 0\nvt 1 0 0\nvn 0 0 1\nvn 0 0 2\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\nf 1/2/1 2/1/2 3/1/1\n"
        );
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 2]]);
        assert_eq!(mesh.positions[4], mesh.positions[0]);
        assert_eq!((mesh.uvs[0], mesh.uvs[4]), ([0.0, 0.0], [1.0, 0.0]));
        assert_eq!((mesh.normals[1], mesh.normals[5]), ([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]));
    }

    #[test]
    fn negative_indices_count_back_from_the_line() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -3 -2 -1";
        assert_eq!(parse(text.as_bytes()).unwrap().triangles, [[0, 1, 2], [1, 2, 3]]);
    }

    #[test]
    fn groups_materials_comments_and_line_ends() {
        let text = "# a comment\r\nmtllib x y.mtl\r\no thing\r\n\r\ng a b\r\n  v 0 0 0 1 .5 .5 .5\r\nv\t1 0 0 # here\r\nv 0 \\\r\n 1 0\r\n\
                    s off\r\nusemtl m\r\nf 1// 2// 3//";
        // `1//` has no normal after its second slash.
        assert!(parse(text.as_bytes()).is_err());
        let mesh = parse(text.replace("//", "").as_bytes()).unwrap();
        assert_eq!(mesh.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn faces_without_normals_among_others_get_none() {
        let text = format!("{QUAD}vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4");
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(mesh.normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0; 3], [0.0; 3], [0.0; 3]]);
    }
}
