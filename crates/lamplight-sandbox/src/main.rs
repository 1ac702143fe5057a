//! The sandbox: paint with light, in a window.

mod window;

use clap::Parser;

fn main() -> anyhow::Result<()> {
    window::open(window::Args::parse())
}
