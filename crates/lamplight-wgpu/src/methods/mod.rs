//! The methods: each with its pipelines, its buffers and what it runs over a grid.

pub mod holographic;
pub mod raymarch;

use crate::lighting::check;
use crate::site::{Run, Site};
use crate::{Error, Result};
use holographic::Holographic;
use lamplight::Settings;
use raymarch::Raymarch;
use wgpu::{Buffer, Device, Queue};

/// The method that settings ask for, compiled.
#[derive(Debug)]
pub enum Method {
    Holographic(Box<Holographic>),
    Raymarch(Box<Raymarch>),
}

impl Method {
    /// Compiles what these settings need.
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Result<Self> {
        check(settings)?;
        match settings.method {
            lamplight::Method::Holographic => {
                Ok(Self::Holographic(Box::new(Holographic::new(device))))
            }
            lamplight::Method::Raymarch => {
                Ok(Self::Raymarch(Box::new(Raymarch::new(device, queue, settings))))
            }
            other => Err(Error::NotYet { what: format!("the method {}", other.name()) }),
        }
    }

    /// What turns matter into light.
    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        match self {
            Self::Holographic(holographic) => holographic.plan(site, light),
            Self::Raymarch(raymarch) => raymarch.plan(site, light),
        }
    }
}
