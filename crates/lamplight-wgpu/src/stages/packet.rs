//! Rays through what lets light pass.

use lamplight::methods::raymarch::NEVER;
use lamplight::stages::clearance::{LONGEST, MATTER};
use lamplight::stages::transmittance::OPAQUE;

/// Constants of shaders/packet.wgsl but `ENDS`.
pub const PACKET: &[(&str, f64)] = &[
    ("NEVER", NEVER as f64),
    ("OPAQUE", OPAQUE as f64),
    ("LONGEST", LONGEST as f64),
    ("MATTER", MATTER as f64),
];
