//! The command `lamplight`.

fn main() {}
