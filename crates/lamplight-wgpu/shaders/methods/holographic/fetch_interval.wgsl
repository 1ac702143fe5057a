// Intervals in memory. The importing shader binds `intervals`, the first two words of each, and `tints`, the
// third, which has a single word if matter does not tint.

#import methods/holographic/interval
#import methods/holographic/quadrant

fn fetch_words(at: u32) -> vec3u {
    var words = vec3u(intervals[at], 0u);
    if WORDS == 3u {
        words.z = tints[at];
    }
    return words;
}

// The words of an interval of the lowest level; of nothing outside the grid. They are loaded in any case: loads that no
// branch holds back wait for memory together.
fn stored(p: u32, ray: i32, row: i32) -> vec3u {
    let rays = (2u << sweep.level) + 1u;
    let outside = u32(row) >= sweep.rows || u32(ray) >= rays || p >= planes(sweep.level);
    let base = select(sweep.even, sweep.odd, (p & 1u) == 1u);
    let at = base + ((p / 2u - sweep.stored) * rays + u32(ray)) * sweep.rows + u32(row);
    return select(fetch_words(select(at, 0u, outside)), pack(nothing()), outside);
}
