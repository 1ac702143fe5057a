//! Constants of rays through the medium grid.

use lamplight::grid::empty_space::{LONGEST, MATTER};
use lamplight::methods::raymarch::NEVER;
use lamplight::stages::transmittance::OPAQUE;

/// The constants of shaders/shared/packet.wgsl, except `ENDS`.
pub const PACKET: &[(&str, f64)] = &[
    ("NEVER", NEVER as f64),
    ("OPAQUE_TRANSMITTANCE", OPAQUE as f64),
    ("MAX_SKIP", LONGEST as f64),
    ("HAS_MEDIUM", MATTER as f64),
];
