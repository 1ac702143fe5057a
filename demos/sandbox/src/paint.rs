//! The content of a cell: its matter, its colour and its normal.

use lamplight::{Cells, Matter, Normal, Rgb, UP, normal_of_slope, srgb};

/// A colour from its hexadecimal sRGB code, linear.
pub fn hex(code: u32) -> Rgb {
    let [_, r, g, b] = code.to_be_bytes();
    [r, g, b].map(srgb::decode_u8)
}

/// Scales each channel.
pub fn scale(rgb: Rgb, by: f32) -> Rgb {
    rgb.map(|v| v * by)
}

/// Interpolates between two colours.
pub fn mix(from: Rgb, to: Rgb, t: f32) -> Rgb {
    std::array::from_fn(|c| from[c] + (to[c] - from[c]) * t)
}

/// The content of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Its matter.
    pub matter: Matter,
    /// Its colour in the picture, which light multiplies, 0 to 1 per channel.
    pub color: Rgb,
    /// The normal of its surface in the picture.
    pub normal: Normal,
}

impl Paint {
    /// Matter of a colour whose surface is not tilted.
    const fn flat(matter: Matter, color: Rgb) -> Self {
        Self { matter, color, normal: UP }
    }

    /// Empty space in front of a backdrop.
    pub const fn open(backdrop: Rgb) -> Self {
        Self::flat(Matter::EMPTY, backdrop)
    }

    /// A wall that reflects its colour.
    pub const fn wall(color: Rgb) -> Self {
        Self::flat(Matter { opacity: 1.0, albedo: color, ..Matter::EMPTY }, color)
    }

    /// A solid that emits light and reflects none.
    pub const fn glow(radiance: Rgb) -> Self {
        Self::flat(Matter { emission: radiance, opacity: 1.0, ..Matter::EMPTY }, [0.0; 3])
    }

    /// Clear glass with a tint per px.
    pub const fn glass(tint: Rgb) -> Self {
        Self::flat(Matter { tint, ..Matter::EMPTY }, tint)
    }

    /// Fog that loses a fraction of light per px and scatters its colour.
    pub const fn fog(opacity: f32, color: Rgb) -> Self {
        Self::flat(Matter { opacity, albedo: color, ..Matter::EMPTY }, color)
    }

    /// The paint of a cell.
    pub fn of(cells: &Cells, index: usize) -> Self {
        let color = cells.color().map_or([1.0; 3], |all| all[index]);
        let normal = cells.normals().map_or(UP, |all| all[index]);
        Self { matter: cells.matter(index), color, normal }
    }

    /// Adds emitted radiance.
    #[must_use]
    pub const fn glowing(mut self, radiance: Rgb) -> Self {
        self.matter.emission = radiance;
        self
    }

    /// Replaces the colour.
    #[must_use]
    pub const fn colored(self, color: Rgb) -> Self {
        Self { color, ..self }
    }

    /// Tilts its surface, which rises by this many px per px to the right and down.
    #[must_use]
    pub fn tilted(self, slope: [f32; 2]) -> Self {
        Self { normal: normal_of_slope(slope), ..self }
    }

    /// Scales to a layout that is drawn with `unit` cells per px, with the same transmittance in total.
    #[must_use]
    pub fn at_scale(self, unit: f32) -> Self {
        let thin = |transmittance: f32| transmittance.powf(1.0 / unit.max(0.05));
        let mut matter = self.matter;
        if matter.opacity < 1.0 {
            matter.opacity = 1.0 - thin(1.0 - matter.opacity);
        }
        matter.tint = matter.tint.map(thin);
        Self { matter, ..self }
    }

    /// Writes it to a cell.
    pub fn put(self, cells: &mut Cells, index: usize) {
        cells.set_matter(index, self.matter);
        cells.color_mut()[index] = self.color;
        if cells.normals().is_some() || self.normal != UP {
            cells.normals_mut()[index] = self.normal;
        }
    }

    /// Composites it over a cell with a coverage. The normal is that of what covers more of it. Cells outside of the
    /// grid are ignored.
    pub fn lay(self, cells: &mut Cells, x: i32, y: i32, coverage: f32) {
        let inside =
            (0..cells.width() as i32).contains(&x) && (0..cells.height() as i32).contains(&y);
        if !inside || coverage <= 0.0 {
            return;
        }
        let index = cells.index(x as u32, y as u32);
        let below = Self::of(cells, index);
        let color = mix(below.color, self.color, coverage.min(1.0));
        let normal = if coverage < 0.5 { below.normal } else { self.normal };
        Self { matter: self.matter.over(below.matter, coverage), color, normal }.put(cells, index);
    }
}
