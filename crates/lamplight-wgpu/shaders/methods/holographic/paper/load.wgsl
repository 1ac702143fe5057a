#import methods/holographic/paper/interval

// A stored interval of a level. The importing shader defines `word(level, at)`, which reads its floats.
// Space outside the grid is empty.
fn load(level: u32, plane: u32, ray: u32, row: i32) -> Interval {
    if row < 0 || row >= i32(sweep.rows) || plane >= planes(level) {
        return nothing();
    }
    let at = place(level, plane, ray, u32(row));
    let next = sweep.rows;
    let light = vec3f(word(level, at), word(level, at + next), word(level, at + 2u * next));
    var transmittance = vec3f(word(level, at + 3u * next));
    if WORDS == 6u {
        transmittance.g = word(level, at + 4u * next);
        transmittance.b = word(level, at + 5u * next);
    }
    return Interval(light, transmittance);
}
