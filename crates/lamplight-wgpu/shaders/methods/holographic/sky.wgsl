// The light of the sky in the cones of a quadrant. The importing shader binds the table `cones`. For each cone of
// each level it has the angle, and the weights of a gradient: ∫ dθ, ∫ |sin θ| dθ of both signs, up and down the rows,
// ∫ cos θ dθ. After all cones it has the light of a panorama in them, if the sky is one, quadrant by quadrant.

#import methods/holographic/sweep

// The light of the sky in a cone of the level above.
fn sky_in(cone: u32) -> vec3f {
    return sky_at(sweep.cones_above + cone);
}

// The light of the sky in the cone of an entry.
fn sky_at(entry: u32) -> vec3f {
    let is_panorama = frame.sky_columns > 0u;
    let part = cones[entry + select(0u, sweep.sky, is_panorama)];
    if is_panorama {
        return part.rgb;
    }
    if sweep.axis == 0u {
        return frame.horizon * (part.x - part.y - part.z) + frame.zenith * part.y + frame.ground * part.z;
    }
    let ahead = select(frame.ground, frame.zenith, sweep.reversed == 1u);
    return frame.horizon * (part.x - part.w) + ahead * part.w;
}
