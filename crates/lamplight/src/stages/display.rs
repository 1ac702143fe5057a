//! From linear light to a picture: exposure, tone map, sRGB.
//!
//! The final picture shows, per channel and in linear light,
//! `color × (light + ambient) + (1 − T)·L_e + j·(1 − T)/σ_t`, with `T = (1 − opacity)·tint` over 1 px: the
//! background lit by the light and by an even ambient light, plus the radiance that 1 px of the cell emits. In a
//! solid cell [`Light`] already includes the emission L_e in addition to the light on the faces, so the picture
//! there is `color × (light − L_e + ambient) + L_e`. Lamps are shown if they are visible, by their radiance. That
//! sum × 2^exposure is tone mapped to 0 to 1 and then encoded as sRGB, once.

use crate::{Cells, Error, Light, Matter, Relief, Result, Rgb, check, notation, srgb};
use image::RgbImage;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The curve that maps unbounded light to 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ToneMap {
    /// Clips at 1.
    None,
    /// `x / (1 + x)` per channel (Reinhard et al. 2002, equation 3): never clips; low contrast.
    Reinhard,
    /// A film-like curve (Narkowicz 2015), with highlights that turn white (as in the Unity port).
    Aces,
    /// AgX (Sobotka 2022), in the polynomial form of Wrensch (2023): soft, keeps hues of very
    /// bright lights from skewing.
    Agx,
    /// AgX with a look: half a stop brighter, more contrast and stronger colours. Bright lights keep their
    /// hue as in `agx`.
    #[default]
    Vivid,
}

impl ToneMap {
    /// Every tone map, in the order in which lists show them.
    pub const ALL: &'static [Self] =
        &[Self::None, Self::Reinhard, Self::Aces, Self::Agx, Self::Vivid];

    /// The name in files and flags.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Reinhard => "reinhard",
            Self::Aces => "aces",
            Self::Agx => "agx",
            Self::Vivid => "vivid",
        }
    }

    /// Maps linear radiance to linear 0 to 1, ready for sRGB. Negative values and NaN count as 0,
    /// infinity as very bright.
    pub fn map(self, rgb: Rgb) -> Rgb {
        // All curves are flat long before the cap; it keeps their squares finite.
        let rgb = rgb.map(|v| if v > 0.0 { v.min(BRIGHTEST) } else { 0.0 });
        let mapped = match self {
            Self::None => rgb,
            Self::Reinhard => rgb.map(|v| v / (1.0 + v)),
            Self::Aces => aces(rgb),
            Self::Agx => agx(rgb, AGX_PLAIN),
            Self::Vivid => agx(rgb, AGX_VIVID),
        };
        mapped.map(|v| v.clamp(0.0, 1.0))
    }
}

/// The radiance above which no tone map changes its 8-bit result.
pub const BRIGHTEST: f32 = 1e9;

/// Narkowicz's fit of the ACES curve (2015), `x(ax + b) / (x(cx + d) + e)`: a to e.
pub const ACES: [f32; 5] = [2.51, 0.03, 2.43, 0.59, 0.14];
/// Luma² ÷ (this + luma) is the fraction of white in `aces`.
pub const ACES_WHITE: f32 = 12.0;
/// Luma of linear RGB as `aces` weighs it (Rec. 601).
pub const ACES_LUMA: Rgb = [0.299, 0.587, 0.114];

/// AgX: the matrix to the primaries of its curve, row by row (Wrensch 2023).
pub const AGX_INSET: [Rgb; 3] = [
    [0.842_479_06, 0.078_433_6, 0.079_223_745],
    [0.042_328_24, 0.878_468_6, 0.079_166_13],
    [0.042_375_655, 0.078_433_6, 0.879_143],
];
/// AgX: the matrix back from those primaries, row by row.
pub const AGX_OUTSET: [Rgb; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];
/// AgX: the range of log2 of radiance that it distinguishes.
pub const AGX_STOPS: [f32; 2] = [-12.473_93, 4.026_069];
/// AgX: the contrast curve, coefficients of x⁶ … x⁰.
pub const AGX_CONTRAST: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.002_32];
/// AgX: the gamma of the display that its curve is for.
pub const AGX_GAMMA: f32 = 2.2;
/// AgX without a look: [gain, power, saturation] of 1.
pub const AGX_PLAIN: [f32; 3] = [1.0; 3];
/// The look of `vivid`: [gain, power, saturation]. Sobotka's look "Punchy", without a gain and with 1.35 and
/// 1.4, makes dim colours garish.
pub const AGX_VIVID: [f32; 3] = [std::f32::consts::SQRT_2, 1.2, 1.3];

/// [`ACES`], as the Unity port of Bigos 2020 shows it: with brightness, a
/// pixel's colour blends to the curve of its luma.
///
/// In the port the fraction of white can exceed 1, which turns colours brighter than luma 4 into their
/// complements; here it is clamped to 1.
fn aces(rgb: Rgb) -> Rgb {
    let [a, b, c, d, e] = ACES;
    let curve = |x: f32| ((x * (a * x + b)) / (x * (c * x + d) + e)).clamp(0.0, 1.0);
    let luma = rgb[0] * ACES_LUMA[0] + rgb[1] * ACES_LUMA[1] + rgb[2] * ACES_LUMA[2];
    let white = (luma * luma / (ACES_WHITE + luma)).min(1.0);
    rgb.map(|v| curve(v) + (curve(luma) - curve(v)) * white)
}

/// Wrensch's minimal AgX (2023): rotate and desaturate the primaries, log2 over 16.5 stops, a
/// sixth-degree fit of the contrast curve, a look, back. The curve's output is for a display of gamma 2.2. A
/// look scales radiance, raises the curve to a power and scales the difference from its luma.
fn agx(rgb: Rgb, [gain, power, saturation]: [f32; 3]) -> Rgb {
    let rotate = |m: &[Rgb; 3], v: Rgb| -> Rgb {
        std::array::from_fn(|i| m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2])
    };
    let [darkest, brightest] = AGX_STOPS;
    let curve = |v: f32| {
        let x = (v.log2().clamp(darkest, brightest) - darkest) / (brightest - darkest);
        AGX_CONTRAST.iter().fold(0.0, |sum: f32, c| sum * x + c).max(0.0).powf(power)
    };
    let shown = rotate(&AGX_INSET, rgb.map(|v| gain * v)).map(curve);
    let luma = srgb::luminance(shown);
    let shown = shown.map(|v| luma + saturation * (v - luma));
    rotate(&AGX_OUTSET, shown).map(|v| v.max(0.0).powf(AGX_GAMMA))
}

/// The conversion of light to a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Display {
    /// The tone map.
    pub tonemap: ToneMap,
    /// Exposure in stops, −32 to 32: +1 doubles the light.
    pub exposure: f32,
    /// Light that every cell of the picture shows in addition, in walls too, linear RGB. It comes from all around, so
    /// normals do not change it.
    #[serde(deserialize_with = "notation::color", skip_serializing_if = "is_black")]
    #[schemars(with = "notation::Color")]
    pub ambient: Rgb,
    /// The lighting of cells that have a normal.
    #[serde(skip_serializing_if = "Relief::is_default")]
    pub relief: Relief,
}

fn is_black(rgb: &Rgb) -> bool {
    *rgb == [0.0; 3]
}

impl Display {
    /// Light as it is: no tone map, no exposure.
    pub const PLAIN: Self =
        Self { tonemap: ToneMap::None, exposure: 0.0, ambient: [0.0; 3], relief: Relief::DEFAULT };
    /// The largest valid exposure in stops, up or down.
    pub const MAX_EXPOSURE: f32 = 32.0;

    /// Rejects values that are NaN or out of range.
    pub fn check(&self) -> Result<()> {
        let range = -Self::MAX_EXPOSURE..=Self::MAX_EXPOSURE;
        if !range.contains(&self.exposure) {
            let expected = "a number of stops from -32 to 32";
            return Err(Error::value("exposure", self.exposure, expected));
        }
        check::radiance("ambient", self.ambient)?;
        self.relief.check()
    }

    /// Returns the factor of the exposure.
    pub fn gain(&self) -> f32 {
        self.exposure.exp2()
    }

    /// Encodes one pixel of linear radiance: exposure, tone map, sRGB bytes.
    pub fn encode(&self, rgb: Rgb) -> [u8; 3] {
        let gain = self.gain();
        self.tonemap.map(rgb.map(|v| v * gain)).map(srgb::encode_u8)
    }

    /// Encodes a picture of linear radiance in row order; missing pixels stay black.
    pub fn picture(&self, width: u32, height: u32, rgb: &[Rgb]) -> RgbImage {
        let mut picture = RgbImage::new(width, height);
        picture.par_chunks_mut(3).zip(rgb).for_each(|(to, from)| {
            to.copy_from_slice(&self.encode(*from));
        });
        picture
    }
}

impl Light {
    /// Returns the final picture: `cells` under this light, plus emission, encoded for the screen.
    ///
    /// # Errors
    /// Fails if the size of `cells` is not that of the light, or if a cell or a value of `display` is invalid.
    pub fn compose(&self, cells: &Cells, display: &Display) -> Result<RgbImage> {
        Ok(display.picture(self.width, self.height, &self.radiance(cells, display)?))
    }

    /// Returns the light alone as a picture.
    ///
    /// # Errors
    /// Fails if a value of `display` is invalid.
    pub fn picture(&self, display: &Display) -> Result<RgbImage> {
        display.check()?;
        Ok(display.picture(self.width, self.height, &self.rgb))
    }

    /// Returns the radiance that [`Self::compose`] shows, linear, before exposure and tone map, in row order. Normals
    /// count if the light has a first moment.
    ///
    /// # Errors
    /// Fails if the size of `cells` is not that of the light, or if a cell or a value of `display` is invalid.
    pub fn radiance(&self, cells: &Cells, display: &Display) -> Result<Vec<Rgb>> {
        display.check()?;
        // Colours may have changed since these cells were solved, which reads none.
        cells.check()?;
        if (cells.width(), cells.height()) != (self.width, self.height) {
            let size = |w: u32, h: u32| format!("{w}×{h}");
            return Err(Error::value(
                "cells",
                size(cells.width(), cells.height()),
                format!("the grid of the light, {}", size(self.width, self.height)),
            ));
        }
        let (drawn, shown) = (cells.drawn(), cells.shown());
        let relief = cells.normals().zip(self.moment.as_deref());
        let seen = |i: usize| -> Rgb {
            let matter = shown.matter(i);
            let color = cells.color().map_or([1.0; 3], |all| all[i]);
            let emitted = emitted(&matter);
            let mut light = self.rgb[i];
            if matter.opacity >= 1.0 {
                let own = drawn.emission()[i];
                (0..3).for_each(|c| light[c] = (light[c] - own[c]).max(0.0));
            }
            let mut highlight = [0.0; 3];
            if let Some((normals, moments)) = relief {
                (light, highlight) =
                    display.relief.shade(normals[i], light, &moments[i], self.elevation);
            }
            let lit = |c: usize| color[c] * (light[c] + display.ambient[c]);
            [0, 1, 2].map(|c| lit(c) + highlight[c] + emitted[c])
        };
        Ok((0..cells.len()).into_par_iter().map(seen).collect())
    }
}

/// Returns the radiance that 1 px of a cell emits; of a solid cell, its emission.
pub fn emitted(matter: &Matter) -> Rgb {
    if matter.opacity >= 1.0 {
        return matter.emission;
    }
    std::array::from_fn(|c| {
        let absorbed = 1.0 - (1.0 - matter.opacity) * matter.tint[c];
        absorbed * matter.emission[c] + per_glow(absorbed) * matter.glow[c]
    })
}

/// Returns the radiance that 1 px of an emission coefficient of 1 adds in a cell of this absorptance A over
/// 1 px: `A/σ_t = −A/ln(1 − A)`, by its series where that is 0 ÷ 0.
fn per_glow(absorbed: f32) -> f32 {
    match absorbed {
        1.0.. => 0.0,
        ..0.01 => 1.0 - absorbed / 2.0 - absorbed * absorbed / 12.0,
        _ => -absorbed / (1.0 - absorbed).ln(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;

    /// The tolerance of f32 arithmetic against values computed in f64.
    const ROUNDING: f32 = 2e-6;
    /// Wrensch's matrices have rows that sum to 1 only within 1.4e-4 and 1.1e-4; the contrast
    /// curve and gamma 2.2 enlarge that by at most their slope.
    const AGX_NEUTRAL: f32 = 1.5e-3;

    fn grey(map: ToneMap, v: f32) -> f32 {
        map.map([v; 3])[1]
    }

    fn near(found: f32, expected: f32, tolerance: f32) {
        assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
    }

    #[test]
    fn known_values() {
        for (v, none, reinhard, aces) in [
            (0.18, 0.18, 0.152_542_37, 0.266_898_92),
            (1.0, 1.0, 0.5, 0.803_797_5),
            (4.0, 1.0, 0.8, 0.973_417_1),
        ] {
            near(grey(ToneMap::None, v), none, ROUNDING);
            near(grey(ToneMap::Reinhard, v), reinhard, ROUNDING);
            near(grey(ToneMap::Aces, v), aces, ROUNDING);
        }
    }

    /// AgX keeps middle grey near its display value and maps white to the top of the curve.
    #[test]
    fn agx_known_values() {
        // The polynomial at the stops of 0.18 and of 2^4.026069, to the power 2.2 (f64).
        near(grey(ToneMap::Agx, 0.18), 0.214_519_1, AGX_NEUTRAL);
        near(grey(ToneMap::Agx, 100.0), 0.996_878_7, AGX_NEUTRAL);
        // The same values to the power 1.2, half a stop lower.
        let gain = std::f32::consts::FRAC_1_SQRT_2;
        near(grey(ToneMap::Vivid, 0.18 * gain), 0.214_519_1f32.powf(1.2), 1.5 * AGX_NEUTRAL);
        near(grey(ToneMap::Vivid, 100.0), 0.996_878_7f32.powf(1.2), 1.5 * AGX_NEUTRAL);
    }

    /// A flame of (16, 3, 0.1): `aces` bleaches it, AgX keeps some yellow, its look more.
    #[test]
    fn fire_keeps_its_colour() {
        let blue = |map: ToneMap| map.map([16.0, 3.0, 0.11])[2];
        let [aces, agx, vivid] = [ToneMap::Aces, ToneMap::Agx, ToneMap::Vivid].map(blue);
        assert!(aces > 0.99 && agx < 0.6 && vivid < agx, "{aces} {agx} {vivid}");
    }

    #[test]
    fn monotone_neutral_black() {
        for &map in ToneMap::ALL {
            assert_eq!(map.map([0.0; 3]), [0.0; 3], "{map:?}");
            let mut before = 0.0;
            for step in -160..120 {
                let v = (step as f32 / 8.0).exp2();
                let rgb = map.map([v; 3]);
                let tolerance = match map {
                    ToneMap::Agx => AGX_NEUTRAL,
                    ToneMap::Vivid => 2.0 * AGX_NEUTRAL,
                    _ => 0.0,
                };
                near(rgb[0], rgb[1], tolerance);
                near(rgb[2], rgb[1], tolerance);
                assert!(rgb[1] >= before - ROUNDING, "{map:?} falls at {v}: {before} → {}", rgb[1]);
                before = rgb[1];
            }
        }
    }

    #[test]
    fn finite_whatever_comes() {
        for &map in ToneMap::ALL {
            for v in [1e30, f32::MAX, f32::INFINITY, f32::NAN, -1.0, f32::MIN_POSITIVE] {
                for rgb in [[v; 3], [v, 0.0, 0.0], [0.0, v, 1.0]] {
                    let out = map.map(rgb);
                    assert!(
                        out.iter().all(|v| (0.0..=1.0).contains(v)),
                        "{map:?} {rgb:?}: {out:?}"
                    );
                }
            }
        }
        let white = Display { tonemap: ToneMap::Aces, ..Display::PLAIN }.encode([1e30; 3]);
        assert_eq!(white, [255; 3]);
    }

    /// In the Unity port the fraction of white exceeds 1, which gives a red light of 100 a cyan hue.
    #[test]
    fn bright_colours_turn_white_not_into_their_complement() {
        for v in [2.0, 10.0, 100.0, 1e6] {
            let [r, g, b] = ToneMap::Aces.map([v, 0.0, 0.0]);
            assert!(r >= g && r >= b, "red of {v} became {r} {g} {b}");
        }
        assert_eq!(ToneMap::Aces.map([1e6, 0.0, 0.0]), [1.0; 3]);
    }

    #[test]
    fn exposure_is_in_stops() {
        let one = |exposure| Display { exposure, ..Display::PLAIN }.encode([0.1; 3]);
        let direct = Display::PLAIN;
        assert_eq!(one(1.0), direct.encode([0.2; 3]));
        assert_eq!(one(-2.0), direct.encode([0.025; 3]));
        for bad in [f32::NAN, 33.0, -1e9] {
            let error = Display { exposure: bad, ..direct }.check().unwrap_err().to_string();
            assert!(error.contains("from -32 to 32"), "{error}");
        }
    }

    #[test]
    fn emission_is_seen_once() {
        let mut cells = Cells::new(3, 1).unwrap();
        let glow = Matter { emission: [2.0, 1.0, 0.0], opacity: 1.0, ..Matter::EMPTY };
        cells.set(0, 0, glow);
        cells.set(1, 0, Matter { opacity: 0.25, tint: [1.0, 0.5, 0.0], ..glow });
        cells.color_mut().fill([0.5; 3]);
        // The solid cell's light is its emission plus 0.4 on its faces.
        let light = Light::from_pixels(&cells, vec![[2.4, 1.4, 0.4], [0.4; 3], [0.4; 3]]).unwrap();
        let seen = light.radiance(&cells, &Display::PLAIN).unwrap();
        let expected =
            [[2.2, 1.2, 0.2], [0.2 + 0.25 * 2.0, 0.2 + (1.0 - 0.375) * 1.0, 0.2], [0.2; 3]];
        for (seen, expected) in seen.iter().zip(expected) {
            (0..3).for_each(|c| near(seen[c], expected[c], ROUNDING));
        }
    }

    #[test]
    fn ambient_light_is_added_to_light_before_the_colour_and_after_the_normals() {
        let mut cells = Cells::new(3, 1).unwrap();
        cells.color_mut().fill([0.5, 1.0, 0.25]);
        let glow = Matter { emission: [2.0, 1.0, 0.0], opacity: 1.0, ..Matter::EMPTY };
        cells.set(0, 0, glow);
        // Tilted away from all light.
        cells.normals_mut()[2] = [1.0, 0.0, 0.0];
        let light = Light::from_pixels(&cells, vec![[2.4, 1.4, 0.4], [0.4; 3], [0.4; 3]]).unwrap();
        let light = light.with_moment(vec![[[-0.4; 3], [0.0; 3]]; 3], Settings::ELEVATION).unwrap();
        let display = Display { ambient: [0.1, 0.2, 0.0], ..Display::PLAIN };
        let seen = light.radiance(&cells, &display).unwrap();
        let expected = [[2.25, 1.6, 0.1], [0.25, 0.6, 0.1], [0.05, 0.2, 0.0]];
        for (seen, expected) in seen.iter().zip(expected) {
            (0..3).for_each(|c| near(seen[c], expected[c], ROUNDING));
        }
        for bad in [[-0.1, 0.0, 0.0], [0.0, f32::NAN, 0.0]] {
            let error = Display { ambient: bad, ..Display::PLAIN }.check().unwrap_err().to_string();
            assert!(error.starts_with("`ambient` is ["), "{error}");
        }
    }

    #[test]
    fn other_grids_are_refused() {
        let light = Light::from_pixels(&Cells::new(3, 1).unwrap(), vec![[1.0; 3]; 3]).unwrap();
        let error = light.compose(&Cells::new(1, 3).unwrap(), &Display::default()).unwrap_err();
        assert_eq!(error.to_string(), "`cells` is 1×3, but must be the grid of the light, 3×1");
    }

    #[test]
    fn pictures_of_invalid_values_are_refused() {
        let mut cells = Cells::new(3, 1).unwrap();
        let light = Light::from_pixels(&cells, vec![[1.0; 3]; 3]).unwrap();
        let bright = Display { exposure: f32::NAN, ..Display::PLAIN };
        let rough = Relief { roughness: f32::NAN, ..Relief::DEFAULT };
        for (bad, message) in [
            (bright, "`exposure` is NaN, but must be a number of stops from -32 to 32"),
            (Display { relief: rough, ..Display::PLAIN }, "`relief.roughness` is NaN, but"),
        ] {
            for refused in [
                light.compose(&cells, &bad).unwrap_err(),
                light.picture(&bad).unwrap_err(),
                light.radiance(&cells, &bad).unwrap_err(),
            ] {
                assert!(refused.to_string().starts_with(message), "{refused}");
            }
        }
        cells.color_mut()[2][1] = f32::NAN;
        let refused = light.compose(&cells, &Display::default()).unwrap_err();
        assert_eq!(refused.to_string(), "cell (2, 0): color is NaN, but must be 0 to 1e12");
    }
}
