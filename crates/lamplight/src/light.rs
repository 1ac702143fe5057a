//! The result of a solver: the light at every cell, and queries of it.

use crate::cells::copy_rows;
use crate::{Cells, Error, GridWindow, Moment, Result, Rgb, elevation};

/// Mean radiance `J = (1/2π) ∫ L dω` at the centre of each cell, linear RGB, in row order.
///
/// A solid cell holds the irradiance of its faces (as E/2, so that a uniform surrounding L gives L),
/// fading inwards over `wall_depth`, plus the cell's own emission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Light {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgb: Vec<Rgb>,
    pub(crate) solid: Vec<bool>,
    /// None if it was not asked for.
    pub(crate) moment: Option<Vec<Moment>>,
    /// The elevation of all light, radians.
    pub(crate) elevation: f32,
}

impl Light {
    /// Wraps light computed elsewhere (by a reference, from a file): one value per cell of `cells`,
    /// in row order.
    ///
    /// # Errors
    /// Fails if the number of values is not the number of cells.
    pub fn from_pixels(cells: &Cells, rgb: Vec<Rgb>) -> Result<Self> {
        let light = Self::in_the_open([cells.width(), cells.height()], rgb)?;
        Ok(Self { solid: (0..cells.len()).map(|i| cells.is_solid(i)).collect(), ..light })
    }

    /// Wraps light of a grid of this width and height, none of whose cells is solid: one value per cell, in row order.
    ///
    /// # Errors
    /// Fails if the number of values is not the number of cells, or there can be no such grid.
    pub fn in_the_open([width, height]: [u32; 2], rgb: Vec<Rgb>) -> Result<Self> {
        Cells::check_size(width.into(), height.into())?;
        let count = width as usize * height as usize;
        if rgb.len() != count {
            let expected = format!("one value per cell, {count} in all");
            return Err(Error::value("light", format!("{} values", rgb.len()), expected));
        }
        let (solid, moment) = (vec![false; count], None);
        Ok(Self { width, height, rgb, solid, moment, elevation: elevation::DEFAULT })
    }

    /// Adds the first moment, one value per cell, in row order, of light that arrives at an elevation
    /// ([`Settings::elevation`](crate::Settings::elevation)).
    ///
    /// # Errors
    /// Fails if the number of values is not the number of cells.
    pub fn with_moment(mut self, moment: Vec<Moment>, elevation: f32) -> Result<Self> {
        if moment.len() != self.rgb.len() {
            let expected = format!("one value per cell, {} in all", self.rgb.len());
            return Err(Error::value("moment", format!("{} values", moment.len()), expected));
        }
        (self.moment, self.elevation) = (Some(moment), elevation);
        Ok(self)
    }

    /// Returns the light of a window.
    ///
    /// # Panics
    /// If the window does not lie in the grid.
    #[must_use]
    pub fn window(&self, window: GridWindow) -> Self {
        let [width, height] = window.size;
        let rows = window.rows(self.width);
        let count = width as usize * height as usize;
        let mut light = Self {
            width,
            height,
            rgb: vec![[0.0; 3]; count],
            solid: vec![false; count],
            moment: self.moment.as_ref().map(|_| vec![Moment::default(); count]),
            elevation: self.elevation,
        };
        copy_rows(&self.rgb, &rows, &mut light.rgb);
        copy_rows(&self.solid, &rows, &mut light.solid);
        if let (Some(from), Some(to)) = (&self.moment, &mut light.moment) {
            copy_rows(from, &rows, to);
        }
        light
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The light of every cell, in row order.
    pub fn pixels(&self) -> &[Rgb] {
        &self.rgb
    }

    /// The first moment `m = (1/2π) ∫ L ω dω` of every cell, in row order, with ω towards where the light comes from;
    /// `None` unless the settings ask for it ([`Settings::moment`](crate::Settings::moment)) or the cells have normals.
    ///
    /// It is at most as long as the light, channel by channel. Only the moment of light with an elevation of its own, by
    /// [`Lamp::height`](crate::Lamp::height) and [`Sun::elevation`](crate::Sun::elevation), is weighted by the cotangent
    /// of that ÷ the cotangent of [`Self::elevation`]: that of low light is longer, that of steep light shorter.
    ///
    /// In a solid cell it has the direction in front of its faces, and fades inwards with the light.
    pub fn moment(&self) -> Option<&[Moment]> {
        self.moment.as_deref()
    }

    /// The elevation at which light arrives at tilted surfaces, radians
    /// ([`Settings::elevation`](crate::Settings::elevation)).
    pub fn elevation(&self) -> f32 {
        self.elevation
    }

    /// The x and the y component of the first moment, each in place of the light.
    pub(crate) fn components(&self) -> Option<[Self; 2]> {
        let moment = self.moment.as_ref()?;
        Some([0, 1].map(|axis| Self {
            rgb: moment.iter().map(|moment| moment[axis]).collect(),
            solid: self.solid.clone(),
            moment: None,
            ..*self
        }))
    }

    /// Flags of solid cells, in row order.
    pub fn solid(&self) -> &[bool] {
        &self.solid
    }

    /// The light of cell (x, y); black outside the grid.
    pub fn at(&self, x: u32, y: u32) -> Rgb {
        if x < self.width && y < self.height {
            self.rgb[y as usize * self.width as usize + x as usize]
        } else {
            [0.0; 3]
        }
    }

    /// The light at a point in px, interpolated between the four nearest cell centres.
    ///
    /// In open space only open cells count, so that a wall does not darken a point beside it and no
    /// light comes through the gap between two walls that touch at a corner. Inside a wall only solid
    /// cells count; see [`Self::sample_open`] for queries that must not see walls. Outside the grid
    /// the nearest border cell counts.
    pub fn sample(&self, position: [f32; 2]) -> Rgb {
        if self.rgb.is_empty() || !position.iter().all(|p| p.is_finite()) {
            return [0.0; 3];
        }
        // Beyond the border lies the border, however far.
        let x = position[0].clamp(0.0, self.width as f32);
        let y = position[1].clamp(0.0, self.height as f32);
        let (max_x, max_y) = (self.width as i64 - 1, self.height as i64 - 1);
        let index = |x: i64, y: i64| {
            y.clamp(0, max_y) as usize * self.width as usize + x.clamp(0, max_x) as usize
        };
        let home = index(x.floor() as i64, y.floor() as i64);
        let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
        let (fx, fy) = (x - 0.5 - left, y - 0.5 - top);
        let (left, top) = (left as i64, top as i64);
        let corners = [
            (index(left, top), (1.0 - fx) * (1.0 - fy)),
            (index(left + 1, top), fx * (1.0 - fy)),
            (index(left, top + 1), (1.0 - fx) * fy),
            (index(left + 1, top + 1), fx * fy),
        ];
        let alike = corners.map(|(i, _)| self.solid[i] == self.solid[home]);
        let counts = |corner: usize| {
            // Corners differ by a bit for each axis. Across, the way leads past one beside.
            let near = |other: usize| corners[other].0 == home;
            let beside = [corner ^ 1, corner ^ 2];
            alike[corner]
                && (near(corner) || beside.iter().any(|&other| near(other) || alike[other]))
        };
        self.mean((0..4).filter(|&corner| counts(corner)).map(|corner| corners[corner]))
    }

    /// The light at a point in px, or, if the point lies inside a wall, that of the nearest open
    /// cell. `None` if the point is not finite or the grid has no open cell.
    ///
    /// A character whose feet touch a pillar keeps the light that falls on it. Finding the nearest
    /// open cell takes time in proportion to the square of its distance.
    pub fn sample_open(&self, position: [f32; 2]) -> Option<Rgb> {
        if self.rgb.is_empty() || !position.iter().all(|p| p.is_finite()) {
            return None;
        }
        let (width, height) = (self.width as i64, self.height as i64);
        let x = position[0].clamp(0.0, self.width as f32);
        let y = position[1].clamp(0.0, self.height as f32);
        let home = [(x as i64).min(width - 1), (y as i64).min(height - 1)];
        let index = |[x, y]: [i64; 2]| (y * width + x) as usize;
        if !self.solid[index(home)] {
            return Some(self.sample(position));
        }
        // Squares of growing radius; a cell on the next one is at least radius − ½ px away.
        let mut nearest: Option<(f32, usize)> = None;
        for radius in 1..width.max(height) {
            if nearest.is_some_and(|(distance, _)| distance <= (radius as f32 - 1.0).powi(2)) {
                break;
            }
            let rows = (home[1] - radius).max(0)..=(home[1] + radius).min(height - 1);
            for cell_y in rows {
                let whole_row = (cell_y - home[1]).abs() == radius;
                let step = if whole_row { 1 } else { 2 * radius as usize };
                for cell_x in (home[0] - radius..=home[0] + radius).step_by(step) {
                    if !(0..width).contains(&cell_x) || self.solid[index([cell_x, cell_y])] {
                        continue;
                    }
                    let (dx, dy) = (cell_x as f32 + 0.5 - x, cell_y as f32 + 0.5 - y);
                    let distance = dx * dx + dy * dy;
                    if nearest.is_none_or(|(least, _)| distance < least) {
                        nearest = Some((distance, index([cell_x, cell_y])));
                    }
                }
            }
        }
        nearest.map(|(_, i)| self.rgb[i])
    }

    /// The mean light over the open cells of a box from `min` to `max` in px, each weighted by its
    /// fraction inside the box; black if the box holds no open cell.
    pub fn over(&self, min: [f32; 2], max: [f32; 2]) -> Rgb {
        let overlap =
            |i: usize, axis: usize| ((i + 1) as f32).min(max[axis]) - (i as f32).max(min[axis]);
        let cells = |axis: usize, side: u32| {
            let from = min[axis].max(0.0) as usize;
            from..(max[axis].max(0.0).ceil() as usize).min(side as usize)
        };
        self.mean(cells(1, self.height).flat_map(|y| {
            cells(0, self.width).filter_map(move |x| {
                let i = y * self.width as usize + x;
                let fraction = overlap(x, 0).max(0.0) * overlap(y, 1).max(0.0);
                (!self.solid[i]).then_some((i, fraction))
            })
        }))
    }

    fn mean(&self, weighted: impl Iterator<Item = (usize, f32)>) -> Rgb {
        // In f64: a sum over millions of cells rounds small values away.
        let (mut sum, mut weight) = ([0.0; 3], 0.0);
        for (i, w) in weighted {
            let w = f64::from(w);
            (0..3).for_each(|c| sum[c] += w * f64::from(self.rgb[i][c]));
            weight += w;
        }
        if weight > 0.0 { sum.map(|v| (v / weight) as f32) } else { [0.0; 3] }
    }
}
