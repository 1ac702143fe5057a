//! The command `lamplight`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(lamplight_cli::run(std::env::args_os()))
}
