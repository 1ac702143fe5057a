// The light behind the last plane and beside the rows of a quadrant: that of the sky in each cone or, with INFLOW, the light
// that enters the grid where the middle of the cone leaves it (`border.rs` of the library). The importing shader binds the
// table `cones`, which then has, in place of a panorama's light, the columns between which each cone lies and the slope of
// its middle.

#import methods/holographic/sky
#import shared/inflow

// The light of a cone, by its entry, at a point of the lattice beyond the border.
fn beyond(entry: u32, slab: u32, row: i32) -> vec3f {
    if !INFLOW {
        return sky_at(entry);
    }
    let cone = cones[entry + sweep.sky];
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
    return cones[entry].x * entering_between_points(side, along, sweep.spacing_level, cone.xy);
}
