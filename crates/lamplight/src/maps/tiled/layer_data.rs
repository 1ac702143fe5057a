//! The cells of a layer, as CSV, Base64 (plain, zlib or gzip) or elements.

use super::xml::{at_line, attribute, children, required};
use crate::maps::tile_map::{CellTile, Chunk};
use crate::{Error, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::{GzDecoder, ZlibDecoder};
use roxmltree::Node;
use std::io::Read;

/// The most cells of a layer: those of the largest world in tiles of 8 px.
const MAX_CELLS: u64 = 1 << 26;

/// Reads the element `data` of a layer of this size: one chunk, or those of an infinite map.
pub(super) fn read(data: Node, size: [u32; 2], infinite: bool) -> Result<Vec<Chunk>> {
    if !infinite {
        let chunk = chunk(data, data, [0, 0], size)?;
        return Ok(vec![chunk]);
    }
    let mut left = MAX_CELLS;
    let mut chunks = Vec::new();
    for node in children(data, "chunk") {
        let size = [required(node, "width")?, required(node, "height")?];
        let first: [i32; 2] = [required(node, "x")?, required(node, "y")?];
        if first.iter().any(|v| v.unsigned_abs() > FARTHEST) {
            let found = format!("at ({}, {})", first[0], first[1]);
            let expected = format!("at most {FARTHEST} cells away");
            return Err(at_line(node, Error::value("chunk", found, expected)));
        }
        let chunk = chunk(data, node, first, size)?;
        left = left.checked_sub(chunk.tiles.len() as u64).ok_or_else(|| too_large(node, size))?;
        chunks.push(chunk);
    }
    Ok(chunks)
}

/// The farthest cell of an infinite map.
const FARTHEST: u32 = 1 << 24;

fn too_large(node: Node, [width, height]: [u32; 2]) -> Error {
    let found = format!("{width}×{height} cells");
    at_line(node, Error::value("layer", found, format!("at most {MAX_CELLS} cells in all")))
}

/// Reads a rectangle of cells from the text of an element, encoded as `data` says.
fn chunk(data: Node, node: Node, first: [i32; 2], size: [u32; 2]) -> Result<Chunk> {
    let count = u64::from(size[0]) * u64::from(size[1]);
    if count > MAX_CELLS || size.iter().any(|v| u64::from(*v) > MAX_CELLS) {
        return Err(too_large(node, size));
    }
    let count = count as usize;
    let text: String =
        node.children().filter(Node::is_text).filter_map(|text| text.text()).collect();
    let compression = data.attribute("compression").filter(|name| !name.is_empty());
    let tiles = match data.attribute("encoding") {
        Some("csv") => csv(node, &text)?,
        Some("base64") => base64(node, &text, compression, count)?,
        None => children(node, "tile")
            .map(|tile| Ok(CellTile::of_bits(attribute(tile, "gid")?.unwrap_or(0))))
            .collect::<Result<_>>()?,
        Some(other) => {
            let error = Error::value("data.encoding", other, "csv or base64");
            return Err(at_line(data, error));
        }
    };
    if tiles.len() != count {
        let found = format!("{} cells", tiles.len());
        let expected = format!("{count}, for {}×{} cells", size[0], size[1]);
        return Err(at_line(node, Error::value("data", found, expected)));
    }
    Ok(Chunk { first, size, tiles })
}

fn csv(node: Node, text: &str) -> Result<Vec<CellTile>> {
    let numbers = text.split(',').map(str::trim).filter(|number| !number.is_empty());
    let tile = |number: &str| {
        let shown: String = number.chars().take(40).collect();
        let wrong = || Error::value("data", shown, "whole numbers, separated by commas");
        number.parse().map(CellTile::of_bits).map_err(|_| at_line(node, wrong()))
    };
    numbers.map(tile).collect()
}

fn base64(
    node: Node,
    text: &str,
    compression: Option<&str>,
    count: usize,
) -> Result<Vec<CellTile>> {
    let wrong = |problem: String| at_line(node, Error::Key { key: "data".into(), problem });
    if let Some(other) = compression.filter(|name| !["zlib", "gzip"].contains(name)) {
        let expected =
            "zlib, gzip or none: choose another Tile Layer Format in the properties of the map";
        return Err(at_line(node, Error::value("data.compression", other, expected)));
    }
    let text: String = text.split_ascii_whitespace().collect();
    let bytes = STANDARD.decode(text).map_err(|e| wrong(format!("is not Base64: {e}")))?;
    // No more than it should hold: a small file can unpack to a large one.
    let most = 4 * count as u64 + 4;
    let unpack = |mut reader: Box<dyn Read + '_>| {
        let mut unpacked = Vec::new();
        let read = reader.read_to_end(&mut unpacked);
        read.map_err(|e| wrong(format!("cannot be unpacked: {e}"))).map(|_| unpacked)
    };
    let bytes = match compression {
        None => bytes,
        Some("gzip") => unpack(Box::new(GzDecoder::new(&*bytes).take(most)))?,
        Some(_) => unpack(Box::new(ZlibDecoder::new(&*bytes).take(most)))?,
    };
    let (cells, rest) = bytes.as_chunks::<4>();
    if !rest.is_empty() {
        return Err(wrong(format!("has {} bytes, which are not whole cells", bytes.len())));
    }
    Ok(cells.iter().map(|bytes| CellTile::of_bits(u32::from_le_bytes(*bytes))).collect())
}
