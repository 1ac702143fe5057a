//! The kinds of dispatches of a quadrant.

/// The work of a dispatch, one of the programs of `holographic`, in the order of a quadrant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Work {
    Slabs,
    Trace,
    /// The next level of intervals.
    ExtendOnce,
    /// The next two levels, fused.
    Extend,
    /// The level of light below.
    MergeOnce,
    /// The two levels below, fused.
    Merge,
    /// The last merge of two levels, down to the level that pixels gather from.
    Finish,
    /// The final gather of the light of pixels and the irradiance of faces.
    Gather,
    /// That of the irradiance of faces alone, for a bounce.
    Faces,
}

impl Work {
    /// Returns whether light goes down through the levels.
    pub fn is_merge(self) -> bool {
        matches!(self, Self::MergeOnce | Self::Merge)
    }

    /// Returns whether quadrants can do it at the same time: all but those that add to the same pixels.
    pub fn is_apart(self) -> bool {
        !matches!(self, Self::Gather | Self::Faces)
    }
}
