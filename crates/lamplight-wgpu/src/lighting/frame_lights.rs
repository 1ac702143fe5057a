//! The lights of the next frame, as the GPU takes them: lists and textures.

use super::prepared_frame::PreparedFrame;
use crate::cookies::CookieAtlas;
use crate::error::{PrepareError, Result};
use crate::error_scope::with_error_scope;
use crate::frame_input::{FrameInput, Lights};
use crate::grid_size::GridSize;
use crate::inflow::InflowTexture;
use crate::lamps::{Capacity, LampList};
use crate::methods::Method;
use crate::panorama::PanoramaTexture;
use crate::stages::direct::DirectLights;
use crate::stages::sight::SightList;
use lamplight::internals::sky::SunGlow;
use lamplight::{Inflow, Settings, Sky};
use wgpu::{Device, Queue, TextureView};

#[derive(Debug, Default)]
pub struct FrameLights {
    pub lamps: LampList,
    pub sun_glow: SunGlow,
    pub direct_lights: DirectLights,
    pub sights: SightList,
    /// The sky, if it is a panorama.
    pub panorama: Option<PanoramaTexture>,
    /// The light that enters in its place, if it differs from place to place.
    pub inflow: Option<InflowTexture>,
    pub cookies: CookieAtlas,
}

impl FrameLights {
    /// Takes the lights of the next frame, and makes room for them.
    pub fn set(
        &mut self,
        device: &Device,
        method: Option<&Method>,
        input: &FrameInput,
        size: GridSize,
        lights: Lights,
    ) -> Result<()> {
        let Lights { lamps, suns, sky, inflow } = lights;
        self.keep_panorama(device, if inflow.is_some() { &Sky::BLACK } else { sky })?;
        self.keep_inflow(device, inflow, input.settings)?;
        self.sights.set(input.sights)?;
        if let Some(method) = method {
            self.cookies.set(device, size, lamps)?;
            method.set_lamps(lamps, &self.cookies, size.into(), &mut self.lamps)?;
            self.direct_lights.set(input.settings, lamps, &self.cookies, suns, size.into())?;
        }
        self.lamps.more_follows = self.needed().has_direct();
        Ok(())
    }

    /// Keeps a texture for a sky that is a panorama.
    fn keep_panorama(&mut self, device: &Device, sky: &Sky) -> Result<()> {
        self.panorama = match (sky, self.panorama.take()) {
            (Sky::Panorama(panorama), Some(kept)) if kept.holds(panorama) => Some(kept),
            (Sky::Panorama(panorama), _) => {
                let create = || Ok(PanoramaTexture::new(device, panorama));
                Some(with_error_scope::<_, PrepareError>(device, create)?)
            }
            _ => None,
        };
        Ok(())
    }

    /// Keeps a texture for the inflow, as the method reads it.
    fn keep_inflow(
        &mut self,
        device: &Device,
        inflow: Option<&Inflow>,
        settings: &Settings,
    ) -> Result<()> {
        let holographic = settings.method.as_holographic();
        let spacing = holographic.map_or(1, |settings| settings.lattice_spacing);
        self.inflow = match (inflow, self.inflow.take()) {
            (Some(inflow), Some(kept)) if kept.holds(inflow, spacing) => Some(kept),
            (Some(inflow), _) => {
                Some(with_error_scope(device, || InflowTexture::new(device, inflow, spacing))?)
            }
            _ => None,
        };
        Ok(())
    }

    /// The panorama, or the inflow in its place.
    pub fn strips(&self) -> Option<&TextureView> {
        let panorama = self.panorama.as_ref().map(|panorama| &panorama.view);
        self.inflow.as_ref().map(|inflow| &inflow.view).or(panorama)
    }

    /// The capacity that the lights of the next frame need.
    pub fn needed(&self) -> Capacity {
        let Capacity { exact_lamps, suns, .. } = self.direct_lights.needed();
        Capacity { exact_lamps, suns, ..self.lamps.needed() }
    }

    /// Writes them to the buffers and textures of a prepared frame.
    pub fn write(&mut self, queue: &Queue, frame: &mut PreparedFrame, lights: Lights) {
        if let Some(panorama) = &mut self.panorama {
            panorama.write(queue, lights.sky);
        }
        if let (Some(texture), Some(inflow)) = (&mut self.inflow, lights.inflow) {
            texture.write(queue, inflow);
        }
        self.cookies.write(queue);
        if let Some(lamps) = &frame.passes.lamps {
            self.lamps.write(queue, lamps);
        }
        if let Some(buffers) = &frame.direct {
            self.direct_lights.write(queue, buffers);
        }
        if let Some(sight) = frame.sight.as_ref().filter(|_| frame.records_sight) {
            self.sights.write(queue, sight);
        }
        if let Some(cones) = &mut frame.passes.sky {
            cones.write(queue, lights.sky);
        }
    }
}
