//! The settings of the filters that follow `raymarch`.

use super::declare::settings;

settings! {
    /// Temporal accumulation: a mean over frames whose history is rejected where the scene that a
    /// pixel sees has changed.
    pub struct Temporal in "temporal" {
        /// Maximum number of frames in the mean (a hysteresis of 1 − 1/n); 0 or 1 turns it off.
        /// Higher: less noise in a still picture (about 1/√n). Costs two copies of the light and
        /// almost no time.
        history_length: u32 = 0, in 0..=4096;
        /// Reject history where emission, opacity, tint or albedo changed in what a pixel sees, and everywhere if the
        /// sky changed, or inflow, a sun or an exact lamp comes, goes or has another brightness. Off: old light fades
        /// over `history_length` frames and leaves trails.
        reject: bool = true;
    }
}

settings! {
    /// À-trous wavelet blur guided by opacity and distance; never crosses a wall.
    pub struct Denoise in "denoise" {
        /// Number of passes; each doubles the radius (3 reach 14 px, 5 reach 62); 0 turns the blur
        /// off. Higher: smoother with very few rays, blurrier shadows, a few ms per pass at 320×180.
        passes: u32 = 4, in 0..=6;
        /// Difference in light, relative to the noise, that still counts as noise. Higher: smoother;
        /// lower: keeps fine shadows and more noise. 2 leaves little to see of the noise of 32 rays; 1 has
        /// about the least error.
        strength: f32 = 2.0, in 0.0..=16.0;
    }
}
