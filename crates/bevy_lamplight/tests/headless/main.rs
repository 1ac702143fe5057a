//! The plugin in apps without a window, on whatever GPU there is: one program, since every program
//! with Bevy in it takes long to link.

mod camera;
mod common;
#[allow(dead_code)]
mod examples;
mod lamps;
mod lifecycle;
mod matter;
mod parity;
mod query;
mod reflect;
mod tools;
mod unlit;
