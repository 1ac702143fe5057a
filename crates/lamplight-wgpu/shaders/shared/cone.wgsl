// The cone of a lamp or a viewer: its direction, half its angle (negative without a cone), and the soft part of that
// half.

const TURN: f32 = 6.2831855;

// The angle between the axis of a cone and a direction from −π to 2π: −π to π.
fn beside_axis(cone: vec3f, at: f32) -> f32 {
    var rotated = at - cone.x;
    // The direction is at most a little over one turn to either side.
    rotated += select(0.0, TURN, rotated < 0.0);
    rotated += select(0.0, TURN, rotated < 0.0);
    rotated -= select(0.0, TURN, rotated >= TURN);
    return select(rotated, rotated - TURN, rotated > 0.5 * TURN);
}

// The fraction of light that leaves at an angle from −π to 2π: smoothstep over the soft edge.
fn cone_share(cone: vec3f, at: f32) -> f32 {
    if cone.y < 0.0 {
        return 1.0;
    }
    let within = cone.y - abs(beside_axis(cone, at));
    if within < 0.0 {
        return 0.0;
    }
    if within >= cone.z {
        return 1.0;
    }
    let t = within / cone.z;
    return t * t * (3.0 - 2.0 * t);
}
