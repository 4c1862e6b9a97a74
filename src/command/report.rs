//! The report of a command: what it did, in numbers, for people and for machines.

use std::io::{self, Write};

use leafwalk::Octree;
use serde_json::{Map, Value};

/// An ordered list of results: a name for machines, a label for people.
#[derive(Debug, Default)]
pub(crate) struct Report {
    entries: Vec<Entry>,
}

/// A time in seconds to divide by where the clock saw none pass.
const SHORTEST: f64 = 1e-9;

#[derive(Debug)]
struct Entry {
    name: &'static str,
    label: &'static str,
    value: Value,
    text: String,
}

impl Report {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// A value whose text is the value itself.
    pub(crate) fn add(&mut self, name: &'static str, label: &'static str, value: impl Into<Value>) {
        let value = value.into();
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        self.entries.push(Entry { name, label, value, text });
    }

    /// A value and, for people, a text with its unit; each further line of the text is printed under the first.
    pub(crate) fn add_as(
        &mut self,
        name: &'static str,
        label: &'static str,
        value: impl Into<Value>,
        text: impl Into<String>,
    ) {
        self.entries.push(Entry { name, label, value: value.into(), text: text.into() });
    }

    /// How many rays a second were traced.
    pub(crate) fn add_speed(&mut self, label: &'static str, rays: u64, seconds: f64) {
        let mrays_per_s = rays as f64 / seconds.max(SHORTEST) / 1e6;
        self.add_as("mrays_per_s", label, mrays_per_s, format!("{mrays_per_s:.3} Mrays/s"));
    }

    /// What an octree holds and how much room it takes.
    pub(crate) fn add_octree(&mut self, octree: &Octree<Vec<u32>>) {
        let stats = octree.stats();
        self.add("triangles", "triangles", stats.primitives);
        self.add("dropped", "triangles dropped", stats.dropped);
        self.add("collapsed", "of which collapsed", stats.collapsed);
        self.add("leaves", "leaves", stats.leaves);
        self.add("blocks", "blocks of 8", stats.blocks);
        let bytes = size_of_val(octree.as_words());
        self.add("bytes", "bytes", bytes);
        let each = (stats.primitives > 0).then(|| bytes as f64 / f64::from(stats.primitives));
        let text = each.map_or("-".to_owned(), |each| format!("{each:.1}"));
        self.add_as("bytes_per_triangle", "bytes a triangle", each, text);
    }

    /// One object, whose members stand in alphabetical order.
    pub(crate) fn write_json(&self, writer: &mut impl Write) -> io::Result<()> {
        let members = self.entries.iter().map(|entry| (entry.name.to_owned(), entry.value.clone()));
        writeln!(writer, "{}", Value::Object(members.collect::<Map<_, _>>()))
    }

    /// Label and text side by side.
    pub(crate) fn write_text(&self, writer: &mut impl Write) -> io::Result<()> {
        let width = self.entries.iter().map(|entry| entry.label.len()).max().unwrap_or(0);
        for entry in &self.entries {
            let labels = core::iter::once(entry.label).chain(core::iter::repeat(""));
            for (label, line) in labels.zip(entry.text.lines()) {
                writeln!(writer, "{label:width$}  {line}")?;
            }
        }
        Ok(())
    }
}
