//! Mathematics that methods share: evenly spread directions, noise, transmittance.

pub mod circle;
pub mod noise;
pub mod transmittance;
