// The layers of cells, between which lamps and suns choose by their mask.
//
// The importing shader binds `masks`: the layers of each cell as bits of a byte, or a single texel for all cells.

fn layers_of(cell: vec2u) -> u32 {
    return u32(textureLoad(masks, min(cell, textureDimensions(masks) - 1u), 0).r * 255.0 + 0.5);
}
