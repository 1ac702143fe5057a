//! The grid of matter that every method reads.
//!
//! A struct of arrays in row order (index `y * width + x`), one array per field, so that a stage
//! touches only what it needs. Lamps are listed beside the matter: [`Cells::drawn`] draws them into it
//! as glowing discs, for the methods that read only matter.

use crate::check::BRIGHT;
use crate::limits;
use crate::mask::{self, ALL_LAYERS};
use crate::relief::UP;
use crate::{Error, GridWindow, Inflow, Lamp, Normal, Result, Rgb, Sky, Sun};
use std::ops::Range;

/// The contents of one cell.
///
/// Crossing `s` px of a cell multiplies the radiance behind it by its transmittance
/// `T = ((1 − opacity)·tint)^s` and adds `(1 − T)·(emission + albedo·J)`, where J is the mean radiance
/// at the cell, and `glow·s` as far as the cell itself does not absorb it. A cell of opacity 1 is solid:
/// the outgoing radiance of its four faces is `emission + albedo·E/2`, where E is a face's irradiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matter {
    /// Emitted radiance `L_e`, linear RGB, 0 to 1e12.
    pub emission: Rgb,
    /// Emission coefficient `j`: radiance added per px, linear RGB, 0 to 1e12. Unlike emission it needs
    /// no opacity: fire, plasma. A solid cell does not glow.
    pub glow: Rgb,
    /// Fraction of light absorbed per px, 0 to 1; 1 is solid.
    pub opacity: f32,
    /// Colour filter per px, 0 to 1 per channel; 1 transmits everything.
    pub tint: Rgb,
    /// Reflectance of a solid cell, scattering albedo of a medium, 0 to 1 per channel.
    pub albedo: Rgb,
}

impl Matter {
    /// Empty space.
    pub const EMPTY: Self =
        Self { emission: [0.0; 3], glow: [0.0; 3], opacity: 0.0, tint: [1.0; 3], albedo: [0.0; 3] };

    /// Composites this matter over `below`, covering a fraction (0 to 1) of the cell.
    ///
    /// Opacity is `coverage·opacity` plus the rest of the layer below. Emission and albedo are weighted
    /// by each layer's part of the cell's opacity, so that the emitted light, which is emission ×
    /// opacity, follows the coverage. Tint and glow are weighted by area.
    #[must_use]
    pub fn over(self, below: Self, coverage: f32) -> Self {
        if coverage <= 0.0 {
            return below;
        }
        if coverage >= 1.0 {
            return self;
        }
        let above = coverage * self.opacity;
        let under = (1.0 - coverage) * below.opacity;
        let opacity = above + under;
        // Glass without opacity is mixed by area. Weights of 1 in all keep mixed fractions at 1 or less, which two quotients
        // would not.
        let above = if opacity > 0.0 { above / opacity } else { coverage };
        let under = 1.0 - above;
        let mix = |a: Rgb, b: Rgb, wa: f32, wb: f32| -> Rgb {
            std::array::from_fn(|c| a[c] * wa + b[c] * wb)
        };
        Self {
            emission: mix(self.emission, below.emission, above, under),
            glow: mix(self.glow, below.glow, coverage, 1.0 - coverage),
            opacity,
            tint: mix(self.tint, below.tint, coverage, 1.0 - coverage),
            albedo: mix(self.albedo, below.albedo, above, under),
        }
    }
}

impl Default for Matter {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// The grid: matter, lamps, and the sky and the suns around it.
#[derive(Debug, PartialEq)]
pub struct Cells {
    width: u32,
    height: u32,
    emission: Vec<Rgb>,
    /// Empty while nothing glows.
    glow: Vec<Rgb>,
    opacity: Vec<f32>,
    tint: Vec<Rgb>,
    albedo: Vec<Rgb>,
    color: Option<Vec<Rgb>>,
    normals: Option<Vec<Normal>>,
    masks: Option<Vec<u8>>,
    lamps: Vec<Lamp>,
    suns: Vec<Sun>,
    sky: Sky,
    inflow: Option<Inflow>,
}

/// The number of cells that are tested for matter at once.
const CHUNK: usize = 16;

impl Cells {
    /// The longest side of a grid, so that squared distances fit 31 bits.
    pub const MAX_SIDE: u32 = limits::MAX_SIDE;
    /// The largest number of cells in a grid, so that an index is exact in 32-bit float: about 1 GiB of matter.
    pub const MAX_CELLS: u64 = limits::MAX_CELLS;

    /// Creates a grid of empty space under a black sky.
    ///
    /// # Errors
    /// Fails if the size is zero or beyond [`Self::MAX_SIDE`] and [`Self::MAX_CELLS`].
    pub fn new(width: u32, height: u32) -> Result<Self> {
        Self::check_size(u64::from(width), u64::from(height))?;
        let n = width as usize * height as usize;
        Ok(Self {
            width,
            height,
            emission: vec![[0.0; 3]; n],
            glow: Vec::new(),
            opacity: vec![0.0; n],
            tint: vec![[1.0; 3]; n],
            albedo: vec![[0.0; 3]; n],
            color: None,
            normals: None,
            masks: None,
            lamps: Vec::new(),
            suns: Vec::new(),
            sky: Sky::BLACK,
            inflow: None,
        })
    }

    /// Rejects sizes of zero and sizes beyond [`Self::MAX_SIDE`] and [`Self::MAX_CELLS`].
    pub fn check_size(width: u64, height: u64) -> Result<()> {
        let side = 1..=u64::from(Self::MAX_SIDE);
        if side.contains(&width) && side.contains(&height) && width * height <= Self::MAX_CELLS {
            Ok(())
        } else {
            Err(Error::Size { width, height })
        }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        self.opacity.len()
    }

    /// Always false: a grid has at least one cell.
    pub fn is_empty(&self) -> bool {
        self.opacity.is_empty()
    }

    /// Returns the cells of a window, alone: with the same sky and suns, and with all lamps, wherever they are.
    ///
    /// # Errors
    /// Fails if the window does not lie in the grid.
    pub fn window(&self, window: GridWindow) -> Result<Self> {
        window.check([self.width, self.height])?;
        let [width, height] = window.size;
        let mut cells = Self::new(width, height)?;
        let rows = window.rows(self.width);
        copy_rows(&self.emission, &rows, &mut cells.emission);
        copy_rows(&self.opacity, &rows, &mut cells.opacity);
        copy_rows(&self.tint, &rows, &mut cells.tint);
        copy_rows(&self.albedo, &rows, &mut cells.albedo);
        if let Some(glow) = self.glow() {
            copy_rows(glow, &rows, cells.glow_mut());
        }
        if let Some(color) = self.color() {
            copy_rows(color, &rows, cells.color_mut());
        }
        if let Some(normals) = self.normals() {
            copy_rows(normals, &rows, cells.normals_mut());
        }
        if let Some(masks) = self.masks() {
            copy_rows(masks, &rows, cells.masks_mut());
        }
        let first = window.first.map(|v| v as f32);
        cells.lamps.extend(
            self.lamps
                .iter()
                .cloned()
                .map(|lamp| Lamp { position: [0, 1].map(|a| lamp.position[a] - first[a]), ..lamp }),
        );
        cells.suns.clone_from(&self.suns);
        cells.sky = self.sky.clone();
        Ok(cells)
    }

    /// The index of cell (x, y) in the arrays.
    ///
    /// # Panics
    /// Panics if (x, y) lies outside the grid.
    #[inline]
    pub fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width && y < self.height, "cell ({x}, {y}) is outside the grid");
        y as usize * self.width as usize + x as usize
    }

    /// The contents of cell (x, y); `None` outside the grid.
    pub fn get(&self, x: u32, y: u32) -> Option<Matter> {
        (x < self.width && y < self.height).then(|| self.matter(self.index(x, y)))
    }

    /// The contents of the cell at an index.
    #[inline]
    pub fn matter(&self, index: usize) -> Matter {
        Matter {
            emission: self.emission[index],
            glow: self.glow.get(index).copied().unwrap_or_default(),
            opacity: self.opacity[index],
            tint: self.tint[index],
            albedo: self.albedo[index],
        }
    }

    /// Sets the contents of cell (x, y). Does nothing outside the grid.
    pub fn set(&mut self, x: u32, y: u32, matter: Matter) {
        if x < self.width && y < self.height {
            self.set_matter(self.index(x, y), matter);
        }
    }

    /// Sets the contents of the cell at an index.
    #[inline]
    pub fn set_matter(&mut self, index: usize, matter: Matter) {
        self.emission[index] = matter.emission;
        if !self.glow.is_empty() || matter.glow != [0.0; 3] {
            self.glow_mut()[index] = matter.glow;
        }
        self.opacity[index] = matter.opacity;
        self.tint[index] = matter.tint;
        self.albedo[index] = matter.albedo;
    }

    /// The emission of every cell.
    pub fn emission(&self) -> &[Rgb] {
        &self.emission
    }

    /// The emission of every cell, mutably.
    pub fn emission_mut(&mut self) -> &mut [Rgb] {
        &mut self.emission
    }

    /// The emission coefficient of every cell, radiance per px; `None` while nothing glows.
    pub fn glow(&self) -> Option<&[Rgb]> {
        (!self.glow.is_empty()).then_some(&self.glow)
    }

    /// The emission coefficient of every cell, mutably. The first call creates them, all black.
    pub fn glow_mut(&mut self) -> &mut [Rgb] {
        self.glow.resize(self.opacity.len(), [0.0; 3]);
        &mut self.glow
    }

    /// The opacity of every cell.
    pub fn opacity(&self) -> &[f32] {
        &self.opacity
    }

    /// The opacity of every cell, mutably.
    pub fn opacity_mut(&mut self) -> &mut [f32] {
        &mut self.opacity
    }

    /// The tint of every cell.
    pub fn tint(&self) -> &[Rgb] {
        &self.tint
    }

    /// The tint of every cell, mutably.
    pub fn tint_mut(&mut self) -> &mut [Rgb] {
        &mut self.tint
    }

    /// The albedo of every cell.
    pub fn albedo(&self) -> &[Rgb] {
        &self.albedo
    }

    /// The albedo of every cell, mutably.
    pub fn albedo_mut(&mut self) -> &mut [Rgb] {
        &mut self.albedo
    }

    /// The colours that the final picture multiplies with the light, linear RGB; `None` is white.
    pub fn color(&self) -> Option<&[Rgb]> {
        self.color.as_deref()
    }

    /// The colours of the final picture, mutably. The first call creates them in white.
    pub fn color_mut(&mut self) -> &mut [Rgb] {
        let n = self.opacity.len();
        self.color.get_or_insert_with(|| vec![[1.0; 3]; n])
    }

    /// Removes the colours: all are white.
    pub(crate) fn clear_color(&mut self) {
        self.color = None;
    }

    /// The normals of surfaces, unit vectors with x to the right, y down and z towards the viewer; `None` if no surface
    /// is tilted. The final picture is lit by them ([`Relief`](crate::Relief)); light itself does not know them.
    pub fn normals(&self) -> Option<&[Normal]> {
        self.normals.as_deref()
    }

    /// The normals, mutably. The first call creates them, all towards the viewer.
    pub fn normals_mut(&mut self) -> &mut [Normal] {
        let n = self.opacity.len();
        self.normals.get_or_insert_with(|| vec![UP; n])
    }

    /// Removes the normals: no surface is tilted.
    pub fn clear_normals(&mut self) {
        self.normals = None;
    }

    /// The layers of every cell, a bit each; `None` if all cells are in all layers. Lamps and suns light only the cells
    /// with which their mask has a layer in common ([`Lamp::mask`]).
    pub fn masks(&self) -> Option<&[u8]> {
        self.masks.as_deref()
    }

    /// The layers of every cell, mutably. The first call creates them, all of all cells.
    pub fn masks_mut(&mut self) -> &mut [u8] {
        let n = self.opacity.len();
        self.masks.get_or_insert_with(|| vec![ALL_LAYERS; n])
    }

    /// The lamps. They become matter by [`Cells::drawn`].
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The lamps, mutably: add, move or remove them.
    pub fn lamps_mut(&mut self) -> &mut Vec<Lamp> {
        &mut self.lamps
    }

    /// The suns.
    pub fn suns(&self) -> &[Sun] {
        &self.suns
    }

    /// The suns, mutably: add, turn or remove them.
    pub fn suns_mut(&mut self) -> &mut Vec<Sun> {
        &mut self.suns
    }

    /// The radiance of rays that leave the grid, without the suns.
    pub fn sky(&self) -> &Sky {
        &self.sky
    }

    /// Removes all matter, lamps, colours, normals and masks. The sky, the suns and the inflow stay.
    pub fn clear(&mut self) {
        self.emission.fill(Matter::EMPTY.emission);
        self.glow.clear();
        self.opacity.fill(Matter::EMPTY.opacity);
        self.tint.fill(Matter::EMPTY.tint);
        self.albedo.fill(Matter::EMPTY.albedo);
        self.color = None;
        self.normals = None;
        self.masks = None;
        self.lamps.clear();
    }

    /// Sets the sky.
    pub fn set_sky(&mut self, sky: Sky) {
        self.sky = sky;
    }

    /// The light that enters from the world around the grid, if it is not that of the sky.
    pub fn inflow(&self) -> Option<&Inflow> {
        self.inflow.as_ref()
    }

    /// Sets the light that enters from the world around the grid, in place of the sky.
    ///
    /// # Errors
    /// Fails if it is that of a grid of another size.
    pub fn set_inflow(&mut self, inflow: Option<Inflow>) -> Result<()> {
        if let Some(inflow) = &inflow {
            inflow.check([self.width, self.height])?;
        }
        self.inflow = inflow;
        Ok(())
    }

    /// Returns whether the cell at an index is solid.
    #[inline]
    pub fn is_solid(&self, index: usize) -> bool {
        self.opacity[index] >= 1.0
    }

    /// Visits all cells that absorb or filter light, in order: all that affect it, if those that glow are media
    /// ([`Glow`](crate::stages::glow::Glow)). Fast over empty space.
    pub(crate) fn for_each_matter(&self, mut visit: impl FnMut(usize)) {
        for (chunk, (opacity, tint)) in
            self.opacity.chunks(CHUNK).zip(self.tint.chunks(CHUNK)).enumerate()
        {
            let open = opacity.iter().fold(true, |all, &v| all & (v == 0.0));
            if open & tint.as_flattened().iter().fold(true, |all, &v| all & (v == 1.0)) {
                continue;
            }
            for (i, (&opacity, &tint)) in opacity.iter().zip(tint).enumerate() {
                if opacity != 0.0 || tint != [1.0; 3] {
                    visit(chunk * CHUNK + i);
                }
            }
        }
    }

    /// Visits all solid cells, in order. Fast over empty space.
    pub(crate) fn for_each_solid(&self, mut visit: impl FnMut(usize)) {
        for (chunk, opacity) in self.opacity.chunks(CHUNK).enumerate() {
            if opacity.iter().fold(true, |all, &v| all & (v < 1.0)) {
                continue;
            }
            for (i, _) in opacity.iter().enumerate().filter(|(_, v)| **v >= 1.0) {
                visit(chunk * CHUNK + i);
            }
        }
    }

    /// Rejects NaN, infinite and out-of-range values anywhere in the grid.
    ///
    /// # Errors
    /// Names the first wrong cell, field, lamp or sky, the value, and what would be right.
    pub fn check(&self) -> Result<()> {
        let unit = |v: f32| (0.0..=1.0).contains(&v);
        let radiance = |v: f32| (0.0..=BRIGHT).contains(&v);
        let emission = || {
            let expected = "0 to 1e12";
            self.check_field("emission", expected, self.emission.as_flattened(), 3, radiance)?;
            self.check_field("glow", expected, self.glow.as_flattened(), 3, radiance)?;
            self.check_field("opacity", "0 to 1", &self.opacity, 1, unit)
        };
        let colours = || {
            self.check_field("tint", "0 to 1", self.tint.as_flattened(), 3, unit)?;
            self.check_field("albedo", "0 to 1", self.albedo.as_flattened(), 3, unit)?;
            let color = self.color.as_deref().unwrap_or_default().as_flattened();
            self.check_field("color", "0 to 1e12", color, 3, radiance)?;
            let normals = self.normals.as_deref().unwrap_or_default().as_flattened();
            self.check_field("normal", "-1 to 1", normals, 3, |v| (-1.0..=1.0).contains(&v))
        };
        let (emission, colours) = rayon::join(emission, colours);
        emission?;
        colours?;
        self.check_masks()?;
        for (i, lamp) in self.lamps.iter().enumerate() {
            lamp.check(&format_args!("lamp[{i}]"))?;
        }
        for (i, sun) in self.suns.iter().enumerate() {
            sun.check(&format_args!("sun[{i}]"))?;
        }
        self.sky.check()
    }

    /// Rejects cells that are in no layer.
    fn check_masks(&self) -> Result<()> {
        match self.masks.iter().flatten().position(|&mask| mask == 0) {
            None => Ok(()),
            Some(cell) => {
                let [x, y] = [cell % self.width as usize, cell / self.width as usize];
                let (x, y, expected) = (x as u32, y as u32, mask::EXPECTED);
                Err(Error::Cell { x, y, field: "mask", value: 0.0, expected })
            }
        }
    }

    fn check_field(
        &self,
        field: &'static str,
        expected: &'static str,
        values: &[f32],
        channels: usize,
        good: impl Fn(f32) -> bool,
    ) -> Result<()> {
        // Chunks let the common case run as vector code, without an early exit per value.
        for (chunk, part) in values.chunks(1024).enumerate() {
            if part.iter().fold(true, |all, &v| all & good(v)) {
                continue;
            }
            let at = part.iter().position(|&v| !good(v)).unwrap_or(0);
            let cell = (chunk * 1024 + at) / channels;
            let (x, y) = (cell % self.width as usize, cell / self.width as usize);
            return Err(Error::Cell { x: x as u32, y: y as u32, field, value: part[at], expected });
        }
        Ok(())
    }
}

/// Copies the values of a window, by the ranges of its rows.
pub(crate) fn copy_rows<T: Copy>(from: &[T], rows: &[Range<usize>], to: &mut [T]) {
    let width = rows.first().map_or(1, Range::len);
    for (row, to) in rows.iter().zip(to.chunks_exact_mut(width)) {
        to.copy_from_slice(&from[row.clone()]);
    }
}

impl Clone for Cells {
    fn clone(&self) -> Self {
        Self {
            width: self.width,
            height: self.height,
            emission: self.emission.clone(),
            glow: self.glow.clone(),
            opacity: self.opacity.clone(),
            tint: self.tint.clone(),
            albedo: self.albedo.clone(),
            color: self.color.clone(),
            normals: self.normals.clone(),
            masks: self.masks.clone(),
            lamps: self.lamps.clone(),
            suns: self.suns.clone(),
            sky: self.sky.clone(),
            inflow: self.inflow.clone(),
        }
    }

    /// Copies into the existing buffers: a solver does this every frame without allocating.
    fn clone_from(&mut self, source: &Self) {
        let Self {
            width,
            height,
            emission,
            glow,
            opacity,
            tint,
            albedo,
            color,
            normals,
            masks,
            lamps,
            suns,
            sky,
            inflow,
        } = source;
        (self.width, self.height) = (*width, *height);
        self.sky.clone_from(sky);
        self.inflow.clone_from(inflow);
        rayon::join(
            || {
                self.emission.clone_from(emission);
                self.opacity.clone_from(opacity);
                self.color.clone_from(color);
                self.normals.clone_from(normals);
            },
            || {
                self.glow.clone_from(glow);
                self.tint.clone_from(tint);
                self.albedo.clone_from(albedo);
                self.masks.clone_from(masks);
            },
        );
        self.lamps.clone_from(lamps);
        self.suns.clone_from(suns);
    }
}
