//! The kinds of dispatches of a quadrant.

/// The work of a dispatch, one of the programs of `holographic`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    Slabs,
    Trace,
    /// The next level of intervals.
    ExtendOnce,
    /// The next levels, fused.
    Extend,
    Merge,
    /// The last merge, down to the level that pixels gather from.
    Finish,
    /// The final gather of the light of pixels and the irradiance of faces.
    Gather,
    /// That of the irradiance of faces alone, for a bounce.
    Faces,
}
