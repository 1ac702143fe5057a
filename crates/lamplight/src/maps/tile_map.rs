//! A map as any editor has it: layers of tiles over a background, lamps and suns.

use super::tile_matter::TileMatter;
use crate::recent::Bytes;
use crate::scene::Shape;
use crate::{Lamp, Rgb, Sky, Sun};
use std::path::PathBuf;

/// A map. All positions are px of the map, from its upper left corner.
#[derive(Debug, Default)]
pub(super) struct TileMap {
    /// The file, for errors.
    pub file: PathBuf,
    /// The other files that it was read from, except for the images of its tiles.
    pub files: Vec<PathBuf>,
    /// The place of the upper left corner in the map's own coordinates: infinite maps may begin anywhere.
    pub first: [i32; 2],
    pub size: [u32; 2],
    /// The colour under all layers; none is white.
    pub background: Option<Rgb>,
    pub sheets: Vec<Sheet>,
    /// Tiles by number. There may be gaps.
    pub tiles: Vec<Option<MapTile>>,
    /// Layers, the lowest first.
    pub layers: Vec<TileLayer>,
    pub lamps: Vec<Lamp>,
    pub suns: Vec<Sun>,
    pub sky: Option<Sky>,
}

/// An image of tiles.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    /// A description for errors.
    pub name: String,
    pub path: PathBuf,
    /// The colour of pixels that are transparent.
    pub transparent: Option<Rgb>,
}

/// A tile: a part of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapTile {
    /// The index of its sheet.
    pub sheet: u32,
    /// The upper left corner in the image, px.
    pub from: [u32; 2],
    pub size: [u32; 2],
    /// The distance from its place to where it is drawn, px.
    pub offset: [i32; 2],
    /// The index of its properties, those of [`TileLayer::matter`].
    pub properties: u32,
}

/// A layer of tiles.
#[derive(Debug)]
pub(super) struct TileLayer {
    /// A description for errors.
    pub name: String,
    /// The upper left corner of cell (0, 0) of the layer, px.
    pub offset: [i32; 2],
    /// The opacity of its picture, 0 to 1.
    pub opacity: f32,
    /// A factor on the colours of its picture.
    pub tint: Rgb,
    /// The effect of tiles with each set of properties.
    pub matter: Vec<TileMatter>,
    pub places: Places,
}

/// The places of a layer's tiles.
#[derive(Debug)]
pub(super) enum Places {
    /// Cells of one size. A tile that is larger stands on the bottom of its cell, and reaches up and to the right.
    Grid { cell: [u32; 2], chunks: Vec<Chunk> },
    /// Any places, in the order in which they are drawn.
    List(Vec<PlacedTile>),
    /// Squares of matter, without pictures.
    Squares {
        /// The side of a square, px.
        side: u32,
        columns: u32,
        /// The kind of every square, row by row: the index of one in `squares`, from 1; 0 is empty.
        cells: Vec<u32>,
        squares: Vec<Square>,
    },
}

/// A kind of squares.
#[derive(Debug)]
pub(super) struct Square {
    /// Its matter, and whether what was painted there before multiplies it, as the picture of a tile does.
    pub matter: Option<(Shape, bool)>,
    /// The colour that it is painted in.
    pub color: Option<Rgb>,
}

/// A rectangle of a layer's cells.
#[derive(Debug)]
pub(super) struct Chunk {
    /// Column and row of its first cell.
    pub first: [i32; 2],
    pub size: [u32; 2],
    /// Tiles, row by row.
    pub tiles: Vec<CellTile>,
}

/// The tile of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellTile(u32);

/// The ways in which a tile is turned over, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Flips {
    /// At the diagonal: x and y change places.
    pub diagonal: bool,
    pub horizontal: bool,
    pub vertical: bool,
}

impl CellTile {
    const HORIZONTAL: u32 = 1 << 31;
    const VERTICAL: u32 = 1 << 30;
    const DIAGONAL: u32 = 1 << 29;
    /// Hexagonal maps turn tiles by this bit.
    const TURN: u32 = 1 << 28;

    /// Reads a cell as Tiled writes it: the number of a tile, from 1, with its flips in the highest bits.
    pub fn of_bits(bits: u32) -> Self {
        Self(bits & !Self::TURN)
    }

    /// The number of the tile; none in an empty cell.
    pub fn number(self) -> Option<u32> {
        let number = self.0 & !(Self::HORIZONTAL | Self::VERTICAL | Self::DIAGONAL);
        (number != 0).then_some(number)
    }

    pub fn flips(self) -> Flips {
        Flips {
            diagonal: self.0 & Self::DIAGONAL != 0,
            horizontal: self.0 & Self::HORIZONTAL != 0,
            vertical: self.0 & Self::VERTICAL != 0,
        }
    }
}

/// A tile at any place.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedTile {
    /// The upper left corner, px.
    pub at: [i32; 2],
    pub number: u32,
    pub flips: Flips,
}

impl TileMap {
    /// Returns a tile by its number.
    pub fn tile(&self, number: u32) -> Option<MapTile> {
        self.tiles.get(number as usize).copied().flatten()
    }
}

impl Bytes for TileMap {
    fn bytes(&self) -> u64 {
        let places = self.layers.iter().map(|layer| match &layer.places {
            Places::Grid { chunks, .. } => chunks.iter().map(|c| size_of_val(&*c.tiles)).sum(),
            Places::List(list) => size_of_val(&**list),
            Places::Squares { cells, .. } => size_of_val(&**cells),
        });
        let rest = size_of_val(&*self.tiles) + size_of_val(&*self.lamps) + size_of::<Self>();
        (places.sum::<usize>() + rest) as u64
    }
}
