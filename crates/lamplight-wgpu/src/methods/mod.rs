//! The methods: each with its pipelines, its buffers and what it runs over a grid.

pub mod cascades;
pub mod flood;
pub mod holographic;
pub mod polar;
pub mod raymarch;

use crate::Result;
use crate::lamps::Lamps;
use crate::site::{Run, Site};
use cascades::Cascades;
use flood::Flood;
use holographic::Holographic;
use holographic::paper::Paper;
use lamplight::settings::Variant;
use lamplight::{Lamp, Settings};
use polar::Polar;
use raymarch::Raymarch;
use wgpu::{Buffer, Device, Queue};

/// The method that settings ask for, compiled.
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
    /// Compiles what these settings need.
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Self {
        match settings.method {
            lamplight::Method::Cascades => {
                Self::Cascades(Box::new(Cascades::new(device, queue, settings)))
            }
            lamplight::Method::Flood => {
                Self::Flood(Box::new(Flood::new(device, queue, &settings.flood)))
            }
            lamplight::Method::Holographic => match settings.holographic.variant {
                Variant::Paper => Self::Paper(Box::new(Paper::new(device, settings.bounces))),
                Variant::Beams => {
                    Self::Holographic(Box::new(Holographic::new(device, settings.bounces)))
                }
            },
            lamplight::Method::Polar => Self::Polar(Box::new(Polar::new(device, &settings.polar))),
            lamplight::Method::Raymarch => {
                Self::Raymarch(Box::new(Raymarch::new(device, queue, settings)))
            }
        }
    }

    /// Takes the lamps of a frame, where it lights them by rule.
    pub fn take(&self, lamps: &[Lamp], size: [u32; 2], settings: &Settings, list: &mut Lamps) {
        match self {
            Self::Flood(_) => list.take(lamps, |lamp| flood::fan(lamp, size, &settings.flood)),
            Self::Polar(_) => list.take(lamps, |lamp| polar::fan(lamp, size, &settings.polar)),
            Self::Cascades(_) | Self::Holographic(_) | Self::Paper(_) | Self::Raymarch(_) => (),
        }
    }

    /// What turns matter into light.
    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        match self {
            Self::Flood(flood) => flood.plan(site, light),
            Self::Holographic(holographic) => holographic.plan(site, light),
            Self::Paper(paper) => paper.plan(site, light),
            Self::Polar(polar) => polar.plan(site, light),
            Self::Raymarch(raymarch) => raymarch.plan(site, light),
            Self::Cascades(cascades) => cascades.plan(site, light),
        }
    }
}
