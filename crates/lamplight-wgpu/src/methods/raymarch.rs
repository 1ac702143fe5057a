//! Rays from every pixel: the GPU's `methods/raymarch` of the library.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::lighting::Stage;
use crate::shaders;
use crate::shared::filled;
use crate::site::{FOUR, Run, Site, view, whole};
use crate::stages::clearance::Clearance;
use crate::stages::fields::Fields;
use crate::stages::optics::{Optics, Seen};
use lamplight::methods::raymarch::{GOLDEN_RATIO, NEVER, directions};
use lamplight::settings::{Bounces, Hit};
use lamplight::stages::clearance::{LONGEST, MATTER};
use lamplight::stages::distance::MARGIN;
use lamplight::stages::seed::NONE;
use lamplight::stages::transmittance::OPAQUE;
use lamplight::{Settings, stages::noise};
use wgpu::{Buffer, BufferUsages, Device, Queue};

/// The pipelines, and what is the same for every grid.
#[derive(Debug)]
pub struct Raymarch {
    optics: Optics,
    by: By,
    rays: Kernels,
    blue: Buffer,
    directions: Buffer,
}

/// What rays go by.
#[derive(Debug)]
enum By {
    Squares(Clearance),
    Distance(Fields),
}

/// The buffers that a gather reads and writes.
struct Buffers<'a> {
    seen: &'a Seen,
    by: [Buffer; 2],
    /// What surfaces send on, by face; next to nothing where light does not bounce.
    sent: [Buffer; 2],
    light: &'a Buffer,
}

impl Raymarch {
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        let ways: Vec<[f32; 2]> = directions(&settings.raymarch).collect();
        let storage = |label, bytes| filled(device, queue, label, BufferUsages::STORAGE, bytes);
        let hit = settings.raymarch.hit;
        let (shader, march, by) = match hit {
            Hit::Edge => (&shaders::RAYMARCH, MARCH_EDGE, By::Squares(Clearance::new(device))),
            Hit::Distance => {
                (&shaders::RAYMARCH_DISTANCE, MARCH_DISTANCE, By::Distance(Fields::new(device)))
            }
        };
        let slots = [Uniform, Read, Read, Read, Read, Read, Read, Step, Texture, Write];
        Self {
            optics: Optics::new(device),
            by,
            rays: Kernels::new(
                device,
                shader,
                &["main", "receive"],
                &slots,
                &[GATHER, march].concat(),
            ),
            blue: storage("blue noise", noise::blue()),
            directions: storage("directions", bytemuck::cast_slice(&ways)),
        }
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        let bounces = site.settings.bounces.limit();
        let seen = self.optics.buffers(site)?;
        let faces = if site.settings.bounces == Bounces::Count(0) { 0 } else { 4 };
        let sent = site.pair("sent", (site.cells() * faces).max(1) * FOUR)?;
        // Fog that sends other light on is other matter, to squares.
        let (near, again, mut stages);
        let (by, found) = match &self.by {
            By::Squares(clearance) => {
                let (squares, dispatches) = clearance.plan(site, &seen)?;
                (near, again) = (squares, true);
                stages = vec![(Stage::Clearance, near.clone())];
                ([seen.logs.clone(), near.clone()], dispatches)
            }
            By::Distance(fields) => {
                let measured = fields.plan(site)?;
                (near, again) = (measured.nearest, false);
                stages = measured.run.stages;
                ([near.clone(), measured.distance], measured.run.dispatches)
            }
        };
        let buffers = Buffers { seen: &seen, by, sent, light };
        let sent = &buffers.sent;
        let mut dispatches = vec![self.optics.read(site, &seen, &sent[0])];
        dispatches.extend_from_slice(&found);
        for bounce in 0..bounces {
            dispatches.push(self.gather(site, 1, bounce, &buffers));
            dispatches.push(self.optics.light_fog(site, &seen, &sent[bounce as usize % 2]));
            if again {
                dispatches.extend_from_slice(&found);
            }
        }
        dispatches.push(self.gather(site, 0, bounces, &buffers));
        stages.push((Stage::Light, light.clone()));
        Ok(Run { dispatches, stages, lamps: None })
    }

    /// Gathers light (entry 0), or what surfaces receive in a bounce (1), after so many bounces.
    fn gather(&self, site: &Site, entry: usize, bounces: u32, buffers: &Buffers) -> Dispatch {
        let Buffers { seen, by, sent, light } = buffers;
        let this = bounces as usize % 2;
        let resources = [
            whole(&self.blue),
            whole(&self.directions),
            whole(&seen.source),
            whole(&by[0]),
            whole(&by[1]),
            whole(&sent[1 - this]),
            site.shared.step(),
            view(&site.textures.albedo),
            whole(if entry == 0 { light } else { &sent[this] }),
        ];
        let bound = site.bind(&self.rays, &resources);
        site.over_cells(&self.rays, entry, &bound, Some(bounces.min(1)))
    }
}

const GATHER: &[(&str, f64)] = &[
    ("SIDE", noise::SIDE as f64),
    ("SLICES", noise::FRAMES as f64),
    ("STEP_X", noise::R2[0] as f64),
    ("STEP_Y", noise::R2[1] as f64),
    ("GOLDEN", noise::GOLDEN as f64),
    ("GOLDEN_RATIO", GOLDEN_RATIO as f64),
    ("NEVER", NEVER as f64),
];
const MARCH_EDGE: &[(&str, f64)] =
    &[("OPAQUE", OPAQUE as f64), ("LONGEST", LONGEST as f64), ("MATTER", MATTER as f64)];
const MARCH_DISTANCE: &[(&str, f64)] = &[("NONE", NONE as f64), ("MARGIN", MARGIN as f64)];
