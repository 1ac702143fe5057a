//! The cones of all quadrants at the border of a grid with inflow, as shaders/methods/holographic/border.wgsl reads them.

use lamplight::internals::holographic::lattice::{BEYOND, cones, edges, on_grid, slope};
use lamplight::internals::sky::column;

/// Returns, quadrant by quadrant, the two columns of strips of so many between which each cone of the levels above `first`
/// lies, and the slope of its middle: the levels up to the last of each axis, as the table of cones has them.
pub fn cones_at_border(first: u32, ends: [u32; 2], columns: u32) -> Vec<[f32; 4]> {
    let mut entries = Vec::new();
    for quadrant in 0..4 {
        let (along_x, reversed) = (quadrant < 2, quadrant % 2 == 1);
        for level in ends.iter().flat_map(|&end| first + 1..=end) {
            let count = cones(level);
            entries.extend((0..count).map(|cone| {
                // Those beyond the quadrant look along its edge.
                let inside = cone.clamp(BEYOND, count - 1 - BEYOND);
                let [from, to] = on_grid(along_x, reversed, edges(level, inside))
                    .map(|angle| column(columns as usize, angle));
                // Without whole turns, for the precision of shaders.
                let begin = from.rem_euclid(columns.into());
                let middle = 0.5 * (slope(level, inside) + slope(level, inside + 1));
                [begin, begin + (to - from), middle, 0.0].map(|v| v as f32)
            }));
        }
    }
    entries
}
