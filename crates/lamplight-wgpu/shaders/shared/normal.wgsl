// The normal of a cell's face. Faces are left, right, top, bottom.
fn normal(face: u32) -> vec2i {
    let away = select(1i, -1i, (face & 1u) == 0u);
    return select(vec2i(0i, away), vec2i(away, 0i), face < 2u);
}
