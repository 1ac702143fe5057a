//! Scenes whose light is known in closed form.
//!
//! All values are of one channel. Radiance `L` and all results have the same unit; lengths are px,
//! angles radians, extinction 1/px. Functions named `…_mean_radiance` return J, the mean radiance over
//! all directions: the integral of `L` over the angle that the source subtends, ÷ 2π.

use std::f64::consts::{FRAC_2_PI, PI, TAU};

/// Panels of the quadratures. For the smooth integrands here, the error is far below f32's resolution.
const PANELS: u32 = 4096;

/// Mean radiance of a disc of radius `r` that emits radiance `l`, seen from `d` > r:
/// `J = (1/2π)·2L·asin(r/d)`. Far away it falls off as 1/d.
pub fn disc_mean_radiance(l: f64, r: f64, d: f64) -> f64 {
    2.0 * l * (r / d).asin() / TAU
}

/// Mean radiance at `p` of a glowing segment from `a` to `b`: `J = (1/2π)·L·∠APB`.
pub fn segment_mean_radiance(l: f64, p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    l * angle_between(p, a, b) / TAU
}

/// Mean radiance at `p`, outside it, of a glowing axis-aligned box from `min` to `max`: its outline
/// subtends the widest angle between two of its corners.
pub fn rect_mean_radiance(l: f64, p: [f64; 2], min: [f64; 2], max: [f64; 2]) -> f64 {
    let corners = [min, [max[0], min[1]], max, [min[0], max[1]]];
    let widest = corners
        .iter()
        .flat_map(|&a| corners.iter().map(move |&b| angle_between(p, a, b)))
        .fold(0.0, f64::max);
    l * widest / TAU
}

/// The angle under which `p` sees the segment from `a` to `b`, 0 to π.
fn angle_between(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let [u, v] = [a, b].map(|q| [q[0] - p[0], q[1] - p[1]]);
    (u[0] * v[1] - u[1] * v[0]).abs().atan2(u[0] * v[0] + u[1] * v[1])
}

/// Mean radiance of half of all directions: an endless glowing wall. `J = (1/2π)·πL = L/2`.
pub fn half_plane_mean_radiance(l: f64) -> f64 {
    PI * l / TAU
}

/// Mean radiance under the same sky in all directions: `J = L`.
pub fn uniform_sky_mean_radiance(l: f64) -> f64 {
    l
}

/// Mean radiance under a sky that is linear in the sine of the elevation, from `horizon` to `zenith`
/// above and `ground` below: `J = H + ((Z − H) + (G − H))/π`, as the mean of |sin| over the half
/// of all directions in which it counts is 2/π.
pub fn gradient_sky_mean_radiance(zenith: f64, horizon: f64, ground: f64) -> f64 {
    horizon + 0.5 * FRAC_2_PI * ((zenith - horizon) + (ground - horizon))
}

/// Mean radiance in a penumbra. An emitter of width `w`, centred on x = 0, lies at height `big_d` above
/// the plane of a blocker that covers x < 0; the receiver is at (s, −h):
/// `J = (L/2π)[atan((w/2 − s)/(h + D)) − atan((max(−w/2, −sD/h) − s)/(h + D))]`, 0 where
/// −sD/h ≥ w/2.
pub fn penumbra_mean_radiance(l: f64, w: f64, big_d: f64, s: f64, h: f64) -> f64 {
    let edge = -s * big_d / h;
    if edge >= w / 2.0 {
        return 0.0;
    }
    let angle = |x: f64| ((x - s) / (h + big_d)).atan();
    l * (angle(w / 2.0) - angle(edge.max(-w / 2.0))) / TAU
}

/// Mean radiance at the centre of a disc of radius `r` of a uniform medium with source `e` and extinction
/// `sigma`, in the dark: `J = (1/2π)·2πe(1 − e^(−σR))`.
pub fn medium_disc_mean_radiance(e: f64, sigma: f64, r: f64) -> f64 {
    e * -(-sigma * r).exp_m1()
}

/// Mean radiance at the centre of an axis-aligned square of half-side `a` of the same medium:
/// `J = (4/π)·e·∫₀^(π/4) (1 − e^(−σa/cosθ)) dθ`, by quadrature. The form that cells can hold.
pub fn medium_square_mean_radiance(e: f64, sigma: f64, a: f64) -> f64 {
    4.0 / PI * integral(0.0, PI / 4.0, |theta| e * -(-sigma * a / theta.cos()).exp_m1())
}

/// Mean radiance at the centre of an axis-aligned square of half-side `a` of emission coefficient `j`, in
/// empty space: `J = (4/π)·∫₀^(π/4) j·a/cosθ dθ = (4/π)·j·a·ln(1 + √2)`. In fog of extinction σ it is
/// [`medium_square_mean_radiance`] of the source j/σ.
pub fn glow_square_mean_radiance(j: f64, a: f64) -> f64 {
    4.0 / PI * j * a * (1.0 + 2f64.sqrt()).ln()
}

/// Mean radiance at a distance `d` ≥ 0 from the centre of a disc of radius `r` and emission coefficient
/// `j`: `J = (1/2π)·∫ j·s(θ) dθ` over the chords s, by quadrature (outside, in `d·sinθ = r·sin u`). Far
/// away it is that of an opaque disc of radiance `πjr/2`.
pub fn glow_disc_mean_radiance(j: f64, r: f64, d: f64) -> f64 {
    if d < r {
        let to_edge = |t: f64| d * t.cos() + (r * r - (d * t.sin()).powi(2)).sqrt();
        return j * integral(0.0, TAU, to_edge) / TAU;
    }
    let integrand = |u: f64| {
        let sin = r / d * u.sin();
        2.0 * r * u.cos() * r / d * u.cos() / (1.0 - sin * sin).sqrt()
    };
    j * integral(-PI / 2.0, PI / 2.0, integrand) / TAU
}

/// Mean radiance of a disc of radius `r` and radiance `l` seen from `d` through fog of extinction `sigma`
/// that fills all space (and emits no light itself):
/// `J = (1/2π)·L∫exp(−σ(d·cosθ − √(r² − d² sin²θ)))dθ` over |θ| < asin(r/d), by quadrature (in
/// `d·sinθ = r·sin u`, which takes the edge out of the root).
pub fn disc_through_fog_mean_radiance(l: f64, r: f64, d: f64, sigma: f64) -> f64 {
    let integrand = |u: f64| {
        let sin = r / d * u.sin();
        let cos = (1.0 - sin * sin).sqrt();
        (-sigma * (d * cos - r * u.cos())).exp() * r / d * u.cos() / cos
    };
    l * integral(-PI / 2.0, PI / 2.0, integrand) / TAU
}

/// Mean radiance in a furnace, a closed box whose every wall has emission `e` and albedo `rho`, after
/// `bounces` bounces: `J = E(1 − ρ^(k+1))/(1 − ρ)`; `None` is all of them, `E/(1 − ρ)`.
pub fn furnace_mean_radiance(e: f64, rho: f64, bounces: Option<u32>) -> f64 {
    match bounces {
        Some(k) => (0..=k).map(|i| e * rho.powi(i as i32)).sum(),
        None => e / (1.0 - rho),
    }
}

/// Outgoing radiance of a diffuse ring of radius `ring` and albedo `a`, lit by a black
/// (ρ = 0) disc of radius `r1` and radiance `l` at its centre, after all bounces:
/// `aL(r₁/R)/(1 − a(1 − r₁/R))`. (The irradiance of its faces, normalised as E/2, is this ÷ a.)
pub fn ring_radiance(l: f64, r1: f64, ring: f64, a: f64) -> f64 {
    let seen = r1 / ring;
    a * l * seen / (1.0 - a * (1.0 - seen))
}

/// Mean radiance inside that ring, `d` > r₁ from the centre: the disc subtends asin(r₁/d)/π of all
/// directions, the ring the rest.
pub fn ring_mean_radiance(l: f64, r1: f64, ring: f64, a: f64, d: f64) -> f64 {
    let disc = (r1 / d).asin() / PI;
    disc * l + (1.0 - disc) * ring_radiance(l, r1, ring, a)
}

/// Simpson's rule.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let h = (to - from) / f64::from(PANELS);
    let inner: f64 =
        (1..PANELS).map(|i| f(from + f64::from(i) * h) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (f(from) + inner + f(to)) * h / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a handful of f64 operations, and of quadrature.
    const ROUNDING: f64 = 1e-9;

    fn same(a: f64, b: f64) {
        assert!((a - b).abs() < ROUNDING, "{a} is not {b}");
    }

    #[test]
    fn forms_agree_where_they_describe_the_same_scene() {
        // A disc far away is a segment; fog of no extinction is none; a segment without end is
        // half of everything; a box is the side that is seen; thick fog is its source.
        let far = disc_mean_radiance(3.0, 1.0, 1e6);
        assert!(
            (far / segment_mean_radiance(3.0, [0.0; 2], [1e6, -1.0], [1e6, 1.0]) - 1.0).abs()
                < 1e-6
        );
        same(
            disc_through_fog_mean_radiance(2.0, 5.0, 12.0, 0.0),
            disc_mean_radiance(2.0, 5.0, 12.0),
        );
        same(
            segment_mean_radiance(1.0, [0.0, 1e-12], [-1e6, 0.0], [1e6, 0.0]),
            half_plane_mean_radiance(1.0),
        );
        same(
            rect_mean_radiance(1.0, [0.0, 0.0], [4.0, -2.0], [9.0, 2.0]),
            segment_mean_radiance(1.0, [0.0, 0.0], [4.0, -2.0], [4.0, 2.0]),
        );
        same(medium_disc_mean_radiance(0.5, 100.0, 1.0), uniform_sky_mean_radiance(0.5));
        same(medium_square_mean_radiance(0.5, 1e4, 1.0), 0.5);
        same(gradient_sky_mean_radiance(0.7, 0.7, 0.7), uniform_sky_mean_radiance(0.7));
        same(furnace_mean_radiance(1.0, 0.5, Some(60)), furnace_mean_radiance(1.0, 0.5, None));
        same(furnace_mean_radiance(2.0, 1.0, Some(3)), 8.0);
        // Thin media: the first term of the exponential.
        let thin = medium_square_mean_radiance(1.0, 1e-6, 1.0);
        assert!((thin / glow_square_mean_radiance(1e-6, 1.0) - 1.0).abs() < 1e-5, "{thin}");
        // The chords from the middle of a disc are its radius; far away it is an opaque one.
        same(glow_disc_mean_radiance(2.0, 3.0, 0.0), 6.0);
        let far = glow_disc_mean_radiance(2.0 / (PI * 3.0), 3.0, 300.0);
        assert!((far / disc_mean_radiance(1.0, 3.0, 300.0) - 1.0).abs() < 1e-4, "{far}");
        assert!(
            (glow_disc_mean_radiance(1.0, 3.0, 2.999) / glow_disc_mean_radiance(1.0, 3.0, 3.001)
                - 1.0)
                .abs()
                < 1e-2
        );
    }

    #[test]
    fn figures_known_from_elsewhere() {
        assert!((ring_radiance(1.0, 10.0, 50.0, 0.7) - 0.31818).abs() < 5e-6);
        same(disc_mean_radiance(1.0, 1.0, 2.0), 1.0 / 6.0);
        same(half_plane_mean_radiance(1.0), 0.5);
    }

    #[test]
    fn a_penumbra_runs_from_nothing_to_the_whole_emitter() {
        let (w, d, h) = (8.0, 20.0, 10.0);
        // The last ray past the blocker's edge to the emitter's right end, and to its left end.
        let (dark, lit) = (-w / 2.0 * h / d, w / 2.0 * h / d);
        same(penumbra_mean_radiance(1.0, w, d, dark - 1e-9, h), 0.0);
        let whole = segment_mean_radiance(1.0, [lit, -h], [-w / 2.0, d], [w / 2.0, d]);
        same(penumbra_mean_radiance(1.0, w, d, lit, h), whole);
        let mut before = 0.0;
        for i in 1..=100 {
            let s = dark + (lit - dark) * f64::from(i) / 100.0;
            let here = penumbra_mean_radiance(1.0, w, d, s, h);
            assert!(here > before, "{s}");
            before = here;
        }
    }

    #[test]
    fn a_sky_gradient_is_its_own_integral() {
        let (zenith, horizon, ground) = (0.9, 0.4, 0.1);
        let numeric = integral(0.0, PI / 2.0, |angle| {
            let share = angle.sin();
            0.5 * (horizon + (zenith - horizon) * share)
                + 0.5 * (horizon + (ground - horizon) * share)
        }) / (PI / 2.0);
        same(gradient_sky_mean_radiance(zenith, horizon, ground), numeric);
    }
}
