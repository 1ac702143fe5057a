//! Tables that are the same for every frame: the footprints of traced rays.

use lamplight::internals::holographic::paper::{Piece, paths, rays};

/// Returns where each of the levels 0 to `traced` begins, and the footprints of their rays, as trace.wgsl reads
/// them.
pub fn traced_footprints(traced: u32) -> (Vec<u32>, Vec<[i32; 4]>) {
    let heads: usize = (0..=traced).map(rays).sum();
    let (mut begins, mut table, mut pieces) = (Vec::new(), Vec::new(), Vec::<[i32; 4]>::new());
    for level in 0..=traced {
        begins.push(table.len() as u32);
        for way in paths(level) {
            let first = pieces.len();
            for piece in way {
                match piece {
                    Piece::Cross { at: [x, y], length } => {
                        pieces.push([x, y, length.to_bits() as i32, 0]);
                    }
                    // It comes after the cell that it is a corner of.
                    Piece::Corner([_, [_, next_row]]) => {
                        if let Some([_, row, _, side]) = pieces.last_mut() {
                            *side = next_row - *row;
                        }
                    }
                }
            }
            table.push([(heads + first) as i32, (pieces.len() - first) as i32, 0, 0]);
        }
    }
    table.extend(pieces);
    (begins, table)
}
