//! A temporary folder, and the real command run in it.
#![allow(dead_code, unreachable_pub, missing_docs, reason = "each test uses a part of it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use leafwalk::Mesh;
use serde_json::Value;

pub struct Shell {
    folder: tempfile::TempDir,
}

/// How a command ended.
#[derive(Debug)]
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Shell {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).expect("a file that can be written");
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("a file that can be read")
    }

    /// What is in the folder, hidden files too, in alphabetical order.
    pub fn names(&self) -> Vec<String> {
        let entries = self.folder.path().read_dir().expect("a folder").map(|entry| entry.expect("an entry"));
        let mut names: Vec<_> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Names with what is in those that are files; a device may have no end.
    fn contents(&self) -> Vec<(String, Option<Vec<u8>>)> {
        let content = |name: &str| self.path(name).is_file().then(|| self.read(name));
        self.names().into_iter().map(|name| (name.clone(), content(&name))).collect()
    }

    /// The command with arguments that spaces part, in the folder.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_leafwalk"));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub fn run(&self, arguments: &str) -> Outcome {
        Outcome::of(self.command(arguments).output().expect("the command starts"))
    }

    /// Runs with `--json` and returns the object.
    #[track_caller]
    pub fn json(&self, arguments: &str) -> Value {
        let outcome = self.run(&format!("{arguments} --json"));
        outcome.assert_code(0);
        serde_json::from_str(&outcome.stdout).unwrap_or_else(|error| panic!("{error}: {outcome:?}"))
    }

    /// Asserts that the work fails for a reason that names `reason`, says nothing on stdout and changes no file.
    #[track_caller]
    pub fn assert_fails(&self, arguments: &str, reason: &str) {
        let before = self.contents();
        let outcome = self.run(arguments);
        outcome.assert_code(1);
        assert!(outcome.stderr.starts_with("error: ") && outcome.stderr.contains(reason), "{reason}: {outcome:?}");
        assert_eq!(outcome.stderr.lines().count(), 1, "{outcome:?}");
        assert_eq!(outcome.stdout, "", "{outcome:?}");
        assert!(before == self.contents(), "files changed: {:?}", self.names());
    }
}

impl Outcome {
    pub fn of(output: std::process::Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("text");
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    #[track_caller]
    pub fn assert_code(&self, code: i32) {
        assert_eq!(self.code, Some(code), "{self:?}");
    }
}

/// The text of an OBJ file that reads back as the same mesh.
pub fn obj(mesh: &Mesh) -> String {
    let vertices = mesh.positions.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = mesh.triangles.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    vertices.chain(faces).collect()
}

/// Every mesh file below a folder.
pub fn mesh_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in folder.read_dir().expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() {
            files.extend(mesh_files(&entry));
        } else if [".obj", ".ply", ".stl"]
            .iter()
            .any(|end| entry.to_string_lossy().trim_end_matches(".gz").ends_with(end))
        {
            files.push(entry);
        }
    }
    files.sort();
    files
}
