// Reads the classes of cells as stages/class.wgsl packs them.

#import shared/class
#import shared/normal
#import shared/uniforms

@group(0) @binding(3) var<storage, read> classes: array<u32>;

// The classes of the 4×4 cells around a cell, two bits each.
fn word_at(cell: vec2u) -> u32 {
    return classes[(cell.y >> 2u) * ((frame.size.x + 3u) >> 2u) + (cell.x >> 2u)];
}

fn class_in(word: u32, cell: vec2u) -> u32 {
    return (word >> (((cell.y & 3u) << 3u) | ((cell.x & 3u) << 1u))) & 3u;
}

fn class_at(cell: vec2i) -> u32 {
    if !inside(cell) {
        return OUTSIDE;
    }
    return class_in(word_at(vec2u(cell)), vec2u(cell));
}

// Returns whether a cell of the grid is not solid.
fn open(cell: vec2i) -> bool {
    let cell_class = class_at(cell);
    return cell_class == EMPTY || cell_class == MEDIUM;
}

// The faces of a solid cell that look at open cells, a bit each: left, right, top, bottom.
fn exposed_faces(cell: vec2i) -> u32 {
    var faces = 0u;
    for (var face = 0u; face < 4u; face++) {
        faces |= select(0u, 1u << face, open(cell + normal(face)));
    }
    return faces;
}
