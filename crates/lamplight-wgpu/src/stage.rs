//! Buffers that hosts can read back.

/// A buffer that can be read back ([`crate::read_back`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// The seed map, one `u32` per cell; made with [`crate::FrameInput::distance_field`].
    Seeds,
    /// The Voronoi map, one `u32` per cell; made with [`crate::FrameInput::distance_field`].
    Nearest,
    /// The distance field, one `f32` per cell, `f32::MAX` in a grid without matter; made with
    /// [`crate::FrameInput::distance_field`].
    Distance,
    /// The squares of empty space of `raymarch` and `cascades`, four bytes per cell, one per quadrant.
    EmptySpace,
    /// The visibility of each cell from the viewers of [`crate::FrameInput::sights`], one `f32` per cell, 0 to 1; made
    /// if there are any.
    Sight,
    /// The light, four `f32` per cell: linear RGB and 1.
    Light,
}
