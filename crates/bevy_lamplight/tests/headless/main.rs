//! Tests of the plugin in apps without a window, on any GPU. They are one program, because every program
//! that contains Bevy takes long to link.

mod camera;
mod common;
#[allow(dead_code)]
mod examples;
mod lamps;
mod lifecycle;
mod masks;
mod matter;
mod no_compute;
mod normals;
mod parity;
mod query;
mod reflect;
mod sight;
mod surroundings;
mod tools;
mod unlit;
