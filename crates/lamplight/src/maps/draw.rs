//! Drawing of a map into the cells of a window.

use super::tile_map::{Flips, MapTile, Places, Sheet, Square, TileLayer, TileMap};
use crate::scene::picture::Picture;
use crate::scene::pictures::Pictures;
use crate::scene::raster::{cover_matter, lay};
use crate::scene::source::Source;
use crate::{Cells, Error, Result};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Draws a map whose upper left corner is at this cell of a window, which may lie beyond it; no more than lies in `clip`.
pub(super) fn draw(
    map: &TileMap,
    corner: [i64; 2],
    clip: [Range<i64>; 2],
    pictures: &Pictures,
    cells: &mut Cells,
) -> Result<()> {
    let grid = [cells.width(), cells.height()].map(i64::from);
    let window: [Range<i64>; 2] = [0, 1].map(|a| {
        let end = corner[a] + i64::from(map.size[a]);
        corner[a].max(clip[a].start).max(0)..end.min(clip[a].end).min(grid[a])
    });
    if window.iter().any(Range::is_empty) {
        return Ok(());
    }
    let background = map.background.unwrap_or([1.0; 3]);
    for (x, y) in window[1].clone().flat_map(|y| window[0].clone().map(move |x| (x, y))) {
        let i = cells.index(x as u32, y as u32);
        cells.color_mut()[i] = background;
    }
    let mut drawing = Drawing { map, corner, window, pictures, cells, open: None };
    map.layers.iter().try_for_each(|layer| drawing.layer(layer)).map_err(|e| e.in_file(&map.file))
}

struct Drawing<'a> {
    map: &'a TileMap,
    corner: [i64; 2],
    /// The cells in which the map lies.
    window: [Range<i64>; 2],
    pictures: &'a Pictures,
    cells: &'a mut Cells,
    /// The sheet that was used last.
    open: Option<(u32, Arc<Picture>)>,
}

impl Drawing<'_> {
    fn layer(&mut self, layer: &TileLayer) -> Result<()> {
        let has_tiles = !matches!(layer.places, Places::Squares { .. });
        if has_tiles && layer.matter.iter().all(|tile| !tile.paints && tile.matter.is_none()) {
            return Ok(());
        }
        let offset = [0, 1].map(|a| self.corner[a] + i64::from(layer.offset[a]));
        match &layer.places {
            Places::List(tiles) => {
                for placed in tiles {
                    let at = [0, 1].map(|a| offset[a] + i64::from(placed.at[a]));
                    let tile = self.tile(layer, placed.number)?;
                    self.place(layer, tile, placed.flips, at)?;
                }
            }
            Places::Squares { side, columns, cells, squares } => {
                for y in self.window[1].clone() {
                    for x in self.window[0].clone() {
                        let [column, row] =
                            [x - offset[0], y - offset[1]].map(|v| v.div_euclid(i64::from(*side)));
                        let index = row * i64::from(*columns) + column;
                        let inside = (0..i64::from(*columns)).contains(&column) && row >= 0;
                        let kind = cells.get(index as usize).filter(|kind| inside && **kind > 0);
                        if let Some(kind) = kind {
                            let square = &squares[*kind as usize - 1];
                            self.square(layer, square, [x as u32, y as u32])?;
                        }
                    }
                }
            }
            Places::Grid { cell, chunks } => {
                let reach = self.reach(*cell);
                for chunk in chunks {
                    // Columns and rows whose tiles may reach into the window.
                    let range = |a: usize| {
                        let first = offset[a] + i64::from(chunk.first[a]) * i64::from(cell[a]);
                        let pitch = i64::from(cell[a]);
                        let begin = (self.window[a].start - first - reach).div_euclid(pitch);
                        let end = (self.window[a].end - first + reach).div_euclid(pitch) + 1;
                        begin.max(0)..end.min(chunk.size[a].into())
                    };
                    let [columns, rows] = [range(0), range(1)];
                    for (column, row) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
                        let tile =
                            chunk.tiles[row as usize * chunk.size[0] as usize + column as usize];
                        let Some(number) = tile.number() else { continue };
                        let found = self.tile(layer, number)?;
                        let place = [column, row];
                        let corner = |a: usize| {
                            offset[a] + (i64::from(chunk.first[a]) + place[a]) * i64::from(cell[a])
                        };
                        // It stands on the bottom of its cell.
                        let height = drawn_size(&found, tile.flips())[1];
                        let at = [corner(0), corner(1) + i64::from(cell[1]) - i64::from(height)];
                        self.place(layer, found, tile.flips(), at)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn square(&mut self, layer: &TileLayer, square: &Square, [x, y]: [u32; 2]) -> Result<()> {
        let i = self.cells.index(x, y);
        if let Some(color) = square.color {
            lay(&mut self.cells.color_mut()[i], color, layer.opacity);
        }
        let Some((matter, by_picture)) = &square.matter else { return Ok(()) };
        let rgb = if *by_picture { self.cells.color_mut()[i] } else { [1.0; 3] };
        cover_matter(matter, (rgb, 1.0), [x, y], self.cells).map_err(|e| e.under(&layer.name))
    }

    /// The distance that a tile may reach beyond its cell, px.
    fn reach(&self, cell: [u32; 2]) -> i64 {
        let beyond = |tile: &MapTile| {
            let size = tile.size[0].max(tile.size[1]).saturating_sub(cell[0].min(cell[1]));
            let offset = tile.offset[0].unsigned_abs().max(tile.offset[1].unsigned_abs());
            i64::from(size) + i64::from(offset)
        };
        self.map.tiles.iter().flatten().map(beyond).max().unwrap_or(0)
    }

    fn tile(&self, layer: &TileLayer, number: u32) -> Result<MapTile> {
        self.map.tile(number).ok_or_else(|| {
            let problem = format!("has a tile of number {number}, which is in no tileset");
            Error::Key { key: layer.name.clone(), problem }
        })
    }

    /// Draws a tile whose upper left corner is at a cell of the window.
    fn place(
        &mut self,
        layer: &TileLayer,
        tile: MapTile,
        flips: Flips,
        at: [i64; 2],
    ) -> Result<()> {
        let size = drawn_size(&tile, flips);
        let at = [0, 1].map(|a| at[a] + i64::from(tile.offset[a]));
        let [columns, rows] = [0, 1].map(|a| {
            let end = at[a] + i64::from(size[a]);
            at[a].max(self.window[a].start)..end.min(self.window[a].end)
        });
        let act = &layer.matter[tile.properties as usize];
        if columns.is_empty() || rows.is_empty() || !act.paints && act.matter.is_none() {
            return Ok(());
        }
        let sheet = &self.map.sheets[tile.sheet as usize];
        let picture = self.picture(tile, sheet)?;
        for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
            let [u, v] = source_px([x - at[0], y - at[1]].map(|v| v as u32), size, flips);
            let (rgb, alpha) = picture.color(tile.from[0] + u, tile.from[1] + v);
            if alpha == 0.0 || sheet.transparent == Some(rgb) {
                continue;
            }
            let cell = [x as u32, y as u32];
            if let Some(matter) = &act.matter {
                cover_matter(matter, (rgb, alpha), cell, self.cells)
                    .map_err(|e| e.in_file(&sheet.path).under(&layer.name))?;
            }
            if act.paints {
                let i = self.cells.index(cell[0], cell[1]);
                let paint = std::array::from_fn(|c| (rgb[c] * layer.tint[c]).clamp(0.0, 1.0));
                lay(&mut self.cells.color_mut()[i], paint, alpha * layer.opacity);
            }
        }
        Ok(())
    }

    /// Reads the sheet of a tile, and checks that the tile lies in it.
    fn picture(&mut self, tile: MapTile, sheet: &Sheet) -> Result<Arc<Picture>> {
        let end = [0, 1].map(|a| u64::from(tile.from[a]) + u64::from(tile.size[a]));
        let fits = |width: u32, height: u32| {
            Cells::check_size(width.into(), height.into())
                .map_err(|e| e.in_file(&sheet.path).under(&sheet.name))?;
            if end[0] <= u64::from(width) && end[1] <= u64::from(height) {
                return Ok(());
            }
            let problem = format!(
                "has a tile at {:?} of {}×{} px, outside its image of {width}×{height} px ({})",
                tile.from,
                tile.size[0],
                tile.size[1],
                sheet.path.display()
            );
            Err(Error::Key { key: sheet.name.clone(), problem })
        };
        if let Some((open, picture)) = &self.open
            && *open == tile.sheet
        {
            let [width, height] = picture.size();
            fits(width, height)?;
            return Ok(picture.clone());
        }
        let folder = Source::Folder(Path::new(""));
        let picture = self.pictures.get(folder, &sheet.path, &sheet.name, fits)?;
        self.open = Some((tile.sheet, picture.clone()));
        Ok(picture)
    }
}

/// The size of a tile as it is drawn.
fn drawn_size(tile: &MapTile, flips: Flips) -> [u32; 2] {
    let [width, height] = tile.size;
    if flips.diagonal { [height, width] } else { tile.size }
}

/// The px of a tile that is drawn at a px of it, turned over.
fn source_px([mut x, mut y]: [u32; 2], size: [u32; 2], flips: Flips) -> [u32; 2] {
    if flips.horizontal {
        x = size[0] - 1 - x;
    }
    if flips.vertical {
        y = size[1] - 1 - y;
    }
    if flips.diagonal { [y, x] } else { [x, y] }
}
