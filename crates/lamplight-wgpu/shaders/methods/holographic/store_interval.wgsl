// Writes intervals to memory, where fetch_interval.wgsl reads them. The importing shader binds `made`, the first two words
// of each, and `made_tints`, the third.

#import methods/holographic/interval

fn store_words(at: u32, words: vec3u) {
    made[at] = words.xy;
    if WORDS == 3u {
        made_tints[at] = words.z;
    }
}
