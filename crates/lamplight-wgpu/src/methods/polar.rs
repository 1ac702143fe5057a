//! `polar`: a shadow map of rays for every lamp, from which every pixel is lit.
//!
//! All lamps are handled together: one dispatch traces their rays, one finds the bounds of every ray, one
//! lights all pixels. Only the shaders read the number of lamps, so that a frame with fewer lamps is recorded
//! as it was planned, for the full capacity.

use crate::compiler::Compiler;
use crate::error::{Result, unsupported};
use crate::lamps::{GROUP_RAYS, LampList, LampRays};
use crate::pass_list::PassList;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::stage::Stage;
use crate::stages::class::ClassPipeline;
use crate::stages::distance::DistancePipelines;
use crate::{programs, shaders};
use lamplight::Lamp;
use lamplight::internals::MAX_OPTICAL_DEPTH;
use lamplight::internals::distance::MARGIN;
use lamplight::internals::polar;
use lamplight::internals::polar::{APART, FINEST, NARROWEST, NEAREST, WIDEST};
use lamplight::settings::{Blend, Polar as Settings, ShadowFilter, Traversal};
use wgpu::Buffer;

/// Side of a tile, px.
const TILE: u32 = 16;
/// Capacity of the store for transmittance curves, in corners per ray. One stretch of a medium takes two. If
/// the store is full, pixels trace the missing curves again, which is slow but equally right.
const CORNERS: u64 = 4;

/// The pipelines.
#[derive(Debug)]
pub struct Polar {
    settings: Settings,
    class: ClassPipeline,
    /// The distance field, if rays go by it.
    distance: Option<DistancePipelines>,
    shadow_map: ComputePipelines,
    shadow_bounds: ComputePipelines,
    gather: ComputePipelines,
}

impl Polar {
    pub fn new(compiler: &Compiler, settings: &Settings, moment: bool) -> lamplight::Result<Self> {
        let shadow_filter = match settings.shadow_filter {
            ShadowFilter::Soft => 0.0,
            ShadowFilter::Linear => 1.0,
            ShadowFilter::Nearest => 2.0,
            other => return Err(unsupported("polar.shadow_filter", other)),
        };
        let traversal = match settings.traversal {
            Traversal::Edge => 0.0,
            Traversal::Step => 1.0,
            Traversal::Distance => 2.0,
            other => return Err(unsupported("polar.traversal", other)),
        };
        let blend = match settings.blend {
            Blend::Add => 0.0,
            Blend::Max => 1.0,
            Blend::Screen => 2.0,
            other => return Err(unsupported("polar.blend", other)),
        };
        let crisp = settings.shadow_filter == ShadowFilter::Nearest;
        let widths = [("NARROWEST", f64::from(NARROWEST)), ("WIDEST", f64::from(WIDEST))];
        let translucent = ("TRANSLUCENT", f64::from(settings.translucent));
        let rays = [
            translucent,
            ("MAX_OPTICAL_DEPTH", f64::from(MAX_OPTICAL_DEPTH)),
            ("TRAVERSAL", traversal),
            ("MARGIN", f64::from(MARGIN)),
            ("FINEST", f64::from(FINEST)),
            ("APART", f64::from(APART)),
        ];
        let bounds = [translucent, ("NEAREST", f64::from(NEAREST)), ("CRISP", f64::from(crisp))];
        let bounds = [&bounds[..], &widths].concat();
        let gather = [("SHADOW_FILTER", shadow_filter), ("BLEND", blend), shaders::moment(moment)];
        let gather = [&rays[..], &widths, &gather].concat();
        Ok(Self {
            settings: settings.clone(),
            class: ClassPipeline::new(compiler),
            distance: (settings.traversal == Traversal::Distance)
                .then(|| DistancePipelines::new(compiler)),
            shadow_map: compiler.program(&programs::POLAR_SHADOW_MAP, &rays),
            shadow_bounds: compiler.program(&programs::POLAR_SHADOW_BOUNDS, &bounds),
            gather: compiler.program(&programs::POLAR_GATHER, &gather),
        })
    }

    /// Returns the rays of a lamp.
    pub fn lamp_rays(&self, lamp: &Lamp, size: [u32; 2]) -> LampRays {
        let settings = &self.settings;
        let (reach, count) = polar::rays(lamp, size, settings);
        LampRays {
            reach,
            count: count as u32,
            soft: if settings.shadow_filter == ShadowFilter::Soft { lamp.size } else { 0.0 },
            falloff: Some(settings.falloff.unwrap_or(lamp.falloff)),
        }
    }

    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        let rays = planner.capacity.rays.max(GROUP_RAYS.into());
        let class = self.class.plan(planner)?;
        let lamps = planner.buffer_of_bytes("lamps", LampList::bytes(planner.capacity.lamps))?;
        let hits = planner.buffer::<[u32; 2]>("hits", rays)?;
        let curves = planner.buffer::<[u32; 2]>("transmittance curves", rays)?;
        let bounds = planner.buffer::<[u32; 4]>("bounds of rays", rays)?;
        let fit = planner.max_buffer_bytes() / size_of::<[f32; 4]>() as u64;
        let translucent = self.settings.translucent;
        let corners = if translucent { (rays * CORNERS).min(fit) } else { 1 };
        let corners = planner.buffer::<[f32; 4]>("corners of curves", corners)?;
        let (distance, mut dispatches, mut stages) = match &self.distance {
            Some(pipelines) => {
                let field = pipelines.plan(planner)?;
                (field.distance, field.passes.dispatches, field.passes.stages)
            }
            None => (planner.buffer::<f32>("no distance", 1)?, Vec::new(), Vec::new()),
        };
        let grid = [
            whole(&lamps),
            view(&planner.textures.tint_opacity),
            whole(&class.classes),
            whole(&distance),
        ];
        let store = [whole(&curves), whole(&corners), whole(&class.used)];
        let traced = [&grid[..], &[whole(&hits)], &store].concat();
        let traced = planner.bind(&self.shadow_map, &traced);
        let bounded = [whole(&lamps), whole(&hits), whole(&class.classes), whole(&bounds)];
        let bounded = planner.bind(&self.shadow_bounds, &bounded);
        let last = [whole(light), planner.masks(), planner.cookies()];
        let gathered = [&grid[..], &[whole(&bounds)], &store, &last].concat();
        let gathered = planner.bind(&self.gather, &gathered);
        let tiles = <[u32; 2]>::from(planner.size).map(|side| side.div_ceil(TILE));
        let groups = planner.groups(rays / u64::from(GROUP_RAYS));
        dispatches.extend([
            class.dispatch,
            Dispatch::new(self.shadow_map.entry(0), &traced, None, groups),
            Dispatch::new(self.shadow_bounds.entry(0), &bounded, None, groups),
            Dispatch::new(self.gather.entry(0), &gathered, None, [tiles[0], tiles[1], 1]),
        ]);
        dispatches.extend(planner.add_direct(light));
        stages.push((Stage::Light, light.clone()));
        Ok(PassList { lamps: Some(lamps), ..PassList::new(dispatches, stages) })
    }
}
