// Intervals in memory. The importing shader binds `intervals`, the first two words of each, and `tints`, the
// third, which has a single word if matter does not tint.

#import methods/holographic/interval

fn fetch_words(at: u32) -> vec3u {
    var words = vec3u(intervals[at], 0u);
    if WORDS == 3u {
        words.z = tints[at];
    }
    return words;
}
