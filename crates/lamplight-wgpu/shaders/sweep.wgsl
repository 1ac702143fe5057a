// One quadrant of holographic cascades: the grid as light from ahead crosses it, slab after slab, and
// where intervals and cones lie. `Sweep` in src/methods/holographic/sweep.rs, field by field.
struct Sweep {
    // Slabs, and rows of a slab.
    depth: u32,
    rows: u32,
    // 0: slabs are columns; 1: slabs are rows of the grid.
    axis: u32,
    // 1: light comes from lower slabs.
    reversed: u32,
    // The lowest level of a group of levels, and how many more there are in it.
    level: u32,
    levels: u32,
    // The first plane of the topmost level, or of slabs, that is made.
    first: u32,
    // The plane of the topmost level at the far end.
    far: u32,
    // Where planes of odd index begin, of the four lowest levels and of the topmost, and half the index
    // of the first of them.
    odd: vec4u,
    odd_first: vec4u,
    odd_top: u32,
    odd_top_first: u32,
    // The same of planes of even index, of the lowest level and of the topmost.
    even: u32,
    even_first: u32,
    even_top: u32,
    even_top_first: u32,
    // Where the cones of the topmost level begin in the table of cones, and below of the four lowest.
    cones_top: u32,
    // 1: it is the first quadrant.
    begins: u32,
    cones: vec4u,
    // Where the light of the topmost and of the lowest level begins; of the lowest, the plane that is
    // held first, and how many are before it.
    above: u32,
    below: u32,
    below_far: u32,
    below_planes: u32,
    // Where the bits of this axis begin.
    bits: u32,
    // 1: surfaces send light on.
    sends: u32,
    // Px to the plane that pixels look to at least; planes lie 2^level px apart.
    least: u32,
    // Where the ways begin.
    ways: u32,
    // Rays of a beam, or through a cone in which something glows.
    rays: u32,
}

@group(0) @binding(1) var<uniform> sweep: Sweep;

// Planes of a level.
fn planes(level: u32) -> u32 {
    return (sweep.depth + (1u << level) - 1u) >> level;
}

// The cell of the grid in a row of a slab.
fn cell_of(slab: u32, row: u32) -> vec2u {
    let along = select(slab, sweep.depth - 1u - slab, sweep.reversed == 1u);
    return select(vec2u(row, along), vec2u(along, row), sweep.axis == 0u);
}

// The sky's light in a cone: ∫ dθ, ∫ |sin θ| dθ up and down the rows, ∫ cos θ dθ.
fn sky_in(cone: vec4f) -> vec3f {
    if sweep.axis == 0u {
        return frame.horizon * (cone.x - cone.y - cone.z) + frame.zenith * cone.y + frame.ground * cone.z;
    }
    let ahead = select(frame.ground, frame.zenith, sweep.reversed == 1u);
    return frame.horizon * (cone.x - cone.w) + ahead * cone.w;
}
