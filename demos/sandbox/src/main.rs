//! The sandbox: paint with light, in a window or on a web page.

mod message;
mod platform;
mod start;
mod window;

fn main() -> anyhow::Result<()> {
    start::run()
}
