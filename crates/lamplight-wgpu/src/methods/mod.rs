//! The methods: each with its pipelines, its buffers and its dispatches over a grid.

pub mod cascades;
pub mod flood;
pub mod holographic;
pub mod polar;
pub mod raymarch;

use crate::error::{Result, unsupported};
use crate::lamps::LampList;
use crate::planner::{FramePlanner, PassList};
use cascades::Cascades;
use flood::Flood;
use holographic::Holographic;
use holographic::paper::Paper;
use lamplight::settings::Variant;
use lamplight::{Lamp, Settings};
use polar::Polar;
use raymarch::Raymarch;
use wgpu::{Buffer, Device, Queue};

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
    /// Compiles the pipelines for these settings.
    pub fn new(
        device: &Device,
        queue: &Queue,
        settings: &Settings,
    ) -> Result<Self, lamplight::Error> {
        Ok(match settings.method {
            lamplight::Method::Cascades => {
                Self::Cascades(Box::new(Cascades::new(device, queue, settings)?))
            }
            lamplight::Method::Flood => {
                Self::Flood(Box::new(Flood::new(device, queue, &settings.flood)))
            }
            lamplight::Method::Holographic => match settings.holographic.variant {
                Variant::Paper => Self::Paper(Box::new(Paper::new(device, settings.bounces))),
                Variant::Beams => {
                    Self::Holographic(Box::new(Holographic::new(device, settings.bounces)))
                }
                other => return Err(unsupported("holographic.variant", other)),
            },
            lamplight::Method::Polar => Self::Polar(Box::new(Polar::new(device, &settings.polar)?)),
            lamplight::Method::Raymarch => {
                Self::Raymarch(Box::new(Raymarch::new(device, queue, settings)?))
            }
            other => return Err(unsupported("method", other)),
        })
    }

    /// Sets the lamps of a frame, if the method lights them by rule.
    pub fn set_lamps(
        &self,
        lamps: &[Lamp],
        size: [u32; 2],
        settings: &Settings,
        list: &mut LampList,
    ) -> Result<(), lamplight::Error> {
        match self {
            Self::Flood(_) => list.set(lamps, |lamp| flood::rays(lamp, size, &settings.flood)),
            Self::Polar(_) => list.set(lamps, |lamp| Ok(polar::rays(lamp, size, &settings.polar))),
            Self::Cascades(_) | Self::Holographic(_) | Self::Paper(_) | Self::Raymarch(_) => Ok(()),
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
