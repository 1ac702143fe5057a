// The transmittance along a ray through media as a piecewise function, a deep shadow map (Lokovic and Veach
// 2000): optical depth as a polyline over the distance. Its corners are found as `transmittance_curve.rs` of
// the library finds them, so that the same ones are merged. The importing shader defines
// `keep(corner, number)`, which is called for each corner in order, once it is final.

#import shared/lamps

override FINEST: f32;
override APART: f32;

// A corner: the optical depth up to it, and in `w` its distance.
alias Corner = vec4f;

var<private> kept: u32;
// Distance from which corners are never merged, px.
var<private> apart: f32;
var<private> before: f32;
var<private> last: Corner;
var<private> last_extinction: vec3f;

fn begin_curve(lamp: Lamp) {
    kept = 0u;
    apart = max(lamp.reach * FINEST, APART);
}

fn settle(corner: Corner) {
    before = corner.w;
    keep(corner, kept);
    kept += 1u;
}

// Appends a medium that the ray crosses between two distances.
fn append_medium(enter: f32, leave: f32, extinction: vec3f) {
    let depth = extinction * max(leave - enter, 0.0);
    if kept == 0u {
        settle(Corner(vec3f(0.0), enter));
        last = Corner(depth, leave);
        last_extinction = extinction;
        return;
    }
    let same = last.w == enter && all(last_extinction == extinction);
    if same || leave - before < apart {
        last = Corner(last.xyz + depth, leave);
        return;
    }
    let done = last;
    settle(done);
    if done.w < enter {
        settle(Corner(done.xyz, enter));
    }
    last = Corner(done.xyz + depth, leave);
    last_extinction = extinction;
}

fn end_curve() {
    if kept > 0u {
        settle(last);
    }
}

// The optical depth between two corners.
fn between(a: Corner, b: Corner, distance: f32) -> vec3f {
    return a.xyz + (b.xyz - a.xyz) * ((distance - a.w) / (b.w - a.w));
}
