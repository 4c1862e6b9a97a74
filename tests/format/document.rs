//! The worked examples of docs/format.md show what files hold, word for word.

use std::fs;
use std::path::Path;

use leafwalk::{Builder, Mesh, Octree};

fn read(path: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The words of a code block of the document, each with its place: lines are `place: word word ... ; comment`, in
/// hexadecimal.
fn example(name: &str) -> Vec<(usize, u32)> {
    let document = String::from_utf8(read("docs/format.md")).expect("text");
    let opening = format!("```words {name}");
    let block = document.lines().skip_while(|line| *line != opening).skip(1).take_while(|line| *line != "```");
    let mut words = Vec::new();
    for line in block {
        let code = line.split(';').next().unwrap_or_default();
        let (place, rest) = code.split_once(':').unwrap_or_else(|| panic!("no place: {line}"));
        let hex = |digits: &str| u32::from_str_radix(digits, 16).unwrap_or_else(|error| panic!("{error}: {line}"));
        words.extend((hex(place) as usize..).zip(rest.split_whitespace().map(hex)));
    }
    assert!(!words.is_empty(), "docs/format.md has no example '{name}'");
    words
}

/// The first place where words differ from those that the document shows.
fn difference(words: &[u32], shown: impl IntoIterator<Item = (usize, u32)>) -> Option<String> {
    shown.into_iter().find_map(|(place, shown)| match words.get(place) {
        Some(word) if *word == shown => None,
        found => Some(format!("word {place:03x}: docs/format.md shows {shown:08x}, the file has {found:08x?}")),
    })
}

/// The triangle of the README, as the document says.
fn one_triangle() -> Octree<Vec<u32>> {
    let mesh = Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    Builder::new().build(&mesh).expect("a mesh that builds")
}

#[test]
fn the_example_of_one_triangle_is_what_the_builder_writes() {
    let octree = one_triangle();
    let words = octree.as_words();
    // What is not shown is zero.
    let mut shown = vec![0; words.len()];
    for (place, word) in example("one-triangle") {
        *shown.get_mut(place).unwrap_or_else(|| panic!("the file has no word {place:03x}")) = word;
    }
    assert_eq!(difference(words, shown.into_iter().enumerate()), None);
}

#[test]
fn the_example_of_two_leaves_is_from_the_frozen_file() {
    let name = "version_2/levels.lwk";
    let bytes = read(&format!("tests/format/{name}"));
    let words: Vec<u32> =
        bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().expect("four"))).collect();
    assert_eq!(difference(&words, example(name)), None);
}

#[test]
fn a_wrong_word_in_an_example_is_noticed() {
    let octree = one_triangle();
    for at in 0..example("one-triangle").len() {
        let mut shown = example("one-triangle");
        shown[at].1 ^= 1;
        assert!(difference(octree.as_words(), shown).is_some(), "word number {at} of the example");
    }
}
