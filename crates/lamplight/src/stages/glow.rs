//! Cells that glow, as media: the form in which every method reads them.
//!
//! Crossing `s` px of a cell of extinction σ_t, source radiance S and emission coefficient j adds
//! `(1 − T(s))·S + j·(1 − T(s))/σ_t`, which is `(1 − T(s))·S'` with `S' = S + j/σ_t`: a medium that
//! glows is one of more source radiance. Empty space has no extinction, so a cell that glows gets a
//! tint just under 1, [`THINNEST`]. The change of extinction is small enough to be neglected (a lamp of
//! 12 px blocks 0.04 %), and the light that is added stays exact, because S' refers to the extinction
//! that rays meet.

use crate::math::transmittance::extinction;
use crate::{Cells, Matter};

/// The largest tint of a cell that glows. 1 − THINNEST is a power of 2, so that the extinction is exact.
pub const THINNEST: f32 = 1.0 - 1.0 / 65536.0;

/// The cells that glow, as they were before they became media.
#[derive(Debug, Default)]
pub struct Glow {
    before: Vec<(usize, Matter)>,
}

impl Glow {
    /// Turns cells that glow into media. Their emission coefficient stays, and no method reads it.
    pub fn to_media(&mut self, cells: &mut Cells) {
        self.before.clear();
        let glowing = (0..).zip(cells.glow().unwrap_or_default());
        let glowing = glowing.filter(|(_, glow)| **glow != [0.0; 3]).map(|(i, _)| i);
        self.before.extend(glowing.map(|i| (i, cells.matter(i))));
        for &(i, matter) in &self.before {
            cells.set_matter(i, medium(matter));
        }
    }

    /// Turns them back.
    pub fn restore(&self, cells: &mut Cells) {
        for &(i, matter) in &self.before {
            cells.set_matter(i, matter);
        }
    }
}

/// Returns the medium that adds the light of matter that glows. Solid matter does not glow.
pub fn medium(matter: Matter) -> Matter {
    if matter.opacity >= 1.0 {
        return matter;
    }
    let tint = matter.tint.map(|t| t.min(THINNEST));
    let own = extinction(matter.opacity, matter.tint);
    let seen = extinction(matter.opacity, tint);
    // What is emitted and scattered by the matter's own extinction stays what it was.
    let emission = |c: usize| (own[c] * matter.emission[c] + matter.glow[c]) / seen[c];
    let albedo = |c: usize| matter.albedo[c] * (own[c] / seen[c]);
    Matter {
        emission: std::array::from_fn(emission),
        albedo: std::array::from_fn(albedo),
        tint,
        ..matter
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::transmittance::attenuation;

    /// Rounding of a few operations of f32, and the extinction of [`THINNEST`] over 8 px.
    const TOLERANCE: f32 = 2e-4;

    /// Radiance added by crossing `s` px of a cell, by the definition, in f64.
    fn added(matter: Matter, s: f64) -> [f64; 3] {
        std::array::from_fn(|c| {
            let kept = (1.0 - f64::from(matter.opacity)) * f64::from(matter.tint[c]);
            let (sigma, glow) = (-kept.ln(), f64::from(matter.glow[c]));
            let absorbed = -(-sigma * s).exp_m1();
            let per_glow = if sigma == 0.0 { s } else { absorbed / sigma };
            absorbed * f64::from(matter.emission[c]) + glow * per_glow
        })
    }

    #[test]
    fn the_medium_adds_what_the_glow_adds() {
        let glow = [3.0, 1.0, 0.25];
        let plain = Matter { glow, ..Matter::EMPTY };
        for matter in [
            plain,
            Matter { emission: [9.0; 3], albedo: [0.5; 3], ..plain },
            Matter { opacity: 0.3, emission: [2.0, 0.0, 1.0], ..plain },
            Matter { opacity: 1e-4, tint: [1.0, 0.5, 0.9], emission: [1.0; 3], ..plain },
        ] {
            let medium = medium(matter);
            let sigma = extinction(medium.opacity, medium.tint);
            for s in [0.01, 0.4, 1.0, 8.0] {
                for (c, want) in added(matter, s).into_iter().enumerate() {
                    let got = attenuation(sigma[c] * s as f32).1 * medium.emission[c];
                    assert!((f64::from(got) / want - 1.0).abs() < TOLERANCE.into(), "{matter:?}");
                }
            }
        }
        let scattered = medium(Matter { albedo: [0.5; 3], ..plain }).albedo;
        assert_eq!(scattered, [0.0; 3], "what does not absorb does not scatter");
        let wall = Matter { opacity: 1.0, ..plain };
        assert_eq!(medium(wall), wall);
    }

    #[test]
    fn cells_are_restored() {
        let mut cells = Cells::new(3, 2).unwrap();
        cells.set(1, 1, Matter { glow: [1.0; 3], ..Matter::EMPTY });
        cells.set(2, 0, Matter { opacity: 0.5, emission: [1.0; 3], ..Matter::EMPTY });
        let (before, mut glow) = (cells.clone(), Glow::default());
        glow.to_media(&mut cells);
        assert!(cells.tint()[4] == [THINNEST; 3] && cells.get(2, 0) == before.get(2, 0));
        glow.restore(&mut cells);
        assert!(cells == before);
    }
}
