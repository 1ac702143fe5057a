//! The methods: each with its pipelines, its buffers and its dispatches over a grid.

pub mod cascades;
pub mod flood;
pub mod holographic;
pub mod polar;
pub mod raymarch;

use crate::compiler::Compiler;
use crate::cookies::CookieAtlas;
use crate::error::{Result, unsupported};
use crate::lamps::LampList;
use crate::pass_list::PassList;
use crate::planner::FramePlanner;
use cascades::Cascades;
use flood::Flood;
use holographic::Holographic;
use holographic::paper::Paper;
use lamplight::settings::{MethodSettings, Variant};
use lamplight::{Lamp, Settings};
use polar::Polar;
use raymarch::Raymarch;
use wgpu::{Buffer, Queue};

/// The compiled method of settings.
#[derive(Debug)]
pub enum Method {
    Cascades(Box<Cascades>),
    Flood(Box<Flood>),
    Holographic(Box<Holographic>),
    Paper(Box<Paper>),
    Polar(Box<Polar>),
    Raymarch(Box<Raymarch>),
}

impl Method {
    /// Compiles the pipelines for these settings, of a method that reads `inflow` for frames with some or for others.
    ///
    /// # Errors
    /// If the GPU does not have the method.
    pub fn new(
        compiler: &Compiler,
        queue: &Queue,
        settings: &Settings,
        inflow: bool,
    ) -> lamplight::Result<Self> {
        let (bounces, moment) = (settings.method.bounces(settings.bounces), settings.moment);
        Ok(match &settings.method {
            MethodSettings::Cascades(settings) => {
                let cascades = Cascades::new(compiler, queue, settings, bounces, moment, inflow)?;
                Self::Cascades(Box::new(cascades))
            }
            MethodSettings::Flood(settings) => {
                Self::Flood(Box::new(Flood::new(compiler, queue, settings, moment)))
            }
            MethodSettings::Holographic(settings) => match settings.variant {
                Variant::Paper => Self::Paper(Box::new(Paper::new(compiler, bounces, moment))),
                Variant::Bundles => {
                    let holographic = Holographic::new(compiler, settings, bounces, moment, inflow);
                    Self::Holographic(Box::new(holographic))
                }
                other => return Err(unsupported("holographic.variant", other)),
            },
            MethodSettings::Polar(settings) => {
                Self::Polar(Box::new(Polar::new(compiler, settings, moment)?))
            }
            MethodSettings::Raymarch(settings) => {
                let raymarch = Raymarch::new(compiler, queue, settings, bounces, moment, inflow)?;
                Self::Raymarch(Box::new(raymarch))
            }
            other => return Err(unsupported("method", other.method())),
        })
    }

    /// Sets the lamps of a frame, if the method lights them by rule.
    pub fn set_lamps(
        &self,
        lamps: &[Lamp],
        cookies: &CookieAtlas,
        size: [u32; 2],
        list: &mut LampList,
    ) -> lamplight::Result<()> {
        match self {
            Self::Flood(flood) => {
                let by_rule = |lamp: &&Lamp| !lamplight::Method::Flood.lights_exactly(lamp);
                list.set(lamps.iter().filter(by_rule), cookies, |lamp| flood.lamp_rays(lamp, size))
            }
            Self::Polar(polar) => {
                // Those that take light away take it from all others, however these blend.
                let some = |take: bool| lamps.iter().filter(move |lamp| lamp.takes_light() == take);
                list.set(some(false).chain(some(true)), cookies, |lamp| {
                    Ok(polar.lamp_rays(lamp, size))
                })
            }
            Self::Cascades(_) | Self::Holographic(_) | Self::Paper(_) | Self::Raymarch(_) => {
                list.clear();
                Ok(())
            }
        }
    }

    /// Plans the dispatches that turn matter into `light`.
    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Result<PassList> {
        match self {
            Self::Flood(flood) => flood.plan(planner, light),
            Self::Holographic(holographic) => holographic.plan(planner, light),
            Self::Paper(paper) => paper.plan(planner, light),
            Self::Polar(polar) => polar.plan(planner, light),
            Self::Raymarch(raymarch) => raymarch.plan(planner, light),
            Self::Cascades(cascades) => cascades.plan(planner, light),
        }
    }
}
