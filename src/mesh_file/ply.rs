//! PLY: the elements `vertex` and `face`, ASCII or binary in either byte order; all other elements and properties are
//! passed over.
//!
//! A coordinate is a number of its declared type, in text, too: a `double` is the number of f64 that is nearest to it, and
//! where the mesh is one of f32, the number of f32 that is nearest to the text.
//!
//! Elements are parsed one by one as their bytes arrive, so a header's counts allocate nothing, and an error can name
//! the element.

use std::io::{self, ErrorKind};

use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{
    BeginList, ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};

use super::error::brief;
use super::polygon::Fans;
use super::source::Source;
use super::{AnyMesh, MeshError, MeshFile};
use crate::Mesh;

/// A header is a few lines, with comments a few pages.
const MAX_HEADER_BYTES: usize = 1 << 20;

const COORDINATES: [&str; 3] = ["x", "y", "z"];
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

pub(super) fn read(mut source: Source) -> Result<MeshFile, MeshError> {
    let header = read_header(&mut source)?;
    check(&source, &header)?;
    let vertices = header.elements["vertex"].count as u64;
    let path = source.path().to_owned();
    // What f32 holds is not kept twice.
    let is_wide = header.elements["vertex"].properties.values().any(is_wide_coordinate);
    let as_floats = (is_wide && header.encoding == Encoding::Ascii).then(|| with_floats(&header.elements["vertex"]));
    let (mut rounded, mut exact) = (Vec::new(), Vec::new());
    let mut fans = Fans::default();
    let mut corners = Vec::new();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => read_elements(&mut source, &header, element, |_, Vertex(position), text| {
                // Text that is a number of f64 is one of f32.
                let from_text = |element| Parser::new().read_ascii_element(text, element).ok();
                let Vertex(nearest) = as_floats.as_ref().and_then(from_text).unwrap_or(Vertex(position));
                rounded.push(nearest.map(|c| c as f32));
                exact.extend(is_wide.then_some(position));
                Ok(())
            })?,
            "face" => read_elements(&mut source, &header, element, |face, Face { signed, unsigned }, _| {
                corners.clear();
                for index in signed.into_iter().map(i64::from).chain(unsigned.into_iter().map(i64::from)) {
                    let corner = u32::try_from(index).ok().filter(|&corner| u64::from(corner) < vertices);
                    let path = || path.clone();
                    corners.push(corner.ok_or_else(|| MeshError::IndexOutOfRange {
                        path: path(),
                        face,
                        index,
                        vertices,
                    })?);
                }
                fans.push(&path, &corners)?;
                Ok(())
            })?,
            _ => read_elements(&mut source, &header, element, |_, Other, _| Ok(()))?,
        }
    }
    source.finish()?;
    let (mesh, skipped_faces) = if is_wide {
        let (triangles, skipped) = fans.finish(&path, |index| exact[index])?;
        (AnyMesh::choose(rounded, |index| exact[index], triangles, Vec::new()), skipped)
    } else {
        let (triangles, skipped) = fans.finish(&path, |index| rounded[index].map(f64::from))?;
        (AnyMesh::F32(Mesh::new(rounded, triangles)), skipped)
    };
    Ok(MeshFile { mesh, skipped_faces, ..MeshFile::default() })
}

fn read_header(source: &mut Source) -> Result<Header, MeshError> {
    let (mut header, mut line) = (Vec::new(), Vec::new());
    let mut definitions = 0;
    while line != b"end_header" {
        if !source.next_line(&mut line)? {
            let (path, element) = (source.path().to_owned(), "end_header".to_owned());
            return Err(MeshError::Truncated { path, element, read: 0, promised: Some(1) });
        }
        if source.line() == 1 && line != b"ply" {
            return Err(source.syntax("a PLY file begins with `ply`"));
        }
        if header.len() + line.len() > MAX_HEADER_BYTES {
            return Err(source.syntax(format!("the header is longer than {MAX_HEADER_BYTES} bytes")));
        }
        let word = line.split(u8::is_ascii_whitespace).next();
        definitions += usize::from(word == Some(b"element") || word == Some(b"property"));
        header.extend_from_slice(String::from_utf8_lossy(&line).as_bytes());
        header.push(b'\n');
    }
    let header = Parser::<Other>::new().read_ply_header(&mut header.as_slice()).map_err(|error| {
        let (path, line) = (source.path().to_owned(), error.line().map_or(source.line(), |line| line as u64));
        MeshError::Syntax { path, line, message: brief(error) }
    })?;
    // Where a name is defined twice, the parser keeps the second definition, and would read all that follows at the
    // wrong place.
    let kept = header.elements.values().map(|element| 1 + element.properties.len()).sum::<usize>();
    if kept != definitions {
        return Err(source.syntax("the header defines an element or a property twice"));
    }
    Ok(header)
}

/// Whether the header describes a mesh.
fn check(source: &Source, header: &Header) -> Result<(), MeshError> {
    let path = || source.path().to_owned();
    let find =
        |element| header.elements.get(element).ok_or_else(|| MeshError::MissingElement { path: path(), element });
    let (vertex, face) = (find("vertex")?, find("face")?);
    for (what, element) in [("vertices", vertex), ("faces", face)] {
        let count = element.count as u64;
        if count > u64::from(u32::MAX) {
            return Err(MeshError::TooLarge { path: path(), what, count });
        }
    }
    let scalar = |data: &PropertyType| matches!(data, PropertyType::Scalar(_));
    for property in COORDINATES {
        if !vertex.properties.get(property).is_some_and(|property| scalar(&property.data_type)) {
            let (element, expected) = ("vertex", "number");
            return Err(MeshError::MissingProperty { path: path(), element, property, expected });
        }
    }
    let corners = |data: &PropertyType| match data {
        PropertyType::Scalar(_) => false,
        PropertyType::List(_, scalar) => !matches!(scalar, ScalarType::Float | ScalarType::Double),
    };
    let mut lists = CORNERS.iter().filter_map(|name| face.properties.get(*name));
    match (lists.next(), lists.next()) {
        (Some(list), None) if corners(&list.data_type) => Ok(()),
        (Some(_), Some(_)) => Err(source.syntax("faces have both `vertex_indices` and `vertex_index`")),
        _ => {
            let (element, property, expected) = ("face", CORNERS[0], "list of integers");
            Err(MeshError::MissingProperty { path: path(), element, property, expected })
        }
    }
}

/// Parses the elements of one kind, and hands each to `take` with its number from 1 and, where the file is text, its line.
fn read_elements<E: PropertyAccess>(
    source: &mut Source,
    header: &Header,
    element: &ElementDef,
    mut take: impl FnMut(u64, E, &str) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    // Such an element has no bytes to read, however often it is repeated.
    if element.properties.is_empty() && header.encoding != Encoding::Ascii {
        return Ok(());
    }
    let parser = Parser::<E>::new();
    let mut line = Vec::new();
    for read in 0..element.count as u64 {
        let has_line = header.encoding == Encoding::Ascii && source.next_line(&mut line)?;
        let text = String::from_utf8_lossy(&line);
        let parsed = match header.encoding {
            Encoding::Ascii if !has_line => Err(io::Error::from(ErrorKind::UnexpectedEof).into()),
            Encoding::Ascii => parser.read_ascii_element(&text, element),
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(source, element),
            Encoding::BinaryBigEndian => parser.read_big_endian_element(source, element),
        };
        take(read + 1, parsed.map_err(|error| element_error(source, header, element, read, error))?, &text)?;
    }
    Ok(())
}

fn element_error(
    source: &mut Source,
    header: &Header,
    element: &ElementDef,
    read: u64,
    error: ParseError,
) -> MeshError {
    if let Some(failure) = source.failure() {
        return failure;
    }
    let (path, name) = (source.path().to_owned(), element.name.clone());
    if error.kind() == ErrorKind::UnexpectedEof {
        return MeshError::Truncated { path, element: name, read, promised: Some(element.count as u64) };
    }
    let (number, message) = (read + 1, brief(error));
    match header.encoding {
        Encoding::Ascii => source.syntax(format!("{name} {number}: {message}")),
        _ => MeshError::Malformed { path, element: name, number, message },
    }
}

/// Whether a property is a coordinate of a type whose numbers f32 may have to round.
fn is_wide_coordinate(property: &PropertyDef) -> bool {
    let is_wide =
        matches!(property.data_type, PropertyType::Scalar(ScalarType::Double | ScalarType::Int | ScalarType::UInt));
    is_wide && COORDINATES.contains(&property.name.as_str())
}

/// The element as if its coordinates were declared `float`. Read so, text becomes f32 in one rounding; by way of f64 it
/// would be rounded twice.
fn with_floats(element: &ElementDef) -> ElementDef {
    let mut element = element.clone();
    for axis in COORDINATES {
        element.properties[axis].data_type = PropertyType::Scalar(ScalarType::Float);
    }
    element
}

/// Where a vertex lies.
struct Vertex([f64; 3]);

impl Vertex {
    fn set(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        match COORDINATES.iter().position(|axis| *axis == name) {
            Some(axis) => {
                self.0[axis] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::Ignored,
        }
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; 3])
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, value.into())
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match property {
            Property::Int(value) => self.set(name, value.into()),
            Property::UInt(value) => self.set(name, value.into()),
            // All numbers of the other integer types are numbers of f32.
            _ => property.to_f32_lossy().map_or(PropertyAccessResult::Ignored, |value| self.set(name, value.into())),
        }
    }
}

/// A face's corners, in the list of its type; the other is empty. Shorter types are widened to `i32`.
struct Face {
    signed: Vec<i32>,
    unsigned: Vec<u32>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self { signed: Vec::new(), unsigned: Vec::new() }
    }

    fn begin_list_int(&mut self, name: &str, _length: usize) -> BeginList<'_, i32> {
        if CORNERS.contains(&name) { BeginList::Fill(&mut self.signed) } else { BeginList::UseSetter }
    }

    fn begin_list_uint(&mut self, name: &str, _length: usize) -> BeginList<'_, u32> {
        if CORNERS.contains(&name) { BeginList::Fill(&mut self.unsigned) } else { BeginList::UseSetter }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.signed = match property {
            Property::ListChar(list) => list.into_iter().map(i32::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i32::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i32::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i32::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An element that is no part of the mesh.
struct Other;

impl PropertyAccess for Other {
    fn new() -> Self {
        Self
    }
}
