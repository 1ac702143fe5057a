//! The sandbox: paint with light, in a window or on a web page.

mod platform;
mod window;

fn main() -> anyhow::Result<()> {
    platform::run()
}
