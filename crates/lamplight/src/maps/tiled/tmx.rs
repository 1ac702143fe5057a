//! A map file, top to bottom.

use super::layers::{Inherited, LayerReader};
use super::lights::Lights;
use super::tilesets;
use super::xml::{at_line, color, properties, required, with_root};
use crate::maps::objects;
use crate::maps::tile_map::{Places, TileMap};
use crate::tiling::check_size;
use crate::{Error, Result};
use roxmltree::Node;
use std::path::Path;

/// Reads a map. Images are not opened.
pub(in crate::maps) fn read_map(path: &Path) -> Result<TileMap> {
    with_root(path, "map", |node| map(node, path))
}

fn map(node: Node, path: &Path) -> Result<TileMap> {
    let orientation = node.attribute("orientation").unwrap_or("orthogonal");
    if orientation != "orthogonal" {
        let error = Error::value("map.orientation", orientation, "orthogonal: others are not read");
        return Err(at_line(node, error));
    }
    let cell: [u32; 2] = [required(node, "tilewidth")?, required(node, "tileheight")?];
    let count: [u32; 2] = [required(node, "width")?, required(node, "height")?];
    let infinite = node.attribute("infinite") == Some("1");
    let mut map = TileMap {
        file: path.to_owned(),
        size: [0, 1].map(|a| cell[a].saturating_mul(count[a])),
        background: color(node, "backgroundcolor")?,
        ..TileMap::default()
    };
    objects::read_sky(&properties(node), path, &mut map).map_err(|e| at_line(node, e))?;
    if cell.contains(&0) {
        let found = format!("{}×{}", cell[0], cell[1]);
        return Err(at_line(node, Error::value("map.tilewidth", found, "1×1 px or more")));
    }
    if !infinite {
        check_size(map.size).map_err(|e| at_line(node, e))?;
    }
    let tilesets = tilesets::read(node, path, &mut map)?;
    let lights = Lights::new(path, &tilesets);
    LayerReader { map: &mut map, kinds: &tilesets.kinds, cell, infinite, lights }
        .read(node, &Inherited::default())?;
    objects::read_cookies(path, &mut map)?;
    if infinite {
        crop(&mut map, node)?;
    }
    Ok(map)
}

/// Gives an infinite map the extent of its chunks, from whose corner positions are then.
fn crop(map: &mut TileMap, node: Node) -> Result<()> {
    let mut bounds: Option<[[i64; 2]; 2]> = None;
    for layer in &map.layers {
        let Places::Grid { cell, chunks } = &layer.places else { continue };
        for chunk in chunks {
            let corner =
                |a: usize, cells: i64| cells * i64::from(cell[a]) + i64::from(layer.offset[a]);
            let begin = [0, 1].map(|a| corner(a, chunk.first[a].into()));
            let end =
                [0, 1].map(|a| corner(a, i64::from(chunk.first[a]) + i64::from(chunk.size[a])));
            bounds = Some(match bounds {
                None => [begin, end],
                Some([first, last]) => {
                    [[0, 1].map(|a| first[a].min(begin[a])), [0, 1].map(|a| last[a].max(end[a]))]
                }
            });
        }
    }
    let Some([first, last]) = bounds else {
        let problem = "is infinite and has no tile, so it has no size".to_owned();
        return Err(at_line(node, Error::Key { key: "map".into(), problem }));
    };
    let size = [0, 1].map(|a| u32::try_from(last[a] - first[a]).unwrap_or(u32::MAX));
    check_size(size).map_err(|e| at_line(node, e))?;
    let begin = first.map(i32::try_from);
    let [Ok(x), Ok(y)] = begin else {
        let found = format!("at ({}, {})", first[0], first[1]);
        return Err(at_line(node, Error::value("map", found, "nearer to the origin")));
    };
    map.first = [x, y];
    map.size = size;
    for layer in &mut map.layers {
        layer.offset = [0, 1].map(|a| layer.offset[a].saturating_sub(map.first[a]));
    }
    for lamp in &mut map.lamps {
        lamp.position = [0, 1].map(|a| lamp.position[a] - map.first[a] as f32);
    }
    Ok(())
}
