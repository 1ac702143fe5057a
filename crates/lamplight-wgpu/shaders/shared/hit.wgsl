// The end of a ray of a lamp.

// The distance to the solid cell that it meets, and the cell, packed as seeds are; FAR and NO_CELL if it
// meets none.
struct Hit {
    length: f32,
    cell: u32,
}

// Stands for infinity, which a shader may not rely on.
const FAR: f32 = 0x1.fffffep+127;
const NO_CELL: u32 = 0xffffffffu;

fn no_hit() -> Hit {
    return Hit(FAR, NO_CELL);
}

fn packed(cell: vec2i) -> u32 {
    return u32(cell.x) | (u32(cell.y) << 16u);
}

fn unpacked(cell: u32) -> vec2u {
    return vec2u(cell & 0xffffu, cell >> 16u);
}
