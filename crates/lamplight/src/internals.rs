//! Parts of the methods and stages that other crates of this repository use: constants and tables that
//! `lamplight-wgpu` passes to its shaders, and single stages with which tests and the reference compare
//! their own.
//!
//! This module is not part of the public API: any release may rename or remove its items. It exists so
//! that a number that the CPU and the GPU both need is written once.
//!
//! Items of a single method or stage are in a module with its stem.

pub use crate::check::BRIGHT;
pub use crate::filters::estimate::Estimate;
pub use crate::grid::class::CellClass;
pub use crate::math::transmittance::{MAX_OPTICAL_DEPTH, OPAQUE_TRANSMITTANCE, extinction};
pub use crate::stages::bounce::CONVERGED;
pub use crate::stages::walls::Walls;

/// Radiance cascades: the cascades of a grid, and the cosines and sines of rays on faces.
pub mod cascades {
    pub use crate::methods::cascades::{BEFORE, BRANCHES, Cascade, cascades, cosine, mean_sine};
}

/// Evenly spread directions.
pub mod circle {
    pub use crate::math::circle::direction;
}

/// The cookies of lamps.
pub mod cookie {
    pub use crate::cookie::axis;
}

/// The edge-aware blur.
pub mod denoise {
    pub use crate::filters::denoise::{
        DEVIATIONS, Denoiser, KERNEL, TRANSMITTANCE, WALL_REACH, WALL_SPREAD, WIDE_DEVIATIONS,
    };
}

/// The curves of tone maps.
pub mod display {
    pub use crate::stages::display::{
        ACES, ACES_LUMA, ACES_WHITE, AGX_CONTRAST, AGX_GAMMA, AGX_INSET, AGX_OUTSET, AGX_PLAIN,
        AGX_STOPS, AGX_VIVID, BRIGHTEST, emitted,
    };

    pub use crate::relief::LEAST_LIGHT;
}

/// The direct light of lamps and suns.
pub mod direct {
    pub use crate::stages::direct::clamp;
}

/// The distance field.
pub mod distance {
    pub use crate::stages::distance::{MARGIN, distance};
}

/// The weights of the first moments of light with an elevation of its own.
pub mod elevation {
    pub use crate::elevation::{longest_moment, of_sun};
}

/// Empty-space skipping.
pub mod empty_space {
    pub use crate::grid::empty_space::{LONGEST, MATTER, empty_space};
}

/// The energy of `flood`, and how it fades.
pub mod flood {
    pub use crate::methods::flood::{STEEPNESS, reach};
}

/// Holographic radiance cascades.
pub mod holographic {
    pub use crate::methods::holographic::{
        EMISSIVE, MATTER, MEDIUM, PRIMARY, REACH, SMALL, WEIGHT_EPSILON, border_view, exchanged,
        is_shared,
    };

    /// Directions, levels, and the positions of planes.
    pub mod lattice {
        pub use crate::methods::holographic::lattice::{
            BEYOND, Crossing, GatherGeometry, bent, bundle, cones, cones_of_halves, edges, halves,
            levels, on_grid, planes, points, rays, slope,
        };
    }

    /// The method as published.
    pub mod paper {
        pub use crate::methods::holographic::paper::{
            Interval, Paper, Piece, Quadrant, edges, paths, rays,
        };
    }
}

/// The first moment of light by its gradient.
pub mod gradient_moment {
    pub use crate::stages::gradient_moment::HALF;
}

/// The jump flood, and the passes that correct its remaining errors.
pub mod jump_flood {
    pub use crate::stages::jump_flood::{SETTLED_ERROR, jump_flood, passes, settle};
}

/// Cells that glow, as media.
pub mod glow {
    pub use crate::stages::glow::{Glow, THINNEST};
}

/// Lamps drawn as discs.
pub mod lamp {
    pub use crate::lamp_discs::{LEAST_RADIUS, show_lamps};
    pub use crate::source_normalization::gain;
}

/// The jitter of rays.
pub mod noise {
    pub use crate::math::noise::{FRAMES, GOLDEN, R2, SIDE, blue, fold};
}

/// The shadow maps of `polar`.
pub mod polar {
    pub use crate::methods::polar::{APART, FINEST, NARROWEST, NEAREST, WIDEST, rays};
}

/// The rays of `raymarch`.
pub mod raymarch {
    pub use crate::grid::packet::NEVER;
    pub use crate::methods::raymarch::{GOLDEN_RATIO, SECTOR, directions, stride};
}

/// The seed map.
pub mod seed {
    pub use crate::stages::seed::{NONE, pack, seed, unpack};
}

/// The sky, and the suns that are drawn into it.
pub mod sky {
    pub use crate::panorama::{column, place};
    pub use crate::sky::sines;
    pub use crate::sun_glow::SunGlow;
}

/// The mean over frames.
pub mod temporal {
    pub use crate::filters::temporal::{FEEDBACK, REACH, shine_alike};
}

/// Light that enters a grid by place.
pub mod inflow {
    pub use crate::inflow::{ColumnWeights, border_cells};
}

/// The light that solid cells show.
pub mod walls {
    pub use crate::stages::pyramid::KERNEL;
    pub use crate::stages::walls::{ALONG, OCTAVE, SOFTENING, STRAIGHT, octaves};
}
