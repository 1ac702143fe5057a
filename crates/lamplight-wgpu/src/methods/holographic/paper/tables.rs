//! Tables of numbers: the footprints of traced rays, and integrals over cones.

use crate::methods::holographic::sky::ConeEntry;
use lamplight::internals::holographic::paper::{Piece, edges, paths, rays};

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

/// Returns where each of the levels 1 to `end` begins, and `integrals` between the edges of each of their cones.
pub fn cones(end: u32, integrals: impl Fn([f64; 2]) -> [f64; 4]) -> (Vec<u32>, Vec<ConeEntry>) {
    let (mut begins, mut cones) = (Vec::new(), Vec::new());
    for level in 1..=end {
        begins.push(cones.len() as u32);
        for j in 0..1 << level {
            cones.push(integrals(edges(level, j, 0)).map(|part| part as f32));
        }
    }
    (begins, cones)
}
