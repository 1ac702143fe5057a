//! Constants of rays through the medium grid.

use lamplight::internals::OPAQUE_TRANSMITTANCE;
use lamplight::internals::empty_space::{LONGEST, MATTER};
use lamplight::internals::raymarch::NEVER;

/// The constants of shaders/shared/packet.wgsl, except `ENDS`.
pub const PACKET: &[(&str, f64)] = &[
    ("NEVER", NEVER as f64),
    ("OPAQUE_TRANSMITTANCE", OPAQUE_TRANSMITTANCE as f64),
    ("MAX_SKIP", LONGEST as f64),
    ("HAS_MEDIUM", MATTER as f64),
];
