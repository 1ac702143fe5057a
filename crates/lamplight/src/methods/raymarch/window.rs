//! The inflow of a window of a grid, traced out into the grid around it.
//!
//! Each column of a border cell is the mean over rays that are spread over the column and over the cell's edge, so
//! that lights narrower than a column are neither missed nor counted whole.

use super::march::RayScene;
use crate::grid::medium_grid::{MediumGrid, Reading};
use crate::grid::packet::LANES;
use crate::grid::traverse::Ray;
use crate::settings::Raymarch;
use crate::simd::dispatch;
use crate::stages::bounce::Surfaces;
use crate::{BorderPlace, Cells, GridWindow, Inflow, Panorama, Result, Rgb};
use fearless_simd::{Level, f32x16, prelude::*};
use std::f64::consts::TAU;

/// Rays of a column and a border cell.
const RAYS: usize = 4;
/// Their order along the edge of the cell.
const ALONG: [f32; RAYS] = [1.0, 3.0, 0.0, 2.0];
/// The least cosine between a ray and the outward normal: columns that look inward see what grazes the border.
const GRAZING: f32 = 1e-3;

/// Traces the inflow of a window of a grid, whose surfaces send this light on. Emission and occupied cells are those of the
/// settings; rays are exact.
pub fn inflow(
    level: Level,
    cells: &Cells,
    &Raymarch { emission_multiplier, threshold, .. }: &Raymarch,
    surfaces: &Surfaces,
    window: GridWindow,
    columns: usize,
) -> Result<Inflow> {
    let mut grid = MediumGrid::default();
    grid.read(cells, Reading { threshold, ..Reading::default() });
    grid.read_emission(cells, emission_multiplier);
    surfaces.scatter_into(cells, emission_multiplier, &mut grid);
    grid.measure_empty_space(|_, _| false);
    let settings = Raymarch::default();
    let scene = RayScene {
        settings: &settings,
        grid: &grid,
        changed: &[],
        surfaces,
        distance: &[],
        nearest: &[],
    };
    Inflow::of_strips(window.size, columns, |place, strip| {
        dispatch!(level, simd => trace(simd, scene, window.first, place, strip));
    })
}

/// Fills the columns of a border cell.
#[inline(always)]
fn trace<S: Simd>(
    simd: S,
    scene: RayScene,
    first: [u32; 2],
    BorderPlace { at, outward }: BorderPlace,
    strip: &mut [Rgb],
) {
    let at = [0, 1].map(|a| first[a] as f32 + at[a]);
    let cell = [0, 1].map(|a| (at[a] + 0.5 * outward[a]).floor());
    let inside = scene.grid.holds(cell.map(|v| v as i32));
    let tangent = [-outward[1], outward[0]];
    let count = strip.len();
    for (group, columns) in strip.chunks_mut(LANES / RAYS).enumerate() {
        let mut rays = [([0.0; 2], [0.0; 2]); LANES];
        for (lane, ray) in rays.iter_mut().enumerate() {
            let (column, number) = (group * (LANES / RAYS) + lane / RAYS, lane % RAYS);
            let spread = (number as f64 + 0.5) / RAYS as f64 - 0.5;
            let angle = Panorama::angle(count, column.min(count - 1)) + spread * TAU / count as f64;
            let (sin, cos) = angle.sin_cos();
            let along = (ALONG[number] + 0.5) / RAYS as f32 - 0.5;
            let from = [0, 1].map(|a| at[a] + along * tangent[a]);
            *ray = (from, out([cos as f32, sin as f32], outward));
        }
        let part = |of: fn(&([f32; 2], [f32; 2])) -> f32| f32x16::from_fn(simd, |l| of(&rays[l]));
        let seen: [Rgb; LANES] = if inside {
            let ray = Ray {
                from: [part(|(from, _)| from[0]), part(|(from, _)| from[1])],
                cell: cell.map(|v| f32x16::splat(simd, v)),
                direction: [part(|(_, way)| way[0]), part(|(_, way)| way[1])],
            };
            scene.march(simd, ray, false).map(|seen| seen.light)
        } else {
            rays.map(|(from, direction)| scene.grid.entering(from, direction))
        };
        for (column, seen) in columns.iter_mut().zip(seen.chunks(RAYS)) {
            *column = [0, 1, 2].map(|c| seen.iter().map(|rgb| rgb[c]).sum::<f32>() / RAYS as f32);
        }
    }
}

/// Returns a unit direction, turned outward if it does not lead there.
fn out(direction: [f32; 2], outward: [f32; 2]) -> [f32; 2] {
    let cosine = direction[0] * outward[0] + direction[1] * outward[1];
    if cosine >= GRAZING {
        return direction;
    }
    let turned = [0, 1].map(|a| direction[a] + (GRAZING - cosine) * outward[a]);
    let length = turned[0].hypot(turned[1]);
    turned.map(|v| v / length)
}
