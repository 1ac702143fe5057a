//! Rays from every pixel: the GPU's `methods/raymarch` of the library.

mod bounce;

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::lighting::Stage;
use crate::shaders;
use crate::shared::filled;
use crate::site::{FOUR, ONE, Run, Site, view, whole};
use crate::stages::changes::Changes;
use crate::stages::clearance::Clearance;
use crate::stages::denoise::Denoise;
use crate::stages::fields::Fields;
use crate::stages::optics::{Optics, Seen};
use crate::stages::packet::PACKET;
use crate::stages::temporal::Temporal;
use bounce::Bounce;
use lamplight::methods::raymarch::{GOLDEN_RATIO, NEVER, SECTOR, directions};
use lamplight::settings::Hit;
use lamplight::stages::distance::MARGIN;
use lamplight::stages::seed::NONE;
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
    bounce: Bounce,
    changes: Option<Changes>,
    temporal: Option<Temporal>,
    denoise: Option<Denoise>,
    /// Whether anybody reads how noisy the light is, or where it is news.
    traced: bool,
}

/// What rays go by.
#[derive(Debug)]
enum By {
    Squares(Clearance),
    Distance(Fields),
}

/// The buffers that gathers read and write.
struct Buffers {
    seen: Seen,
    by: [Buffer; 2],
    /// Variance of the light and whether it is news; next to nothing where nobody reads them.
    traced: Buffer,
}

/// What a gather makes.
#[derive(Clone, Copy)]
enum Gather {
    /// The light of every cell.
    Light = 0,
    /// What surfaces send on in a bounce.
    Sent = 1,
}

impl Raymarch {
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        let ways: Vec<[f32; 2]> = directions(&settings.raymarch).collect();
        let storage = |label, bytes| filled(device, queue, label, BufferUsages::STORAGE, bytes);
        let accumulates = settings.temporal.frames > 1;
        let (tracks, varies) = (Temporal::tracks(settings), settings.denoise.passes > 0);
        let traced = tracks || varies;
        let stops = [("STOPS", f64::from(tracks || settings.raymarch.attenuation))];
        let (shader, march, by) = match settings.raymarch.hit {
            Hit::Edge => {
                let march = [PACKET, &[("ENDS", 0.0)], &stops].concat();
                (&shaders::RAYMARCH, march, By::Squares(Clearance::new(device)))
            }
            Hit::Distance => {
                let march = MARCH_DISTANCE.to_vec();
                (&shaders::RAYMARCH_DISTANCE, march, By::Distance(Fields::new(device)))
            }
        };
        let asked = [
            ("TRACKS", f64::from(tracks)),
            ("VARIES", f64::from(varies)),
            ("TRACED", f64::from(traced)),
        ];
        let constants = [GATHER, &march, &shaders::LUMINANCE, &asked].concat();
        let slots = [Uniform, Read, Read, Read, Read, Read, Read, Step, Texture, Write, Write];
        let rejects = accumulates && settings.temporal.reject;
        let bounce = Bounce::new(device, settings);
        Self {
            optics: Optics::new(device, bounce.keeps_fog_apart()),
            by,
            rays: Kernels::new(device, shader, &["main", "receive"], &slots, &constants),
            blue: storage("blue noise", noise::blue()),
            directions: storage("directions", bytemuck::cast_slice(&ways)),
            bounce,
            changes: rejects.then(|| Changes::new(device)),
            temporal: accumulates.then(|| Temporal::new(device, settings, traced)),
            denoise: varies.then(|| Denoise::new(device, settings)),
            traced,
        }
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        let seen = self.optics.buffers(site)?;
        let sent = self.bounce.buffers(site)?;
        let mut dispatches = vec![self.optics.read(site, &seen, &sent[0])];
        let mut changed = None;
        if let Some(changes) = &self.changes {
            let (any, found) = changes.plan(site, &seen)?;
            dispatches.extend(found);
            changed = Some(any);
        }
        // Fog that sends other light on is other matter, to squares.
        let (by, find, again, mut stages) = match &self.by {
            By::Squares(clearance) => {
                let (squares, find) = clearance.plan(site, &seen)?;
                let stages = vec![(Stage::Clearance, squares.clone())];
                ([seen.logs.clone(), squares], find, true, stages)
            }
            By::Distance(fields) => {
                let measured = fields.plan(site)?;
                let Run { dispatches, stages, .. } = measured.run;
                ([measured.nearest, measured.distance], dispatches, false, stages)
            }
        };
        let cells = if self.traced { site.cells() } else { 1 };
        let buffers = Buffers { seen, by, traced: site.buffer("traced", cells * 2 * ONE)? };
        dispatches.extend_from_slice(&find);
        let again = again && !self.bounce.keeps_fog_apart();
        let find = if again { find } else { Vec::new() };
        let (bounces, sent) = self.bounce(site, &buffers, &sent, &find)?;
        dispatches.extend(bounces);
        let step = site.settings.bounces.limit().min(1);
        dispatches.push(self.gather(site, Gather::Light, &buffers, step, [&sent, light]));

        let Buffers { by: [_, near], traced, .. } = &buffers;
        if let Some(temporal) = &self.temporal {
            dispatches.extend(temporal.plan(site, light, traced, changed.as_ref())?);
        }
        if let Some(denoise) = &self.denoise {
            dispatches.extend(denoise.plan(site, near, traced, light)?);
        }
        stages.push((Stage::Light, light.clone()));
        Ok(Run { dispatches, stages, lamps: None })
    }

    /// A gather from what surfaces send, which counts from step 1 on, into light or what they send
    /// next.
    fn gather(
        &self,
        site: &Site,
        gather: Gather,
        buffers: &Buffers,
        step: u32,
        [from, to]: [&Buffer; 2],
    ) -> Dispatch {
        let Buffers { seen, by, traced } = buffers;
        let resources = [
            whole(&self.blue),
            whole(&self.directions),
            whole(&seen.source),
            whole(&by[0]),
            whole(&by[1]),
            whole(from),
            site.shared.step(),
            view(&site.textures.albedo),
            whole(to),
            whole(traced),
        ];
        let bound = site.bind(&self.rays, &resources);
        site.over_cells(&self.rays, gather as usize, &bound, Some(step))
    }
}

const GATHER: &[(&str, f64)] = &[
    ("SIDE", noise::SIDE as f64),
    ("SLICES", noise::FRAMES as f64),
    ("STEP_X", noise::R2[0] as f64),
    ("STEP_Y", noise::R2[1] as f64),
    ("GOLDEN", noise::GOLDEN as f64),
    ("GOLDEN_RATIO", GOLDEN_RATIO as f64),
    ("SECTOR", SECTOR as f64),
];
const MARCH_DISTANCE: &[(&str, f64)] =
    &[("NEVER", NEVER as f64), ("NONE", NONE as f64), ("MARGIN", MARGIN as f64)];
