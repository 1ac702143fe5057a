//! The cones of all quadrants at the border of a grid with inflow, as shaders/methods/holographic/border.wgsl reads them.

use lamplight::internals::holographic::lattice::{cones, on_grid};
use lamplight::internals::holographic::{border_view, is_shared};
use lamplight::internals::sky::column;

/// Returns, quadrant by quadrant, the two columns of strips of so many between which each cone of the levels above `first`
/// sees, the slope of the middle, and the number of its ray, from 1 on, if both half cones along it see the same, else 0: the
/// levels up to the last of each axis, as the table of cones has them.
pub fn cones_at_border(first: u32, ends: [u32; 2], columns: u32) -> Vec<[f32; 4]> {
    let mut entries = Vec::new();
    for quadrant in 0..4 {
        let (along_x, reversed) = (quadrant < 2, quadrant % 2 == 1);
        for level in ends.iter().flat_map(|&end| first + 1..=end) {
            // Pixels gather from the first of them through whole cones.
            let shared = level > first + 1 && is_shared(level, columns as usize);
            entries.extend((0..cones(level)).map(|cone| {
                let view = border_view(level, cone, shared);
                let [from, to] = on_grid(along_x, reversed, view.edges)
                    .map(|angle| column(columns as usize, angle));
                // Without whole turns, for the precision of shaders.
                let begin = from.rem_euclid(columns.into());
                let end = begin + (to - from);
                let ray = if shared { cone.div_ceil(2) + 1 } else { 0 };
                [begin, end, view.slope, ray as f64].map(|v| v as f32)
            }));
        }
    }
    entries
}
