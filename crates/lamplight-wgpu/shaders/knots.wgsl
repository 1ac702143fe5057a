// Fog and glass along a ray of a fan: the logarithm of the transmittance is a polyline over the
// distance, whose corners are found as `knots.rs` of the library finds them, so that those that
// are melted together are the same. `keep(knot)` is told of each in order, once it is settled.

override FINEST: f32;
override APART: f32;

// A corner: the logarithm up to here, and the distance.
alias Knot = vec4f;

var<private> kept: u32;
// px between knots that are always kept apart.
var<private> apart: f32;
var<private> before: f32;
var<private> last: Knot;
var<private> last_matter: vec3f;

fn begin_knots(lamp: Lamp) {
    kept = 0u;
    apart = max(lamp.reach * FINEST, APART);
}

fn settle(knot: Knot) {
    before = knot.w;
    keep(knot, kept);
    kept += 1u;
}

// The ray at hand crosses matter between two distances.
fn medium(from_: f32, to: f32, logarithm: vec3f) {
    let crossed = logarithm * max(to - from_, 0.0);
    if kept == 0u {
        settle(Knot(vec3f(0.0), from_));
        last = Knot(crossed, to);
        last_matter = logarithm;
        return;
    }
    let same = last.w == from_ && all(last_matter == logarithm);
    if same || to - before < apart {
        last = Knot(last.xyz + crossed, to);
        return;
    }
    let known = last;
    settle(known);
    if known.w < from_ {
        settle(Knot(known.xyz, from_));
    }
    last = Knot(known.xyz + crossed, to);
    last_matter = logarithm;
}

fn end_knots() {
    if kept > 0u {
        settle(last);
    }
}

// Logarithm between two knots.
fn between(a: Knot, b: Knot, distance: f32) -> vec3f {
    return a.xyz + (b.xyz - a.xyz) * ((distance - a.w) / (b.w - a.w));
}
