// One quadrant of holographic cascades: the grid as light from ahead crosses it, slab after slab, and where
// intervals and cones lie in memory. The importing shader declares `sweep`.

#import shared/uniforms

// `Sweep` in src/methods/holographic/sweep.rs, field by field.
struct Sweep {
    // Slabs, and rows of a slab.
    depth: u32,
    rows: u32,
    // 0: slabs are columns of the grid; 1: rows.
    axis: u32,
    // 1: light comes from lower slabs.
    reversed: u32,
    // The lowest level of a group of levels, and the number of further levels in the group.
    level: u32,
    levels: u32,
    // The first plane of the topmost level, or the first slab, of this dispatch.
    first: u32,
    // The plane of the level above that is stored first.
    far: u32,
    // The first interval of planes of odd index, of the four lowest levels and of the topmost, and half the index
    // of the first of them.
    odd: vec4u,
    odd_first: vec4u,
    odd_top: u32,
    odd_top_first: u32,
    // Likewise for planes of even index, of the lowest level and of the topmost.
    even: u32,
    even_first: u32,
    even_top: u32,
    even_top_first: u32,
    // The first entry of the level above in the table of cones.
    cones_above: u32,
    // 1 in the first quadrant, which overwrites light.
    first_quadrant: u32,
    // The first entry of the light of the level above and of the level itself; of the latter, the plane that
    // is stored first, and 1 if half cones are stored.
    above: u32,
    below: u32,
    below_far: u32,
    halves: u32,
    // The first word of the cell bits of this axis.
    cell_bits: u32,
    // 1 if scattered radiance is added to emission.
    indirect: u32,
    // Minimum distance in px from a pixel to the plane that it gathers from. Planes lie 2^level px apart.
    gather_length: u32,
    // The first entry of the footprints.
    footprints: u32,
    // Rays of a bundle, or through a cone that contains an emitter.
    rays: u32,
    // From the entry of a cone in that table to the light of the sky in it, if the sky is a panorama.
    sky: u32,
    // Quadrants that share the dispatch, and planes of this one.
    quadrants: u32,
    planes: u32,
}

// Cones beyond each edge of the quadrant.
const BEYOND: i32 = 2;

// The number of cones of a level, with those beyond the edges.
fn cone_count(level: u32) -> u32 {
    return (2u << level) + 2u * u32(BEYOND);
}

// The number of planes of a level.
fn planes(level: u32) -> u32 {
    return (sweep.depth + (1u << level) - 1u) >> level;
}

// The cell of the grid in a row of a slab.
fn cell_of(slab: u32, row: u32) -> vec2u {
    let along = select(slab, sweep.depth - 1u - slab, sweep.reversed == 1u);
    return select(vec2u(row, along), vec2u(along, row), sweep.axis == 0u);
}
