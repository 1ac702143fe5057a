//! Termination by a signal: the unfinished file is removed, and the exit code names the signal.

use crate::output;

/// Removes the unfinished output file and ends the program when Ctrl-C, SIGTERM or SIGHUP arrives.
///
/// The exit code is 128 plus the number of the signal, as shells report it: 130, 143 or 129.
pub fn handle_termination() {
    // If no handler can be installed, the signals still end the program, perhaps with a temporary
    // file left behind.
    let _ = install();
}

#[cfg(unix)]
fn install() -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        if let Some(signal) = signals.forever().next() {
            end(128 + signal);
        }
    })?;
    Ok(())
}

#[cfg(not(unix))]
fn install() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| end(130))
}

fn end(code: i32) {
    output::remove_unfinished();
    std::process::exit(code);
}
