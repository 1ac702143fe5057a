//! Undo and redo with bounded memory. Former cells are run-length encoded.

use super::brush::Backdrop;
use crate::paint::Paint;
use lamplight::{Lamp, Sky};
use std::collections::VecDeque;
use std::mem::size_of;

/// A cell of the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub paint: Paint,
    pub backdrop: Backdrop,
}

/// Consecutive cells with the same content.
#[derive(Clone, Copy, Debug)]
struct Run {
    start: u32,
    len: u32,
    cell: Cell,
}

/// The lamps and the sky.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Beside {
    pub lamps: Vec<Lamp>,
    pub sky: Sky,
}

/// The content that one edit replaced.
#[derive(Clone, Debug, Default)]
pub(super) struct Entry {
    runs: Vec<Run>,
    pub beside: Option<Beside>,
}

impl Entry {
    /// Encodes cells in ascending order of their index.
    pub fn new(cells: impl Iterator<Item = (u32, Cell)>, beside: Option<Beside>) -> Self {
        let mut runs: Vec<Run> = Vec::new();
        for (index, cell) in cells {
            match runs.last_mut() {
                Some(run) if run.start + run.len == index && run.cell == cell => run.len += 1,
                _ => runs.push(Run { start: index, len: 1, cell }),
            }
        }
        runs.shrink_to_fit();
        Self { runs, beside }
    }

    pub fn is_empty(&self) -> bool {
        self.runs.is_empty() && self.beside.is_none()
    }

    /// Every cell in ascending order.
    pub fn cells(&self) -> impl Iterator<Item = (u32, Cell)> + '_ {
        self.runs.iter().flat_map(|run| (run.start..run.start + run.len).map(|i| (i, run.cell)))
    }

    fn bytes(&self) -> usize {
        let lamps = self.beside.as_ref().map_or(0, |beside| beside.lamps.capacity());
        size_of::<Self>() + self.runs.capacity() * size_of::<Run>() + lamps * size_of::<Lamp>()
    }
}

/// Edits to undo, and undone edits to redo.
#[derive(Clone, Debug)]
pub(super) struct History {
    undo: VecDeque<Entry>,
    redo: Vec<Entry>,
    bytes: usize,
    limit: usize,
}

impl History {
    pub fn new(limit: usize) -> Self {
        Self { undo: VecDeque::new(), redo: Vec::new(), bytes: 0, limit }
    }

    pub fn bytes(&self) -> usize {
        self.bytes
    }

    pub fn depth(&self) -> [usize; 2] {
        [self.undo.len(), self.redo.len()]
    }

    pub fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
        self.shrink();
    }

    /// Adds an edit and drops all edits to redo.
    pub fn push(&mut self, entry: Entry) {
        self.bytes -= self.redo.drain(..).map(|entry| entry.bytes()).sum::<usize>();
        self.undone(entry, true);
    }

    pub fn take_undo(&mut self) -> Option<Entry> {
        let entry = self.undo.pop_back()?;
        self.bytes -= entry.bytes();
        Some(entry)
    }

    pub fn take_redo(&mut self) -> Option<Entry> {
        let entry = self.redo.pop()?;
        self.bytes -= entry.bytes();
        Some(entry)
    }

    /// Adds the counterpart of an entry that was undone or redone.
    pub fn undone(&mut self, entry: Entry, to_undo: bool) {
        self.bytes += entry.bytes();
        if to_undo {
            self.undo.push_back(entry);
        } else {
            self.redo.push(entry);
        }
        self.shrink();
    }

    /// Drops the oldest edits to undo, then the last edits to redo, until the rest fits the limit.
    fn shrink(&mut self) {
        while self.bytes > self.limit {
            let oldest = self
                .undo
                .pop_front()
                .or_else(|| (!self.redo.is_empty()).then(|| self.redo.remove(0)));
            let Some(entry) = oldest else { break };
            self.bytes -= entry.bytes();
        }
    }
}
