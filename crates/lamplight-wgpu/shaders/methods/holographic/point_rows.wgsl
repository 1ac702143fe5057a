// The rows of cells that share a point of the lattice: a point stands for those of its open rows that lie side by side in
// its middle, for the reason in crates/lamplight/src/methods/holographic/point_rows.rs.

#import methods/holographic/footprint

// Rows of cells to a point, 1, 2 or 4.
override SPACING: u32;

// Bits of the first rows, so many of 128.
fn first_rows(count: i32) -> vec4u {
    let ones = vec4u(clamp(vec4i(count) - vec4i(0, 32, 64, 96), vec4i(0), vec4i(32)));
    // WGSL has no shift by 32.
    return select((vec4u(1u) << (ones & vec4u(31u))) - 1u, ~vec4u(0u), ones == vec4u(32u));
}

// The open rows in a slab of a workgroup, from 32 before its first, within the grid.
fn open_rows(slab: u32, first_row: i32) -> vec4u {
    let inside = first_rows(i32(sweep.cell_rows) - first_row + ASIDE) & ~first_rows(ASIDE - first_row);
    return inside & ~(near[MATTER * SLABS + slab + 1u] & ~near[MEDIUM * SLABS + slab + 1u]);
}

// Those of open rows that points stand for. Words begin with a point.
fn rows_in_points(open: vec4u) -> vec4u {
    if SPACING < 4u {
        return open;
    }
    let one = vec4u(1u);
    let two = vec4u(2u);
    let three = vec4u(3u);
    let first = open & ((open >> one) | ~((open >> two) | (open >> three)));
    let last = open & ((open << one) | ~((open << two) | (open << three)));
    return (first & vec4u(0x11111111u)) | (open & vec4u(0x66666666u)) | (last & vec4u(0x88888888u));
}

// The rows in a slab at which no ray may end: those that no point stands for, and those beyond the grid that share a point
// with some within, since a ray to these may have passed the end of a wall.
fn rows_apart(slab: u32, first_row: i32) -> vec4u {
    let start = first_row - ASIDE;
    let beyond = first_rows(i32(SPACING * sweep.rows) - start) & ~first_rows(i32(sweep.cell_rows) - start);
    let open = open_rows(slab, first_row);
    return beyond | (open & ~rows_in_points(open));
}

// Bits of rows as those of all rows that share a point with one.
fn any_of_points(rows: vec2u) -> vec2u {
    var any = rows;
    if SPACING >= 2u {
        any = (any | (any >> vec2u(1u))) & vec2u(0x55555555u);
        any |= any << vec2u(1u);
    }
    if SPACING >= 4u {
        any = (any | (any >> vec2u(2u))) & vec2u(0x33333333u);
        any |= any << vec2u(2u);
    }
    return any;
}
