//! A canvas to paint with light: walls, glass, fog, glowing matter and lamps.
//!
//! All coordinates are px from the top left, so that windows and tests use the canvas alike. Everything
//! between [`Canvas::press`] and [`Canvas::release`], or between [`Canvas::begin`] and [`Canvas::end`], is
//! one edit of the history.

mod brush;
mod error;
mod export;
mod history;
mod import;
mod lamps;
mod limits;
mod welcome;

pub use brush::{Brush, Stuff, Tool};
pub use error::{Error, Result};
pub use export::plain_name;
pub use import::As;

use crate::look::Look;
use crate::paint::Paint;
use brush::Backdrop;
use history::{Beside, Cell, Entry, History};
use lamplight::{Cells, Matter, UP};

/// An edit in progress.
#[derive(Clone, Debug, Default)]
struct Open {
    /// Former content of touched cells, in the order in which they were touched.
    before: Vec<(u32, Cell)>,
    /// Former lamps and sky, if they were touched.
    beside: Option<Beside>,
    stroke: Option<Stroke>,
}

#[derive(Clone, Copy, Debug)]
struct Stroke {
    tool: Tool,
    brush: Brush,
    from: [f32; 2],
    last: [f32; 2],
}

/// The painted picture, its lamps and its history.
#[derive(Clone, Debug)]
pub struct Canvas {
    cells: Cells,
    /// The surface behind every cell, which erasing brings to light.
    backdrop: Vec<Backdrop>,
    look: Look,
    history: History,
    open: Option<Open>,
    /// True for each cell that the edit in progress has touched.
    touched: Vec<bool>,
}

impl Canvas {
    /// The largest number of cells: 1920×1080 and a little more.
    pub const MAX_CELLS: u32 = limits::MAX_CELLS;
    /// The largest number of lamps.
    pub const MAX_LAMPS: usize = limits::MAX_LAMPS;
    /// Most px of an image that is read: 4096×4096.
    pub const MAX_PIXELS: u32 = limits::MAX_PIXELS;
    /// The default limit on the bytes of undo and redo; see [`Canvas::set_history_limit`]. An edit that
    /// changes every cell differently fits.
    pub const HISTORY: usize = 224 << 20;

    /// An empty canvas of a grey backdrop.
    pub fn new(size: [u32; 2]) -> Result<Self> {
        Self::check_size(size)?;
        let mut cells = Cells::new(size[0], size[1])?;
        cells.color_mut().fill([0.5; 3]);
        Self::of(cells, Look { wall_depth: 5.0, ..Look::default() })
    }

    /// A canvas of cells that are there already; they are checked.
    pub fn of(mut cells: Cells, look: Look) -> Result<Self> {
        Self::check_size([cells.width(), cells.height()])?;
        cells.check()?;
        if cells.lamps().len() > Self::MAX_LAMPS {
            return Err(Error::Lamps(cells.lamps().len()));
        }
        let backdrop = backdrop_of(&mut cells);
        let touched = vec![false; cells.len()];
        let history = History::new(Self::HISTORY);
        Ok(Self { cells, backdrop, look, history, open: None, touched })
    }

    fn check_size([width, height]: [u32; 2]) -> Result<()> {
        Cells::check_size(width.into(), height.into())?;
        let n = u64::from(width) * u64::from(height);
        if n > u64::from(Self::MAX_CELLS) { Err(Error::Cells { width, height }) } else { Ok(()) }
    }

    /// The picture as cells, with its list of lamps.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.cells.width(), self.cells.height()]
    }

    /// Returns the settings for light and display.
    pub fn look(&self) -> Look {
        self.look
    }

    /// Replaces the settings for light and display. This is not an edit.
    pub fn set_look(&mut self, look: Look) {
        self.look = look;
    }

    /// The pointer is pressed: begins a stroke.
    pub fn press(&mut self, tool: Tool, brush: Brush, at: [f32; 2]) {
        self.begin();
        let Some(at) = brush::point(at) else { return };
        if let Some(open) = &mut self.open {
            open.stroke = Some(Stroke { tool, brush, from: at, last: at });
        }
        match tool {
            Tool::Fill => self.flood(brush.stuff, at),
            _ => self.drag(at),
        }
    }

    /// The pointer moves while it is pressed. Lines and rectangles are redrawn each time.
    pub fn drag(&mut self, at: [f32; 2]) {
        let stroke = self.open.as_ref().and_then(|open| open.stroke);
        let (Some(Stroke { tool, brush, from, last }), Some(at)) = (stroke, brush::point(at))
        else {
            return;
        };
        let (size, stuff, reach) = (self.size(), brush.stuff, brush.reach());
        match tool {
            Tool::Free => brush::capsule(size, last, at, reach, |i| self.touch(i, stuff)),
            Tool::Line => {
                self.revert();
                brush::capsule(size, from, at, reach, |i| self.touch(i, stuff));
            }
            Tool::Rectangle { filled } => {
                self.revert();
                let outline = (!filled).then_some(2.0 * reach);
                brush::rectangle(size, from, at, outline, |i| self.touch(i, stuff));
            }
            Tool::Fill => {}
        }
        if let Some(stroke) = self.open.as_mut().and_then(|open| open.stroke.as_mut()) {
            stroke.last = at;
        }
    }

    /// Ends a drag. Everything painted since the press is one edit.
    pub fn release(&mut self) {
        self.end();
    }

    /// Paints a stroke through points.
    pub fn stroke(&mut self, brush: Brush, points: &[[f32; 2]]) {
        if let [first, rest @ ..] = points {
            self.press(Tool::Free, brush, *first);
            rest.iter().for_each(|at| self.drag(*at));
            self.release();
        }
    }

    /// Paints a straight line.
    pub fn line(&mut self, brush: Brush, from: [f32; 2], to: [f32; 2]) {
        self.press(Tool::Line, brush, from);
        self.drag(to);
        self.release();
    }

    /// Paints the rectangle between the cells of two corners.
    pub fn rectangle(&mut self, brush: Brush, from: [f32; 2], to: [f32; 2], filled: bool) {
        self.press(Tool::Rectangle { filled }, brush, from);
        self.drag(to);
        self.release();
    }

    /// Fills the connected cells that have the same matter as the cell at a point.
    pub fn fill(&mut self, stuff: Stuff, at: [f32; 2]) {
        self.press(Tool::Fill, Brush { stuff, radius: 0.5 }, at);
        self.release();
    }

    /// Clears every cell and removes all lamps. The backdrop stays.
    pub fn clear(&mut self) {
        self.grouped(|canvas| {
            (0..canvas.cells.len()).for_each(|i| canvas.touch(i, Stuff::Erase));
            canvas.beside_mut().lamps_mut().clear();
        });
    }

    /// Begins an edit of several steps. Ends the one in progress.
    pub fn begin(&mut self) {
        self.end();
        self.open = Some(Open::default());
    }

    /// Ends the edit in progress. If it changed anything, it can be undone.
    pub fn end(&mut self) {
        let Some(Open { mut before, beside, .. }) = self.open.take() else { return };
        before.iter().for_each(|&(i, _)| self.touched[i as usize] = false);
        before.retain(|&(i, cell)| cell != self.cell(i as usize));
        before.sort_unstable_by_key(|&(i, _)| i);
        let beside = beside.filter(|beside| *beside != self.beside());
        let entry = Entry::new(before.into_iter(), beside);
        if !entry.is_empty() {
            self.history.push(entry);
        }
    }

    /// Cancels the edit in progress and restores the former content.
    pub fn cancel(&mut self) {
        self.revert();
        self.open = None;
    }

    /// Undoes the last edit. Returns whether there was one.
    pub fn undo(&mut self) -> bool {
        self.end();
        let Some(entry) = self.history.take_undo() else { return false };
        let counterpart = self.swap(&entry);
        self.history.undone(counterpart, false);
        true
    }

    /// Redoes the edit that was undone last. Returns whether there was one.
    pub fn redo(&mut self) -> bool {
        self.end();
        let Some(entry) = self.history.take_redo() else { return false };
        let counterpart = self.swap(&entry);
        self.history.undone(counterpart, true);
        true
    }

    /// The numbers of edits that can be undone and redone.
    pub fn history_depth(&self) -> [usize; 2] {
        self.history.depth()
    }

    /// Bytes that the history holds.
    pub fn history_bytes(&self) -> usize {
        self.history.bytes()
    }

    /// Sets how many bytes the history may hold. The oldest edits beyond are dropped.
    pub fn set_history_limit(&mut self, bytes: usize) {
        self.history.set_limit(bytes);
    }

    /// Runs an edit as part of the edit in progress, or as one of its own.
    fn grouped(&mut self, edit: impl FnOnce(&mut Self)) {
        if self.open.is_some() {
            return edit(self);
        }
        self.begin();
        edit(self);
        self.end();
    }

    /// The cells, to change lamps or sky. The edit in progress remembers the former ones.
    fn beside_mut(&mut self) -> &mut Cells {
        let now = self.beside();
        if let Some(open) = &mut self.open {
            open.beside.get_or_insert(now);
        }
        &mut self.cells
    }

    fn beside(&self) -> Beside {
        Beside { lamps: self.cells.lamps().to_vec(), sky: self.cells.sky().clone() }
    }

    fn cell(&self, index: usize) -> Cell {
        Cell { paint: Paint::of(&self.cells, index), backdrop: self.backdrop[index] }
    }

    fn put(&mut self, index: usize, cell: Cell) {
        cell.paint.put(&mut self.cells, index);
        self.backdrop[index] = cell.backdrop;
    }

    /// Paints a cell in the edit in progress.
    fn touch(&mut self, index: usize, stuff: Stuff) {
        let mut cell = self.cell(index);
        if let Stuff::Backdrop(color) = stuff {
            cell.backdrop.color = brush::unit(color);
            // Only open space shows the backdrop.
            if cell.paint.matter == Matter::EMPTY {
                cell.paint.color = cell.backdrop.color;
            }
        } else if let Some(paint) = stuff.paint(cell.backdrop) {
            cell.paint = paint;
        }
        self.replace(index, cell);
    }

    /// Replaces a cell in the edit in progress, which remembers the former one.
    fn replace(&mut self, index: usize, cell: Cell) {
        if !self.touched[index] {
            let before = (index as u32, self.cell(index));
            if let Some(open) = &mut self.open {
                self.touched[index] = true;
                open.before.push(before);
            }
        }
        self.put(index, cell);
    }

    /// Restores the content from before the edit in progress, which continues.
    fn revert(&mut self) {
        let Some(mut open) = self.open.take() else { return };
        for (i, cell) in open.before.drain(..) {
            self.put(i as usize, cell);
            self.touched[i as usize] = false;
        }
        if let Some(Beside { lamps, sky }) = open.beside.take() {
            *self.cells.lamps_mut() = lamps;
            self.cells.set_sky(sky);
        }
        self.open = Some(open);
    }

    /// Restores the content of an entry and returns an entry of the content that it replaced.
    fn swap(&mut self, entry: &Entry) -> Entry {
        let beside = entry.beside.is_some().then(|| self.beside());
        let now = entry.cells().map(|(i, _)| (i, self.cell(i as usize)));
        let counterpart = Entry::new(now, beside);
        entry.cells().for_each(|(i, cell)| self.put(i as usize, cell));
        if let Some(Beside { lamps, sky }) = &entry.beside {
            self.cells.lamps_mut().clone_from(lamps);
            self.cells.set_sky(sky.clone());
        }
        counterpart
    }

    /// Paints the connected cells with the same matter as the first one and, for a backdrop, the same
    /// colour.
    fn flood(&mut self, stuff: Stuff, at: [f32; 2]) {
        let [w, h] = self.size();
        if !((0.0..w as f32).contains(&at[0]) && (0.0..h as f32).contains(&at[1])) {
            return;
        }
        let start = at[1] as usize * w as usize + at[0] as usize;
        let first = self.cell(start);
        let look = |cell: &Cell| match stuff {
            Stuff::Backdrop(_) => Some((cell.paint.color, cell.backdrop.color)),
            _ => None,
        };
        let alike =
            |cell: Cell| cell.paint.matter == first.paint.matter && look(&cell) == look(&first);
        // Painted cells are touched, so each is visited once.
        let mut waiting = vec![start as u32];
        while let Some(i) = waiting.pop() {
            let i = i as usize;
            if self.touched[i] || !alike(self.cell(i)) {
                continue;
            }
            self.touch(i, stuff);
            let (x, y) = (i % w as usize, i / w as usize);
            let beside = [
                (x > 0, i.wrapping_sub(1)),
                (x + 1 < w as usize, i + 1),
                (y > 0, i.wrapping_sub(w as usize)),
                (y + 1 < h as usize, i + w as usize),
            ];
            waiting.extend(beside.iter().filter(|(there, _)| *there).map(|&(_, n)| n as u32));
        }
    }
}

/// The backdrop of every cell: the picture at open cells, and its mean colour elsewhere.
fn backdrop_of(cells: &mut Cells) -> Vec<Backdrop> {
    cells.color_mut();
    let here = |i: usize| Some(Paint::of(cells, i)).filter(|paint| paint.matter == Matter::EMPTY);
    let (mut sum, mut count) = ([0.0f64; 3], 0.0f64);
    for paint in (0..cells.len()).filter_map(here) {
        (0..3).for_each(|c| sum[c] += f64::from(paint.color[c]));
        count += 1.0;
    }
    let color = if count > 0.0 { sum.map(|v| (v / count) as f32) } else { [0.5; 3] };
    let mean = Backdrop { color, normal: UP };
    let behind =
        |i: usize| here(i).map_or(mean, |Paint { color, normal, .. }| Backdrop { color, normal });
    (0..cells.len()).map(behind).collect()
}
