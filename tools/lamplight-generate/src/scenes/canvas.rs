//! A canvas whose pixels are matter, and the brushes that the scenes share.

use image::{DynamicImage, GrayImage, Luma, Rgb as Pixel, RgbImage};

pub type Color = [u8; 3];

/// A colour from its hexadecimal sRGB code.
pub const fn hex(code: u32) -> Color {
    let [_, r, g, b] = code.to_be_bytes();
    [r, g, b]
}

/// The matter that a brush leaves in a cell; all colours are sRGB except `tint` and `normal`.
#[derive(Clone, Copy)]
pub struct Paint {
    pub color: Color,
    pub albedo: Color,
    pub emission: Color,
    pub opacity: u8,
    pub tint: Color,
    /// As in a normal map: 128 is 0, green is up.
    pub normal: Color,
}

impl Paint {
    /// Empty space in front of a backdrop.
    pub const fn open(backdrop: Color) -> Self {
        Self {
            color: backdrop,
            albedo: [0; 3],
            emission: [0; 3],
            opacity: 0,
            tint: [255; 3],
            normal: [128, 128, 255],
        }
    }

    /// A wall.
    pub const fn solid(color: Color) -> Self {
        Self { albedo: color, opacity: 255, ..Self::open(color) }
    }

    /// Adds emission.
    pub const fn glow(self, emission: Color) -> Self {
        Self { emission, ..self }
    }

    /// Replaces the albedo.
    pub const fn albedo(self, albedo: Color) -> Self {
        Self { albedo, ..self }
    }
}

/// A scene's layers, drawn.
pub struct Art {
    pub name: &'static str,
    pub canvas: Canvas,
    pub layers: &'static [Layer],
}

/// A grid of paint.
pub struct Canvas {
    pub width: i32,
    pub height: i32,
    cells: Vec<Paint>,
}

impl Canvas {
    pub fn new(width: i32, height: i32, mut paint: impl FnMut(i32, i32) -> Paint) -> Self {
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self { width, height, cells: cells.map(|(x, y)| paint(x, y)).collect() }
    }

    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        inside.then(|| (y * self.width + x) as usize)
    }

    pub fn get(&self, x: i32, y: i32) -> Option<Paint> {
        self.index(x, y).map(|i| self.cells[i])
    }

    /// Returns true for a wall; outside of the canvas everything is one.
    pub fn is_solid(&self, x: i32, y: i32) -> bool {
        self.get(x, y).is_none_or(|p| p.opacity == 255)
    }

    pub fn set(&mut self, x: i32, y: i32, paint: Paint) {
        if let Some(i) = self.index(x, y) {
            self.cells[i] = paint;
        }
    }

    /// Another look for what is there.
    pub fn recolor(&mut self, x: i32, y: i32, color: Color) {
        if let Some(i) = self.index(x, y) {
            self.cells[i].color = color;
        }
    }

    /// Repaints every cell, knowing what is there.
    pub fn repaint(&mut self, mut paint: impl FnMut(i32, i32, Paint) -> Paint) {
        for y in 0..self.height {
            for x in 0..self.width {
                let i = (y * self.width + x) as usize;
                self.cells[i] = paint(x, y, self.cells[i]);
            }
        }
    }

    pub fn rect(&mut self, x: i32, y: i32, w: i32, h: i32, paint: Paint) {
        for y in y..y + h {
            for x in x..x + w {
                self.set(x, y, paint);
            }
        }
    }

    pub fn disc(&mut self, x: f32, y: f32, r: f32, paint: Paint) {
        self.ellipse(x, y, r, r, |_, _| paint);
    }

    /// The brush sees where it is from −1 to 1 across the ellipse.
    pub fn ellipse(&mut self, x: f32, y: f32, rx: f32, ry: f32, paint: impl Fn(f32, f32) -> Paint) {
        for cy in (y - ry).floor() as i32..=(y + ry).ceil() as i32 {
            for cx in (x - rx).floor() as i32..=(x + rx).ceil() as i32 {
                let (u, v) = ((cx as f32 + 0.5 - x) / rx, (cy as f32 + 0.5 - y) / ry);
                if u * u + v * v <= 1.0 {
                    self.set(cx, cy, paint(u, v));
                }
            }
        }
    }

    /// A line of 1 px.
    pub fn line(&mut self, from: (i32, i32), to: (i32, i32), paint: Paint) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let steps = dx.abs().max(dy.abs()).max(1);
        for i in 0..=steps {
            let along = |from: i32, d: i32| from + (d * i * 2 + steps * d.signum()) / (steps * 2);
            self.set(along(from.0, dx), along(from.1, dy), paint);
        }
    }

    /// A filled polygon (even-odd); the brush sees the cell.
    pub fn polygon(&mut self, points: &[(f32, f32)], paint: impl Fn(i32, i32) -> Paint) {
        for y in 0..self.height {
            for x in 0..self.width {
                let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                let edges = points.iter().zip(points.iter().cycle().skip(1));
                let crossed = edges.filter(|(a, b)| {
                    (a.1 > py) != (b.1 > py) && px < a.0 + (py - a.1) / (b.1 - a.1) * (b.0 - a.0)
                });
                if crossed.count() % 2 == 1 {
                    self.set(x, y, paint(x, y));
                }
            }
        }
    }

    /// Rows of characters, one a cell; characters without a paint leave the cell as it is.
    pub fn sprite(&mut self, x: i32, y: i32, rows: &[&str], paint: impl Fn(char) -> Option<Paint>) {
        for (row, text) in (y..).zip(rows) {
            for (column, letter) in (x..).zip(text.chars()) {
                if let Some(paint) = paint(letter) {
                    self.set(column, row, paint);
                }
            }
        }
    }

    /// Steps (of 1 px straight, about 1.4 px aslant) from each cell to the nearest that `is` holds
    /// for.
    pub fn distance(&self, is: impl Fn(Paint) -> bool) -> Vec<f32> {
        let far = (self.width + self.height) as f32;
        let mut d: Vec<f32> = self.cells.iter().map(|p| if is(*p) { 0.0 } else { far }).collect();
        let mut sweep = |x: i32, y: i32, way: i32| {
            let here = (y * self.width + x) as usize;
            for (dx, dy, step) in
                [(-way, 0, 1.0), (0, -way, 1.0), (-way, -way, 1.4), (way, -way, 1.4)]
            {
                if let Some(there) = self.index(x + dx, y + dy) {
                    d[here] = d[here].min(d[there] + step);
                }
            }
        };
        for y in 0..self.height {
            (0..self.width).for_each(|x| sweep(x, y, 1));
        }
        for y in (0..self.height).rev() {
            (0..self.width).rev().for_each(|x| sweep(x, y, -1));
        }
        d
    }

    /// One layer as an image.
    pub fn layer(&self, layer: Layer) -> DynamicImage {
        let (w, h) = (self.width as u32, self.height as u32);
        let at = |x: u32, y: u32| self.cells[(y * w + x) as usize];
        let rgb = |of: fn(Paint) -> Color| {
            DynamicImage::ImageRgb8(RgbImage::from_fn(w, h, |x, y| Pixel(of(at(x, y)))))
        };
        match layer {
            Layer::Color => rgb(|p| p.color),
            Layer::Albedo => rgb(|p| p.albedo),
            Layer::Emission => rgb(|p| p.emission),
            Layer::Tint => rgb(|p| p.tint),
            Layer::Normal => rgb(|p| p.normal),
            Layer::Opacity => {
                DynamicImage::ImageLuma8(GrayImage::from_fn(w, h, |x, y| Luma([at(x, y).opacity])))
            }
        }
    }
}

/// The layers of a scene.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    Color,
    Albedo,
    Emission,
    Opacity,
    Tint,
    Normal,
}

impl Layer {
    pub fn name(self) -> &'static str {
        match self {
            Self::Color => "color",
            Self::Albedo => "albedo",
            Self::Emission => "emission",
            Self::Opacity => "opacity",
            Self::Tint => "tint",
            Self::Normal => "normal",
        }
    }
}

/// A number in [0, 1) for a cell.
pub fn hash(x: i32, y: i32, seed: u32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    h = (h ^ seed.wrapping_mul(0xC2B2_AE3D)).wrapping_mul(0x27D4_EB2F);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    (h >> 16) as f32 / 65_536.0
}

/// Smooth noise in [0, 1] with bumps about 1 apart.
fn bumps(x: f32, y: f32, seed: u32) -> f32 {
    let (left, top) = (x.floor(), y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease(x - left), ease(y - top));
    let at = |dx: i32, dy: i32| hash(left as i32 + dx, top as i32 + dy, seed);
    let upper = at(0, 0) + (at(1, 0) - at(0, 0)) * u;
    let lower = at(0, 1) + (at(1, 1) - at(0, 1)) * u;
    upper + (lower - upper) * v
}

/// Noise in [0, 1] of four sizes, the largest `size` px: stone, clouds, grass.
pub fn rough(x: f32, y: f32, size: f32, seed: u32) -> f32 {
    let octave = |i: u32, share: f32| {
        let scale = (1 << i) as f32 / size;
        share * bumps(x * scale, y * scale, seed + i)
    };
    octave(0, 0.5) + octave(1, 0.27) + octave(2, 0.15) + octave(3, 0.08)
}

/// A colour of a ramp for a value in 0 to 1, dithered between neighbours in a 4×4 pattern.
pub fn ramp(colors: &[u32], value: f32, x: i32, y: i32) -> Color {
    const BAYER: [f32; 16] = [0., 8., 2., 10., 12., 4., 14., 6., 3., 11., 1., 9., 15., 7., 13., 5.];
    let threshold = (BAYER[((y & 3) * 4 + (x & 3)) as usize] + 0.5) / 16.0;
    let place = value.clamp(0.0, 1.0) * (colors.len() - 1) as f32;
    // A third of the way is dithered, the rest is flat: speckles only between the bands.
    let step = ((place.fract() - 0.5) * 3.0 + 0.5 > threshold) as usize;
    hex(colors[(place as usize + step).min(colors.len() - 1)])
}

/// A colour between two.
pub fn mix(a: Color, b: Color, share: f32) -> Color {
    std::array::from_fn(|c| {
        (f32::from(a[c]) + (f32::from(b[c]) - f32::from(a[c])) * share).round() as u8
    })
}

/// A colour made brighter or darker.
pub fn scale(color: Color, by: f32) -> Color {
    color.map(|v| (f32::from(v) * by).round().min(255.0) as u8)
}
