//! OBJ: polygons of `v` and `f`, materials of `usemtl` and `mtllib`; all other statements are passed over.
//!
//! tobj parses, but its errors name no line and no face; it takes polylines (`l`) for faces, splits a mesh at each
//! group, material and object, leaves out vertices that no face uses, and gives up at the first line that is not UTF-8.
//! So every line is checked and cut down to positions first, and tobj sees a single group.

use core::fmt::Write as _;
use core::iter::repeat_n;

use super::error::brief;
use super::lines::Lines;
use super::mtl::Library;
use super::polygon::Fans;
use super::source::Source;
use super::{AnyMesh, MeshError, MeshFile};

pub(super) fn read(mut source: Source) -> Result<MeshFile, MeshError> {
    let mut seen = Seen::default();
    let parsed = parse(&mut source, &mut seen)?;
    let (path, limits) = (source.path(), source.limits());

    let vertices = seen.positions.len();
    // Where tobj has each vertex of the file, and the other way round.
    let mut marks = Vec::with_capacity(vertices);
    let mut numbers = vec![0; vertices];
    for corners in faces(&parsed) {
        if let &[mark] = corners {
            numbers[mark as usize] = marks.len() as u32;
            marks.push(mark);
        }
    }
    let exact = |vertex: usize| core::array::from_fn(|k| parsed.positions[3 * marks[vertex] as usize + k]);

    let mut library = Library::default();
    if !seen.uses.is_empty() {
        for names in &seen.libraries {
            library.load(names, path, limits)?;
        }
    }
    let mut uses = seen.uses.iter().peekable();
    let mut material = None;
    let mut material_ids = Vec::new();
    let mut fans = Fans::default();
    let mut corners = Vec::new();
    for (face, indices) in faces(&parsed).filter(|corners| corners.len() != 1).enumerate() {
        if let Some(using) = uses.next_if(|using| using.first == face as u64) {
            material = Some(library.id(&using.name));
        }
        corners.clear();
        corners.extend(indices.iter().map(|&index| numbers[index as usize]));
        let triangles = fans.push(path, &corners)?;
        material_ids.extend(material.into_iter().flat_map(|id| repeat_n(id, triangles)));
    }
    let (triangles, skipped_faces) = fans.finish(path, exact)?;
    let mesh = AnyMesh::choose(seen.positions, exact, triangles, material_ids);
    Ok(MeshFile { mesh, materials: library.materials, missing_libraries: library.missing, skipped_faces })
}

/// The corners of each face that tobj saw, in the order of the file. One of a single corner is a vertex's mark, one of
/// none is a face to skip.
fn faces(parsed: &tobj::Mesh) -> impl Iterator<Item = &[u32]> {
    let mut rest = parsed.indices.as_slice();
    parsed.face_arities.iter().map(move |&arity| {
        let (corners, after) = rest.split_at(arity as usize);
        rest = after;
        corners
    })
}

fn parse(source: &mut Source, seen: &mut Seen) -> Result<tobj::Mesh, MeshError> {
    let path = source.path().to_owned();
    let mut lines = Lines::new(source, Source::next_joined_line, |source, line, out| seen.statement(source, line, out));
    match tobj::load_obj_buf(&mut lines, &tobj::LoadOptions::default(), |_| Err(tobj::LoadError::GenericFailure)) {
        Ok((models, _)) => Ok(models.into_iter().next().map(|model| model.mesh).unwrap_or_default()),
        // tobj looks indices up after the last line; of those that pass here, one too large is all it can find.
        Err(tobj::LoadError::FaceVertexOutOfBounds) => {
            let (index, face) = seen.largest;
            Err(MeshError::IndexOutOfRange { path, face, index, vertices: seen.positions.len() as u64 })
        }
        Err(error) => Err(lines.into_error(brief(error))),
    }
}

/// What the lines so far have said that tobj does not hear of.
#[derive(Default)]
struct Seen {
    /// The vertices in f32, of text that was rounded once: f64 could end between two numbers of f32, and the wrong one.
    positions: Vec<[f32; 3]>,
    faces: u64,
    /// The largest vertex named by a face before or after it was defined, and the first face to name it.
    largest: (i64, u64),
    uses: Vec<Using>,
    libraries: Vec<String>,
}

/// A `usemtl` statement: the first face it holds for, from 0, and the material's name.
struct Using {
    first: u64,
    name: String,
}

impl Seen {
    /// Notes a line, and writes to `out` what tobj shall see of it.
    fn statement(&mut self, source: &Source, line: &str, out: &mut String) -> Result<(), MeshError> {
        let line = line.trim_start();
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match word {
            "v" => self.vertex(source, rest, out),
            "f" | "fo" => self.face(source, rest, out),
            "usemtl" => {
                self.using(rest.trim());
                Ok(())
            }
            "mtllib" => {
                self.libraries.push(rest.trim().to_owned());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn vertex(&mut self, source: &Source, rest: &str, out: &mut String) -> Result<(), MeshError> {
        let count = self.positions.len() as u64 + 1;
        if count > u64::from(u32::MAX) {
            return Err(MeshError::TooLarge { path: source.path().to_owned(), what: "vertices", count });
        }
        // A fourth number is a weight to divide by; six or more are a position and a colour.
        let numbers = words(rest).count();
        let mut parsed = [1.0; 4];
        out.push('v');
        for (k, number) in words(rest).take(if numbers < 6 { numbers } else { 3 }).enumerate() {
            out.push(' ');
            out.push_str(number);
            if let Some(parsed) = parsed.get_mut(k) {
                // tobj refuses the line if this is no number.
                *parsed = number.parse().unwrap_or(f32::NAN);
            }
        }
        let [x, y, z, weight] = parsed;
        self.positions.push([x / weight, y / weight, z / weight]);
        // tobj keeps the vertices that faces use, in the order of their use: a mark keeps all, in their own order.
        out.push_str("\nf -1\n");
        Ok(())
    }

    fn face(&mut self, source: &Source, rest: &str, out: &mut String) -> Result<(), MeshError> {
        self.faces += 1;
        let face = self.faces;
        out.push('f');
        let face_starts = out.len();
        let mut corners = 0;
        for word in words(rest) {
            let index = word.split('/').next().unwrap_or_default();
            let index: i64 = index.parse().map_err(|_| {
                source.syntax(brief(format_args!("face {face}: `{word}` does not begin with a vertex's number")))
            })?;
            if index == 0 {
                return Err(MeshError::ZeroIndex { path: source.path().to_owned(), face, line: source.line() });
            }
            if index.saturating_neg() > self.positions.len() as i64 {
                let (path, vertices) = (source.path().to_owned(), self.positions.len() as u64);
                return Err(MeshError::IndexOutOfRange { path, face, index, vertices });
            }
            if index > self.largest.0 {
                self.largest = (index, face);
            }
            _ = write!(out, " {index}");
            corners += 1;
        }
        if corners < 3 {
            out.truncate(face_starts);
        }
        out.push('\n');
        Ok(())
    }

    fn using(&mut self, name: &str) {
        let (first, name) = (self.faces, name.to_owned());
        match self.uses.last_mut() {
            Some(last) if last.first == first => last.name = name,
            Some(_) => self.uses.push(Using { first, name }),
            None => {
                if first > 0 {
                    self.uses.push(Using { first: 0, name: String::new() });
                }
                self.uses.push(Using { first, name });
            }
        }
    }
}

/// The words of a statement up to a comment.
fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace().take_while(|word| !word.starts_with('#'))
}
