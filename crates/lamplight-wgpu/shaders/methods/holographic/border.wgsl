// The light behind the last plane and beside the rows of a quadrant: that of the sky in each cone or, with INFLOW, the light
// that enters the grid where the middle of the cone leaves it (`border.rs` of the library). The importing shader binds the
// table `cones`, which then has, in place of a panorama's light, what each cone sees: the first column of a strip, their
// number, the slope of the middle, and the entry at which the weights of the columns begin, four to an entry.

#import methods/holographic/light_pair
#import methods/holographic/sky
#import shared/sky

// The light of a cone, by its entry, at a point of the lattice beyond the border.
fn beyond(entry: u32, slab: u32, row: i32) -> vec3f {
    if !INFLOW {
        return sky_at(entry);
    }
    return cones[entry].x * entering_in(cones[entry + sweep.sky], slab, row);
}

// The light of two cones beside each other, by the entry of the first. One of them may be another level's: it is dropped.
fn pair_beyond(entry: u32, slab: u32, row: i32) -> LightPair {
    if !INFLOW {
        return LightPair(sky_at(entry), sky_at(entry + 1u));
    }
    let see_the_same = all(cones[entry + sweep.sky] == cones[entry + 1u + sweep.sky]);
    // Not in an array, since one that is indexed in a loop lies in memory.
    var first = vec3f(0.0);
    var second = vec3f(0.0);
    for (var i = 0u; i < select(2u, 1u, see_the_same); i++) {
        first = second;
        second = entering_in(cones[entry + i + sweep.sky], slab, row);
    }
    first = select(first, second, see_the_same);
    return LightPair(cones[entry].x * first, cones[entry + 1u].x * second);
}

// The mean light that a cone sees, as the table has it.
fn entering_in(view: vec4f, slab: u32, row: i32) -> vec3f {
    let slope = view.z;
    let size = vec2f(vec2u(sweep.depth, sweep.rows));
    let at = vec2f(f32(slab), f32(row)) + 0.5;
    let back = sweep.reversed == 1u;
    // The far end: the right, the left, the bottom, the top.
    var side = select(1u + sweep.axis, 3u - 3u * sweep.axis, back);
    var along = at.y + slope * (size.x - at.x);
    if slope != 0.0 && (along < 0.0 || along > size.y) {
        let high = slope > 0.0;
        side = select(3u * sweep.axis, 2u - sweep.axis, high);
        along = at.x + (select(0.0, size.y, high) - at.y) / slope;
        along = select(along, size.x - along, back);
    }
    // Light is linear between points.
    let points = select(vec2u(sweep.rows, sweep.depth), vec2u(sweep.depth, sweep.rows), sweep.axis == 0u);
    let last = points[side & 1u] - 1u;
    let place = clamp(along - 0.5, 0.0, f32(last));
    let past = fract(place);
    let strip = (side & 1u) * points.x + (side >> 1u) * (points.x + points.y) + u32(place);
    let next_strip = strip + select(0u, 1u, u32(place) < last);
    var texel = on_strip(strip, view.x);
    var next_texel = on_strip(next_strip, view.x);
    var light = vec3f(0.0);
    for (var column = 0u; column < u32(view.y); column++) {
        let weight = cones[u32(view.w) + column / 4u][column % 4u];
        light += weight * mix(textureLoad(panorama, texel, 0).rgb, textureLoad(panorama, next_texel, 0).rgb, past);
        texel = next_on_strip(strip, texel);
        next_texel = next_on_strip(next_strip, next_texel);
    }
    return light;
}
