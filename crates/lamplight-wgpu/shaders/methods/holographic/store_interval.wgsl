// Writes intervals to memory, where fetch_interval.wgsl reads them.

#import methods/holographic/interval

fn store_words(at: u32, words: vec3u) {
    intervals[at] = words.xy;
    if WORDS == 3u {
        tints[at] = words.z;
    }
}
