// Intervals that are there already, of a level whose floats `word` reads; ⟨0, 1⟩ outside the grid.
fn load(level: u32, plane: u32, ray: u32, row: i32) -> Interval {
    if row < 0 || row >= i32(sweep.rows) || plane >= planes(level) {
        return nothing();
    }
    let at = place(level, plane, ray, u32(row));
    let next = sweep.rows;
    let light = vec3f(word(level, at), word(level, at + next), word(level, at + 2u * next));
    var through = vec3f(word(level, at + 3u * next));
    if WORDS == 6u {
        through.g = word(level, at + 4u * next);
        through.b = word(level, at + 5u * next);
    }
    return Interval(light, through);
}
