//! The command `leafwalk`, run in a temporary folder as a user runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use leafwalk_cpu::Mesh;
use serde_json::Value;

/// A temporary folder to run a program in. It is removed with everything in it when the shell is dropped.
pub struct Shell {
    folder: tempfile::TempDir,
    program: PathBuf,
}

/// How a program ended.
#[derive(Debug)]
pub struct Outcome {
    /// Its exit code, unless a signal ended it.
    pub code: Option<i32>,
    /// What it printed.
    pub stdout: String,
    /// What it complained of.
    pub stderr: String,
}

impl Shell {
    /// An empty folder for a program. Only tests of the program's own package know its path, from Cargo's variable
    /// `CARGO_BIN_EXE_leafwalk`.
    pub fn new(program: impl Into<PathBuf>) -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder"), program: program.into() }
    }

    /// The path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).expect("a file that can be written");
    }

    /// The bytes of a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("a file that can be read")
    }

    /// The names of all files in the folder, hidden ones too, in alphabetical order.
    pub fn names(&self) -> Vec<String> {
        let entries = self.folder.path().read_dir().expect("a folder").map(|entry| entry.expect("an entry"));
        let mut names: Vec<_> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The names with the bytes of those that are files; reading a device might not end.
    fn contents(&self) -> Vec<(String, Option<Vec<u8>>)> {
        let content = |name: &str| self.path(name).is_file().then(|| self.read(name));
        self.names().into_iter().map(|name| (name.clone(), content(&name))).collect()
    }

    /// The program with arguments, which spaces separate, to be started in the folder.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs the program to its end.
    pub fn run(&self, arguments: &str) -> Outcome {
        Outcome::of(self.command(arguments).output().expect("the command starts"))
    }

    /// Runs the program with `--json` and returns the object that it prints.
    #[track_caller]
    pub fn json(&self, arguments: &str) -> Value {
        let outcome = self.run(&format!("{arguments} --json"));
        outcome.assert_code(0);
        serde_json::from_str(&outcome.stdout).unwrap_or_else(|error| panic!("{error}: {outcome:?}"))
    }

    /// Asserts that the program fails with one line on stderr that names `reason`, prints nothing and changes no file.
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
    /// The outcome of a program that was started by other means.
    pub fn of(output: std::process::Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("text");
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// Asserts that the program ended with this exit code.
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

/// The paths of all mesh files below a folder, in alphabetical order.
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
