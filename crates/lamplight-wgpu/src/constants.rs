//! Numbers of the library that shaders need, by the names that they have there: each is written down
//! once, in the library.

use lamplight::methods::raymarch::{GOLDEN_RATIO, NEVER};
use lamplight::settings::Hit;
use lamplight::stages::clearance::{LONGEST, MATTER};
use lamplight::stages::distance::MARGIN;
use lamplight::stages::noise;
use lamplight::stages::seed::NONE;
use lamplight::stages::transmittance::{LOG_OF_ZERO, OPAQUE};

type Constant = (&'static str, f64);

pub const SEED: &[Constant] = &[("NONE", NONE as f64)];
pub const DISTANCE: &[Constant] = &[("NONE", NONE as f64), ("FAR", FAR as f64)];
pub const OPTICS: &[Constant] = &[("LOG_OF_ZERO", LOG_OF_ZERO as f64)];
pub const CLEARANCE: &[Constant] = &[("LONGEST", LONGEST as f64), ("MATTER", MATTER as f64)];
/// For rays that end by this rule.
pub fn raymarch(hit: Hit) -> Vec<Constant> {
    let march = match hit {
        Hit::Edge => MARCH_EDGE,
        Hit::Distance => MARCH_DISTANCE,
    };
    [GATHER, march].concat()
}

const GATHER: &[Constant] = &[
    ("SIDE", noise::SIDE as f64),
    ("SLICES", noise::FRAMES as f64),
    ("STEP_X", noise::R2[0] as f64),
    ("STEP_Y", noise::R2[1] as f64),
    ("GOLDEN", noise::GOLDEN as f64),
    ("GOLDEN_RATIO", GOLDEN_RATIO as f64),
    ("NEVER", NEVER as f64),
];
const MARCH_EDGE: &[Constant] =
    &[("OPAQUE", OPAQUE as f64), ("LONGEST", LONGEST as f64), ("MATTER", MATTER as f64)];
const MARCH_DISTANCE: &[Constant] = &[("NONE", NONE as f64), ("MARGIN", MARGIN as f64)];

pub const OUTPUT: &[Constant] = &[("BRIGHTEST", BRIGHTEST as f64)];

/// The largest half float.
const BRIGHTEST: f32 = 65504.0;

/// What the distance field holds in a grid without matter, where the CPU has +∞: shaders may take
/// infinity for granted not to be.
pub const FAR: f32 = f32::MAX;
