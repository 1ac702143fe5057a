// The light behind the last plane and beside the rows of a quadrant: that of the sky in each cone or, with INFLOW, the light
// that enters the grid where the middle of the cone leaves it (`border.rs` of the library). The importing shader binds the
// table `cones`, which then has, in place of a panorama's light, the columns between which each cone sees, the slope of the
// middle, and the number of its ray, from 1 on, if both half cones along it see the same.

#import methods/holographic/light_pair
#import methods/holographic/sky
#import shared/inflow

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
    let ray = cones[entry + sweep.sky].w;
    let see_the_same = ray > 0.0 && ray == cones[entry + 1u + sweep.sky].w;
    var seen: array<vec3f, 2>;
    for (var i = 0u; i < select(2u, 1u, see_the_same); i++) {
        seen[i] = entering_in(cones[entry + i + sweep.sky], slab, row);
    }
    let second = select(seen[1], seen[0], see_the_same);
    return LightPair(cones[entry].x * seen[0], cones[entry + 1u].x * second);
}

// The mean light that a cone sees, as the table has it.
fn entering_in(cone: vec4f, slab: u32, row: i32) -> vec3f {
    let slope = cone.z;
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
    return entering_between_points(side, along, sweep.spacing_level, cone.xy);
}
