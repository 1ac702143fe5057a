// The lamps that reach a tile of 16×16 cells. A workgroup of 256 threads takes the lamps 256 at a time: each thread
// tests one of them, then all go through those that reach the tile, in the lamps' order, so that sums do not depend
// on how the work was divided.

#import shared/lamps

const TILE: u32 = 16u;

var<workgroup> reaching: array<atomic<u32>, 8>;

// Returns whether any cell of a tile may be in reach of a lamp. The reach is one px larger on all sides, and
// another for the faces of solid cells.
fn reaches(lamp: u32, tile: vec2u) -> bool {
    let start = vec2f(tile * TILE);
    let position = lamps.list[lamp].position;
    let away = position - clamp(position, start, start + f32(TILE));
    let reach = lamps.list[lamp].reach + 2.0;
    return dot(away, away) <= reach * reach;
}

// Finds which of 256 lamps from `first` on reach a tile: a bit each in `reaching`.
fn find_reaching(first: u32, tile: vec2u, lane: u32) {
    workgroupBarrier();
    if lane < 8u {
        atomicStore(&reaching[lane], 0u);
    }
    workgroupBarrier();
    if first + lane < lamps.count && reaches(first + lane, tile) {
        atomicOr(&reaching[lane / 32u], 1u << (lane % 32u));
    }
    workgroupBarrier();
}
