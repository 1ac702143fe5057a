//! Clear squares.

use super::optics::Seen;
use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{ONE, Site, whole};
use lamplight::stages::clearance::{LONGEST, MATTER};
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Clearance(Kernels);

impl Clearance {
    pub fn new(device: &Device) -> Self {
        use Slot::{Read, Step, Uniform, Write};
        let slots = [Uniform, Step, Read, Read, Read, Write];
        let constants = [("LONGEST", f64::from(LONGEST)), ("MATTER", f64::from(MATTER))];
        let entries = ["begin", "double", "finish"];
        Self(Kernels::new(device, &shaders::CLEARANCE, &entries, &slots, &constants))
    }

    /// The squares, and what makes them.
    pub fn plan(&self, site: &Site, seen: &Seen) -> Result<(Buffer, Vec<Dispatch>)> {
        let squares = site.pair("clearance", site.cells() * ONE)?;
        let bind = |to: usize| {
            let (from, to) = (whole(&squares[1 - to]), whole(&squares[to]));
            let resources = [site.shared.step(), whole(&seen.source), whole(&seen.logs), from, to];
            site.bind(&self.0, &resources)
        };
        // All powers of two that the longest side holds are doubled but the last.
        let doublings = LONGEST.ilog2();
        let dispatches = site.ping_pong(&self.0, [bind(0), bind(1)], doublings);
        let last = ((doublings + 1) % 2) as usize;
        Ok((squares[last].clone(), dispatches))
    }
}
