//! A directory to run the command in.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A small scene with a lamp, a coloured wall and glass.
pub const SMALL: &str = r#"
size = [32, 20]
[[shape]]
rect = { min = [14, 4], max = [17, 16] }
albedo = [0.8, 0.3, 0.2]
[[shape]]
rect = { min = [24, 2], max = [26, 18] }
opacity = 0.0
tint = [0.5, 0.9, 0.5]
[[lamp]]
position = [6.5, 10.0]
color = [1.0, 0.7, 0.4]
intensity = 5.0
size = 2.0
[light]
bounces = 0
wall_depth = 0
"#;

pub struct Sandbox(TempDir);

pub struct Run {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Run {
    /// Asserts success: exit code 0, nothing on stderr. Returns stdout.
    #[track_caller]
    pub fn done(self) -> String {
        assert_eq!((self.code, self.err.as_str()), (0, ""), "stdout: {}", self.out);
        self.out
    }

    /// Asserts failure: this exit code, nothing on stdout, these parts of stderr in their order.
    #[track_caller]
    pub fn failed(self, code: i32, says: &[&str]) -> String {
        assert_eq!(self.code, code, "stdout: {}\nstderr: {}", self.out, self.err);
        assert_eq!(self.out, "");
        let mut rest = self.err.as_str();
        for words in says {
            match rest.split_once(words) {
                Some((_, after)) => rest = after,
                None => panic!("`{words}` is missing, or in the wrong place, in:\n{}", self.err),
            }
        }
        self.err
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("output is UTF-8");
        let code = output.status.code().expect("it ended by itself");
        Self { code, out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Sandbox {
    pub fn new() -> Self {
        Self(TempDir::new().expect("a temporary directory"))
    }

    /// A directory with the small scene in it, as `small.toml`.
    pub fn small() -> Self {
        let sandbox = Self::new();
        sandbox.write("small.toml", SMALL);
        sandbox
    }

    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).expect("a file is written");
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        let path = self.path(name);
        std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    }

    pub fn picture(&self, name: &str) -> image::RgbImage {
        image::load_from_memory(&self.read(name)).expect("a picture").to_rgb8()
    }

    /// The names of all files, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the directory can be read");
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.expect("an entry").file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<_> = entries.map(name).collect();
        names.sort();
        names
    }

    /// The command, to run in the directory.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lamplight"));
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command.env_remove("XDG_RUNTIME_DIR");
        for variable in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "RAYON_NUM_THREADS"] {
            command.env_remove(variable);
        }
        command
    }

    /// Runs the command in the directory. Arguments are split at spaces.
    pub fn run(&self, arguments: &str) -> Run {
        let arguments: Vec<_> = arguments.split_whitespace().collect();
        self.command(&arguments).output().expect("it starts").into()
    }
}
