// One quadrant of holographic cascades: the grid as light from ahead crosses it, slab after slab, and where
// intervals and cones lie in memory. The importing shader declares `sweep`.

#import shared/uniforms

// `Sweep` in src/methods/holographic/sweep.rs, field by field.
struct Sweep {
    // Points of the lattice along the axis, and across it.
    depth: u32,
    rows: u32,
    // 0: slabs are columns of the grid; 1: rows.
    axis: u32,
    // 1: light comes from lower slabs.
    reversed: u32,
    // The lowest level that a dispatch reads intervals of, or gathers from.
    level: u32,
    // The first plane of the topmost level, or the first slab, of this dispatch.
    first: u32,
    // The plane of the level above that is stored first.
    far: u32,
    // The first interval of planes of odd index, and of even index, of the lowest level in its buffer, and half the
    // index of the first of them.
    odd: u32,
    even: u32,
    stored: u32,
    // Likewise of the topmost.
    odd_top: u32,
    even_top: u32,
    stored_top: u32,
    // The first entries of the level above, and of the level between it and the lowest, in the table of cones.
    cones_above: u32,
    cones_between: u32,
    // The first word of the light of the level above, of that between and of the lowest itself; of the latter,
    // the plane that is stored first.
    above: u32,
    between: u32,
    below: u32,
    below_far: u32,
    // Which of the four quadrants it is: the first overwrites light, the last adds what the others found.
    turn: u32,
    // The first word of the cell bits of this axis.
    cell_bits: u32,
    // 1 if scattered radiance is added to emission.
    indirect: u32,
    // Minimum distance in px from a pixel to the plane that it gathers from.
    gather_length: u32,
    // The first entry of the footprints.
    footprints: u32,
    // Rays through a cone if there are several.
    rays: u32,
    // From the entry of a cone in that table to the light of the sky in it, if the sky is a panorama.
    sky: u32,
    // Quadrants that share the dispatch, and planes of this one.
    quadrants: u32,
    planes: u32,
    // Points lie 2^spacing_level px apart, planes 2^level points.
    spacing_level: u32,
    // Slabs of cells, rows of a slab, and words of 32 rows.
    cell_depth: u32,
    cell_rows: u32,
    cell_words: u32,
}

const LAST_TURN: u32 = 3u;
// Cones beyond each edge of the quadrant.
const BEYOND: i32 = 2;

// The number of cones of a level, with those beyond the edges.
fn cone_count(level: u32) -> u32 {
    return (2u << level) + 2u * u32(BEYOND);
}

// The number of cones that pixels gather from: the outermost of the level have no light.
fn shown_count(level: u32) -> u32 {
    return cone_count(level) - 2u;
}

// The number of planes of a level.
fn planes(level: u32) -> u32 {
    return (sweep.depth + (1u << level) - 1u) >> level;
}

// The cell of the grid in a row of a slab.
fn cell_of(slab: u32, row: u32) -> vec2u {
    let along = select(slab, sweep.cell_depth - 1u - slab, sweep.reversed == 1u);
    return select(vec2u(row, along), vec2u(along, row), sweep.axis == 0u);
}
