//! Tables that are the same for every frame: the footprints of traced rays, and the cones.

use lamplight::internals::holographic::paper::{Piece, cone, paths, rays};

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

/// Returns where each of the levels 1 to `end` begins, and for each of their cones: ∫ dθ, ∫ |sin θ| dθ where
/// the sine is negative, and where it is positive, ∫ cos θ dθ.
pub fn cones(end: u32) -> (Vec<u32>, Vec<[f32; 4]>) {
    let (mut begins, mut cones) = (Vec::new(), Vec::new());
    for level in 1..=end {
        begins.push(cones.len() as u32);
        for j in 0..1 << level {
            let [angle, up, down] = cone(level, j, 0);
            // A quarter turn further, the cosine is the sine.
            let [_, _, along] = cone(level, j, 1);
            cones.push([angle, up, down, along].map(|part| part as f32));
        }
    }
    (begins, cones)
}
