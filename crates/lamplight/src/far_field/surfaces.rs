//! The radiance that the surfaces of a world send on, part by part.

use super::block::PackedRgb;
use crate::GridWindow;
use crate::stages::bounce::{SurfaceLight, Surfaces};
use serde::{Deserialize, Serialize};

/// The radiance that the surfaces of a part send on, by cell: its index in the part, row by row.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PartLight {
    /// The first cell of the part in the world, and its size.
    first: [u32; 2],
    size: [u32; 2],
    walls: Vec<(u32, [PackedRgb; 4])>,
    media: Vec<(u32, PackedRgb)>,
}

impl PartLight {
    /// That of a part whose surfaces send nothing on.
    pub fn none(GridWindow { first, size }: GridWindow) -> Self {
        Self { first, size, walls: Vec::new(), media: Vec::new() }
    }

    /// The window of the part.
    pub fn window(&self) -> GridWindow {
        GridWindow { first: self.first, size: self.size }
    }

    /// Returns whether all cells are those of the part, which is not empty.
    pub fn is_sound(&self) -> bool {
        let count = self.size.map(u64::from).iter().product::<u64>();
        let walls = self.walls.iter().map(|(cell, _)| *cell);
        let mut cells = walls.chain(self.media.iter().map(|(cell, _)| *cell));
        count > 0 && cells.all(|cell| u64::from(cell) < count)
    }

    /// Returns it with no more than the cells of a window, unless none are in both.
    pub fn within(&self, window: GridWindow) -> Option<Self> {
        let end = |of: GridWindow, a: usize| of.first[a] + of.size[a];
        let both = (0..2).all(|a| {
            self.first[a].max(window.first[a]) < end(self.window(), a).min(end(window, a))
        });
        let inside = |cell: u32| self.window().index_in(window, cell).is_some();
        both.then(|| Self {
            walls: self.walls.iter().filter(|(cell, _)| inside(*cell)).copied().collect(),
            media: self.media.iter().filter(|(cell, _)| inside(*cell)).copied().collect(),
            ..Self::none(self.window())
        })
    }

    /// Keeps what is known of a part, of the grid of a window around it.
    pub fn of(surfaces: &Surfaces, around: GridWindow, part: GridWindow) -> Self {
        let place = |cell: u32| around.index_in(part, cell);
        let walls = surfaces.walls.iter().zip(&surfaces.wall_reflected);
        let walls = walls.filter(|(wall, _)| wall.reflects).filter_map(|(wall, faces)| {
            place(wall.cell).map(|cell| (cell, faces.map(PackedRgb::new)))
        });
        let media = surfaces.media.iter().zip(&surfaces.medium_scattered);
        let media = media
            .filter_map(|(&cell, &light)| place(cell).map(|cell| (cell, PackedRgb::new(light))));
        Self { walls: walls.collect(), media: media.collect(), ..Self::none(part) }
    }

    /// Adds what is known of the cells of a window of the world.
    pub fn add_to(&self, light: &mut SurfaceLight, window: GridWindow) {
        let place = |cell: u32| self.window().index_in(window, cell);
        let walls = self.walls.iter().filter_map(|(cell, faces)| {
            place(*cell).map(|cell| (cell, faces.map(PackedRgb::unpack)))
        });
        light.walls.extend(walls);
        let media = self.media.iter();
        light.media.extend(media.filter_map(|(cell, light)| Some((place(*cell)?, light.unpack()))));
    }

    /// Returns the sum of all that is sent, and of its changes since `before`.
    pub fn change(&self, before: Option<&Self>) -> [f64; 2] {
        let values = |part: &Self| -> Vec<f32> {
            let walls = part.walls.iter().flat_map(|(_, faces)| faces.map(PackedRgb::unpack));
            let media = part.media.iter().map(|(_, light)| light.unpack());
            walls.chain(media).flatten().collect()
        };
        let now = values(self);
        let before = before.map(values).unwrap_or_default();
        let old = before.into_iter().chain(std::iter::repeat(0.0));
        now.iter().zip(old).fold([0.0; 2], |[sum, change], (now, old)| {
            [sum + f64::from(*now), change + f64::from((now - old).abs())]
        })
    }
}
