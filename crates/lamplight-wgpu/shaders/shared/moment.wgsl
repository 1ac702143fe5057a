// The first moment of light: behind the light of all cells its x components, and behind those its y components.

#import shared/uniforms

// True if it is found.
override MOMENT: bool = false;

// The moment of light, shortened where it is longer than light may have: where lamps have taken light from other
// directions than it came from.
fn limited(moment: array<vec3f, 2>, light: vec3f) -> array<vec3f, 2> {
    let length = sqrt(moment[0] * moment[0] + moment[1] * moment[1]);
    let longest = frame.longest_moment * light;
    let share = select(vec3f(1.0), longest / length, length > longest);
    return array(moment[0] * share, moment[1] * share);
}

// The place of a component of a cell's moment, 0 for x and 1 for y.
fn moment_index(component: u32, i: u32) -> u32 {
    return (1u + component) * frame.size.x * frame.size.y + i;
}
