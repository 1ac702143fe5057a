// What stands in a cell, as ground.wgsl packs it.

@group(0) @binding(3) var<storage, read> kinds: array<u32>;

fn word_at(cell: vec2u) -> u32 {
    return kinds[(cell.y >> 2u) * ((frame.size.x + 3u) >> 2u) + (cell.x >> 2u)];
}

fn kind_in(word: u32, cell: vec2u) -> u32 {
    return (word >> (((cell.y & 3u) << 3u) | ((cell.x & 3u) << 1u))) & 3u;
}

fn kind_at(cell: vec2i) -> u32 {
    if !inside(cell) {
        return BEYOND;
    }
    return kind_in(word_at(vec2u(cell)), vec2u(cell));
}

// Whether light fills a cell, thinned by fog or not.
fn open(cell: vec2i) -> bool {
    let kind = kind_at(cell);
    return kind == EMPTY || kind == FOG;
}
