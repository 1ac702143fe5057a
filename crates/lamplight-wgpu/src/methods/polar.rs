//! A fan of rays from every lamp, then every pixel looks its rays up: the GPU's `methods/polar` of the
//! library.
//!
//! All lamps go together: one dispatch walks their rays, one tells every ray of its neighbours' walls,
//! one lights all pixels. How many lamps there are is only known to the shaders, so that a frame with
//! fewer is recorded as it was planned; what is planned for is the room there is.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::lamps::{Fan, Lamps, RAY_BYTES, TOGETHER};
use crate::lighting::Stage;
use crate::shaders;
use crate::site::{FOUR, ONE, Run, Site, view, whole};
use crate::stages::fields::Fields;
use crate::stages::ground::Ground;
use lamplight::methods::polar::{APART, FINEST, NARROWEST, NEAREST, WIDEST, rays};
use lamplight::settings::{Blend, Edges, Polar as Settings, Walk};
use lamplight::stages::distance::MARGIN;
use lamplight::stages::transmittance::LOG_OF_ZERO;
use wgpu::{Buffer, Device};

/// Side of a tile, px.
const TILE: u32 = 16;
/// Knots of fog that there is room for, a ray. One stretch of fog takes two; where rays cross more
/// than fits, pixels find what is missing anew, which is slow and as right.
const KNOTS: u64 = 4;

/// The pipelines.
#[derive(Debug)]
pub struct Polar {
    ground: Ground,
    /// Where rays go by it.
    fields: Option<Fields>,
    rays: Kernels,
    bounds: Kernels,
    pixels: Kernels,
}

/// How a lamp is lit in a grid.
pub fn fan(lamp: &lamplight::Lamp, size: [u32; 2], settings: &Settings) -> Fan {
    let (reach, count) = rays(lamp, size, settings);
    Fan {
        reach,
        count: count as u32,
        soft: if settings.edges == Edges::Soft { lamp.size } else { 0.0 },
        falloff: Some(settings.falloff.unwrap_or(lamp.falloff)),
    }
}

impl Polar {
    pub fn new(device: &Device, settings: &Settings) -> Self {
        use Slot::{Read, Texture, Uniform, Write};
        let edges = match settings.edges {
            Edges::Soft => 0.0,
            Edges::Linear => 1.0,
            Edges::Nearest => 2.0,
        };
        let walk = match settings.walk {
            Walk::Edge => 0.0,
            Walk::Step => 1.0,
            Walk::Distance => 2.0,
        };
        let blend = match settings.blend {
            Blend::Add => 0.0,
            Blend::Max => 1.0,
            Blend::Screen => 2.0,
        };
        let widths = [("NARROWEST", f64::from(NARROWEST)), ("WIDEST", f64::from(WIDEST))];
        let fan = [
            ("TRANSLUCENT", f64::from(u8::from(settings.translucent))),
            ("LOG_OF_ZERO", f64::from(LOG_OF_ZERO)),
            ("WALK", walk),
            ("MARGIN", f64::from(MARGIN)),
            ("FINEST", f64::from(FINEST)),
            ("APART", f64::from(APART)),
        ];
        let crisp = f64::from(u8::from(settings.edges == Edges::Nearest));
        let bound = [("NEAREST", f64::from(NEAREST)), ("CRISP", crisp)];
        let look = [("EDGES", edges), ("BLEND", blend)];
        let kernels = |shader, slots: &[_], constants: &[_]| {
            Kernels::new(device, shader, &["main"], slots, constants)
        };
        Self {
            ground: Ground::new(device),
            fields: (settings.walk == Walk::Distance).then(|| Fields::new(device)),
            rays: kernels(
                &shaders::POLAR_RAYS,
                &[Uniform, Read, Texture, Read, Read, Write, Write, Write, Write],
                &fan,
            ),
            bounds: kernels(
                &shaders::POLAR_BOUNDS,
                &[Uniform, Read, Read, Write],
                &[&bound[..], &widths].concat(),
            ),
            pixels: kernels(
                &shaders::POLAR,
                &[Uniform, Read, Texture, Read, Read, Read, Read, Read, Read, Write],
                &[&fan[..], &widths, &look].concat(),
            ),
        }
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        // Settings may come before the lamps that they light.
        let rays = site.room.rays.max(TOGETHER.into());
        let ground = self.ground.plan(site)?;
        let lamps = site.buffer("lamps", Lamps::bytes(site.room.lamps))?;
        let hits = site.buffer("hits", rays * 2 * ONE)?;
        let stretches = site.buffer("stretches of fog", rays * 2 * ONE)?;
        let bounds = site.buffer("bounds of rays", rays * RAY_BYTES)?;
        let translucent = site.settings.polar.translucent;
        let knots = if translucent { (rays * KNOTS).min(site.most_bytes() / FOUR) } else { 1 };
        let knots = site.buffer("knots of fog", knots * FOUR)?;
        let (distance, mut dispatches, mut stages) = match &self.fields {
            Some(fields) => {
                let measured = fields.plan(site)?;
                (measured.distance, measured.run.dispatches, measured.run.stages)
            }
            None => (site.buffer("no distance", ONE)?, Vec::new(), Vec::new()),
        };
        let fan = [
            whole(&lamps),
            view(&site.textures.tint_opacity),
            whole(&ground.kinds),
            whole(&distance),
        ];
        let store = [whole(&stretches), whole(&knots), whole(&ground.used)];
        let walked = site.bind(&self.rays, &[&fan[..], &[whole(&hits)], &store].concat());
        let told = site.bind(&self.bounds, &[whole(&lamps), whole(&hits), whole(&bounds)]);
        let rest = [&[whole(&bounds)], &store[..], &[whole(light)]].concat();
        let seen = site.bind(&self.pixels, &[&fan[..], &rest].concat());
        let tiles = site.size.map(|side| side.div_ceil(TILE));
        let groups = site.groups(rays / u64::from(TOGETHER));
        dispatches.extend([
            ground.read,
            Dispatch::new(&self.rays.entries[0], &walked, None, groups),
            Dispatch::new(&self.bounds.entries[0], &told, None, groups),
            Dispatch::new(&self.pixels.entries[0], &seen, None, [tiles[0], tiles[1], 1]),
        ]);
        stages.push((Stage::Light, light.clone()));
        Ok(Run { dispatches, stages, lamps: Some(lamps) })
    }
}
