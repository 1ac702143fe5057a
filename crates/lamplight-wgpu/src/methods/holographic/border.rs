//! The cones of all quadrants at the border of a grid with inflow, as shaders/methods/holographic/border.wgsl reads them.

use lamplight::internals::holographic::lattice::{cones, on_grid};
use lamplight::internals::holographic::{border_view, is_shared};
use lamplight::internals::inflow::ColumnWeights;

/// Weights of columns in an entry.
const WEIGHTS: usize = 4;

/// Returns what each cone sees of strips of so many columns, quadrant by quadrant: those of the levels above `first`, up to
/// the last of each axis, in the order of the table of cones. Their weights follow. All of it is put `after` as many entries.
pub fn views_at_border(
    first: u32,
    ends: [u32; 2],
    columns: usize,
    after: usize,
) -> Vec<[f32; WEIGHTS]> {
    let levels = || ends.into_iter().flat_map(|end| first + 1..=end);
    let all = 4 * levels().map(cones).sum::<usize>();
    let (mut views, mut weights) = (Vec::with_capacity(all), Vec::new());
    let mut seen = ColumnWeights::default();
    for quadrant in 0..4 {
        let (along_x, reversed) = (quadrant < 2, quadrant % 2 == 1);
        for level in levels() {
            // Pixels gather from the first of them through whole cones.
            let shared = level > first + 1 && is_shared(level, columns);
            for cone in 0..cones(level) {
                // The first along a ray has an odd index.
                if shared && cone > 0 && cone % 2 == 0 {
                    views.extend(views.last().copied());
                    continue;
                }
                let view = border_view(level, cone, shared);
                let [from, to] = on_grid(along_x, reversed, view.edges);
                seen.set(columns, from, to);
                let (column, of_columns) = seen.of_columns();
                let begin = after + all + weights.len();
                views.push([
                    column as f32,
                    of_columns.len() as f32,
                    view.slope as f32,
                    begin as f32,
                ]);
                weights.extend(
                    of_columns.chunks(WEIGHTS).map(|four| {
                        std::array::from_fn(|i| four.get(i).copied().unwrap_or_default())
                    }),
                );
            }
        }
    }
    views.extend(weights);
    views
}
