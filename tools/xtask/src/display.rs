//! A display for the tests that open a window: one in memory.

use crate::apt;
use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// Debian's packages of the server, and of what a window loads when it opens.
const PACKAGES: [&str; 7] = [
    "xvfb",
    "libx11-6",
    "libx11-xcb1",
    "libxcursor1",
    "libxi6",
    "libxkbcommon-x11-0",
    "libxrandr2",
];

/// Sees to it that there is one; installs it where that can be done.
pub fn ensure() -> Result<()> {
    let advice = format!(
        "tests that open a window need Xvfb. On Debian and its kin: apt-get install {}. To leave \
         these tests out: cargo xtask test --without-gpu",
        PACKAGES.join(" ")
    );
    if is_found() {
        return Ok(());
    }
    println!("== no display in memory is found: installing one");
    apt::install(&PACKAGES, &advice)?;
    if !is_found() {
        bail!("Xvfb is installed and not found; {advice}");
    }
    Ok(())
}

/// A display in memory, gone when this is.
pub struct Display {
    server: Child,
    /// For the variable DISPLAY.
    pub name: String,
}

impl Display {
    pub fn new() -> Result<Self> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1600x900x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let mut number = String::new();
        let output = server.stdout.take().context("Xvfb says nothing")?;
        BufReader::new(output).read_line(&mut number)?;
        Ok(Self { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It is gone already where this fails.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn is_found() -> bool {
    let mut asked = Command::new("Xvfb");
    asked.arg("-help").stdout(Stdio::null()).stderr(Stdio::null());
    asked.status().is_ok()
}
