//! Tables that are the same for every frame: the footprints of rays.

use lamplight::internals::holographic::lattice::{Crossing, GatherGeometry, bundle, rays};

/// Rows to either side that a mask covers.
pub const ASIDE: isize = 32;

/// An entry of the table.
type Entry = [u32; 2];

/// The footprints of bundles and of the final gather, as footprint.wgsl reads them.
#[derive(Debug, Default)]
pub struct Footprints {
    pub entries: Vec<Entry>,
    /// The first entries of bundles, and of the list of views.
    pub bundles: u32,
    pub views: u32,
}

impl Footprints {
    pub fn new(geometry: GatherGeometry, width: u32) -> Self {
        let mut footprints = Self::default();
        footprints.bundles([geometry.first(), geometry.spacing_level], width);
        footprints.views(geometry);
        footprints
    }

    /// Appends the bundles. Each has a mask, then the crossings of each ray.
    fn bundles(&mut self, [level, spacing_level]: [u32; 2], width: u32) {
        let bundle = |ray| bundle([level, spacing_level], ray, width);
        let bundles: Vec<_> = (0..rays(level)).map(bundle).collect();
        let mut records = Vec::new();
        for rays in &bundles {
            let cells = rays.iter().flatten().map(|crossing| (crossing.slab, crossing.row));
            records.extend(mask((1 << (level + spacing_level)) + 1, cells));
            records.extend(rays.iter().map(|ray| self.crossings(ray)));
        }
        self.bundles = self.entries.len() as u32;
        self.entries.extend(records);
    }

    /// Appends, for every distance to the plane, its cones: cosines; angle; rays: crossings, end; a mask.
    fn views(&mut self, geometry: GatherGeometry) {
        let mut begins = Vec::new();
        for ahead in geometry.min_length..=geometry.max_length() {
            let mut records = Vec::new();
            for cone in geometry.cones(ahead) {
                records.extend([cone.cosines.map(f32::to_bits), [cone.angle.to_bits(), 0]]);
                for ray in &cone.rays {
                    records.push(self.crossings(&ray.crossings));
                    records.push([ray.row as i32 as u32, ray.past.to_bits()]);
                }
                let crossed = cone.rays.iter().flat_map(|ray| &ray.crossings);
                let crossed = crossed.map(|crossing| (crossing.slab, crossing.row));
                let ends =
                    cone.rays.iter().flat_map(|ray| [-1, 0, 1].map(|side| (ahead, ray.row + side)));
                records.extend(mask(ahead + 1, crossed.chain(ends)));
            }
            begins.push([self.entries.len() as u32, 0]);
            self.entries.extend(records);
        }
        self.views = self.entries.len() as u32;
        self.entries.extend(begins);
    }

    /// Appends crossings. Returns where they begin, and their number.
    fn crossings(&mut self, crossings: &[Crossing]) -> Entry {
        let first = self.entries.len() as u32;
        self.entries.extend(crossings.iter().map(|crossing| {
            let row = (crossing.row + 128) as u32;
            let cell = crossing.slab as u32 | row << 8 | (crossing.face as u32) << 16;
            [cell, crossing.length.to_bits()]
        }));
        [first, crossings.len() as u32]
    }
}

/// The mask of cells by slab: rows from −32 to −1, and from 0 to 31.
fn mask(slabs: usize, cells: impl Iterator<Item = (usize, isize)>) -> Vec<Entry> {
    let mut entries = vec![[0; 2]; slabs];
    for (slab, row) in cells {
        let bit = (row + ASIDE) as usize;
        entries[slab][bit / 32] |= 1 << (bit % 32);
    }
    entries
}
