//! What is put into a cell: its matter, and the colour that the picture shows there.

use lamplight::{Cells, Matter, Rgb, srgb};

/// A colour from its hexadecimal sRGB code, linear.
pub fn hex(code: u32) -> Rgb {
    let [_, r, g, b] = code.to_be_bytes();
    [r, g, b].map(srgb::decode_u8)
}

/// Each channel times a number.
pub fn scale(rgb: Rgb, by: f32) -> Rgb {
    rgb.map(|v| v * by)
}

/// From one colour to another by a share.
pub fn mix(from: Rgb, to: Rgb, share: f32) -> Rgb {
    std::array::from_fn(|c| from[c] + (to[c] - from[c]) * share)
}

/// What one cell holds and shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// What light meets.
    pub matter: Matter,
    /// What the picture shows under the light, 0 to 1 a channel.
    pub color: Rgb,
}

impl Paint {
    /// Empty space before a backdrop.
    pub const fn open(backdrop: Rgb) -> Self {
        Self { matter: Matter::EMPTY, color: backdrop }
    }

    /// A wall that sends its colour on.
    pub const fn wall(color: Rgb) -> Self {
        Self { matter: Matter { opacity: 1.0, albedo: color, ..Matter::EMPTY }, color }
    }

    /// Solid and glowing; what shines on it is not seen.
    pub const fn glow(radiance: Rgb) -> Self {
        let matter = Matter { emission: radiance, opacity: 1.0, ..Matter::EMPTY };
        Self { matter, color: [0.0; 3] }
    }

    /// Clear glass of a tint for each px crossed.
    pub const fn glass(tint: Rgb) -> Self {
        Self { matter: Matter { tint, ..Matter::EMPTY }, color: tint }
    }

    /// Haze that absorbs a share for each px crossed and sends its colour on.
    pub const fn fog(opacity: f32, color: Rgb) -> Self {
        Self { matter: Matter { opacity, albedo: color, ..Matter::EMPTY }, color }
    }

    /// The paint of a cell.
    pub fn of(cells: &Cells, index: usize) -> Self {
        let color = cells.color().map_or([1.0; 3], |all| all[index]);
        Self { matter: cells.matter(index), color }
    }

    /// The same, glowing as well.
    #[must_use]
    pub const fn glowing(mut self, radiance: Rgb) -> Self {
        self.matter.emission = radiance;
        self
    }

    /// The same, before another backdrop or with another look.
    #[must_use]
    pub const fn colored(self, color: Rgb) -> Self {
        Self { color, ..self }
    }

    /// The same for a layout drawn `unit` cells to its px: as much light comes through in all.
    #[must_use]
    pub fn at_scale(self, unit: f32) -> Self {
        let thin = |through: f32| through.powf(1.0 / unit.max(0.05));
        let mut matter = self.matter;
        if matter.opacity < 1.0 {
            matter.opacity = 1.0 - thin(1.0 - matter.opacity);
        }
        matter.tint = matter.tint.map(thin);
        Self { matter, ..self }
    }

    /// Puts it into the cell at an index.
    pub fn put(self, cells: &mut Cells, index: usize) {
        cells.set_matter(index, self.matter);
        cells.color_mut()[index] = self.color;
    }

    /// Lays it over a share of a cell; beyond the grid nothing happens.
    pub fn lay(self, cells: &mut Cells, x: i32, y: i32, share: f32) {
        let inside =
            (0..cells.width() as i32).contains(&x) && (0..cells.height() as i32).contains(&y);
        if !inside || share <= 0.0 {
            return;
        }
        let index = cells.index(x as u32, y as u32);
        let below = Self::of(cells, index);
        let color = mix(below.color, self.color, share.min(1.0));
        Self { matter: self.matter.over(below.matter, share), color }.put(cells, index);
    }
}
