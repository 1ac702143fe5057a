//! Stderr while graphics drivers are loaded: their messages are of no use to users.

/// Runs `work` and returns what was printed to stderr meanwhile instead of printing it.
///
/// Drivers and the libraries that they load (Mesa, libwayland) print to stderr themselves, and offer
/// no common way to stop it. No other thread should print while `work` runs.
#[cfg(unix)]
pub fn captured<T>(work: impl FnOnce() -> T) -> (T, String) {
    let Some(redirected) = Redirected::new() else { return (work(), String::new()) };
    let result = work();
    let printed = redirected.printed();
    (result, printed)
}

/// Runs `work`; on this platform drivers do not print to stderr.
#[cfg(not(unix))]
pub fn captured<T>(work: impl FnOnce() -> T) -> (T, String) {
    (work(), String::new())
}

/// Stderr led into a temporary file until this is dropped.
#[cfg(unix)]
struct Redirected {
    stderr: rustix::fd::OwnedFd,
    file: std::fs::File,
}

#[cfg(unix)]
impl Redirected {
    fn new() -> Option<Self> {
        let file = tempfile::tempfile().ok()?;
        let stderr = rustix::io::dup(rustix::stdio::stderr()).ok()?;
        rustix::stdio::dup2_stderr(&file).ok()?;
        Some(Self { stderr, file })
    }

    fn printed(&self) -> String {
        use std::io::{Read, Seek, SeekFrom};
        let mut bytes = Vec::new();
        let mut file = &self.file;
        let _ = file.seek(SeekFrom::Start(0)).and_then(|_| file.read_to_end(&mut bytes));
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

#[cfg(unix)]
impl Drop for Redirected {
    fn drop(&mut self) {
        let _ = rustix::stdio::dup2_stderr(&self.stderr);
        // The message of a panic is ours, and must be seen.
        if std::thread::panicking() {
            eprint!("{}", self.printed());
        }
    }
}
