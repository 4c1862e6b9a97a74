//! Materials of an OBJ file: the names that faces use, and the colours that MTL files give them.

use core::fmt::Write as _;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::error::brief;
use super::lines::Lines;
use super::source::Source;
use super::{Limits, Material, MeshError};

/// The materials of an OBJ file, and the ids of their names.
#[derive(Default)]
pub(super) struct Library {
    pub(super) materials: Vec<Material>,
    pub(super) missing: Vec<PathBuf>,
    ids: HashMap<String, u32>,
}

impl Library {
    /// The id of a name; one that is not defined yet becomes a neutral material.
    pub(super) fn id(&mut self, name: &str) -> u32 {
        if let Some(&id) = self.ids.get(name) {
            return id;
        }
        let id = self.materials.len() as u32;
        self.materials.push(Material::neutral(name));
        self.ids.insert(name.to_owned(), id);
        id
    }

    /// Adds the materials of an `mtllib` statement's files: one name, which may hold spaces, or several. Names are
    /// relative to the OBJ file's folder; a file may be there with `.gz` after its name.
    pub(super) fn load(&mut self, names: &str, obj: &Path, limits: &Limits) -> Result<(), MeshError> {
        let folder = obj.parent().unwrap_or(Path::new(""));
        // Only regular files: reading a pipe or device that a file names may never end.
        let find = |name: &str| {
            let plain = folder.join(name);
            let zipped = folder.join(format!("{name}.gz"));
            [plain, zipped].into_iter().find(|path| path.is_file())
        };
        let names: Vec<&str> = if find(names).is_some() { vec![names] } else { names.split_whitespace().collect() };
        for name in names {
            match find(name) {
                Some(path) => self.read(&mut Source::open(&path, limits)?)?,
                None => self.missing.push(folder.join(name)),
            }
        }
        Ok(())
    }

    fn read(&mut self, source: &mut Source) -> Result<(), MeshError> {
        // tobj panics at a colour of one or two numbers, and drops the whole file for a bad value of any parameter.
        let mut lines = Lines::new(source, Source::next_joined_line, |source, line, out| {
            let (word, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
            match (word, color(rest)) {
                ("newmtl", _) if rest.trim().is_empty() => return Err(source.syntax("`newmtl` without a name")),
                ("newmtl", _) => _ = writeln!(out, "newmtl {}", rest.trim()),
                ("Kd" | "Ke", Some(color)) => {
                    // tobj reads f64: of f64, the shortest text gives all bits back.
                    let [r, g, b] = color.map(f64::from);
                    _ = writeln!(out, "{word} {r} {g} {b}");
                }
                _ => {}
            }
            Ok(())
        });
        let materials = match tobj::load_mtl_buf(&mut lines) {
            Ok((materials, _)) => materials,
            Err(error) => return Err(lines.into_error(brief(error))),
        };
        for read in materials {
            let id = self.id(&read.name) as usize;
            let material = &mut self.materials[id];
            let rounded = |color: [f64; 3]| color.map(|c| c as f32);
            material.diffuse = read.diffuse.map_or(material.diffuse, rounded);
            material.emission = read.emissive.map_or(material.emission, rounded);
        }
        Ok(())
    }
}

/// The three numbers of a colour; a single one is a grey.
fn color(words: &str) -> Option<[f32; 3]> {
    let mut numbers = words.split_whitespace().map(|word| word.parse().ok().filter(|x: &f32| x.is_finite()));
    let red = numbers.next()??;
    match (numbers.next(), numbers.next()) {
        (None, _) => Some([red; 3]),
        (Some(green), Some(blue)) => Some([red, green?, blue?]),
        (Some(_), None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::color;

    #[test]
    fn colors() {
        assert_eq!(color("0.1 0.2 0.3"), Some([0.1, 0.2, 0.3]));
        assert_eq!(color("1 2 3 # a comment"), Some([1.0, 2.0, 3.0]));
        assert_eq!(color("0.5"), Some([0.5; 3]));
        for unread in ["", "1 2", "1 2 x", "nan 0 0", "1 inf 1", "spectral steel.rfl 1", "xyz 1 1 1"] {
            assert_eq!(color(unread), None, "{unread}");
        }
    }
}
