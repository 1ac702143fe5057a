//! The methods: each with its pipelines, its buffers and what it runs over a grid.

pub mod raymarch;

use crate::lighting::check;
use crate::site::{Run, Site};
use crate::{Error, Result};
use lamplight::Settings;
use raymarch::Raymarch;
use wgpu::{Buffer, Device, Queue};

/// The method that settings ask for, compiled.
#[derive(Debug)]
pub enum Method {
    Raymarch(Raymarch),
}

impl Method {
    /// Compiles what these settings need.
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Result<Self> {
        check(settings)?;
        match settings.method {
            lamplight::Method::Raymarch => {
                Ok(Self::Raymarch(Raymarch::new(device, queue, settings)))
            }
            other => Err(Error::NotYet { what: format!("the method {}", other.name()) }),
        }
    }

    /// What turns matter into light.
    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Run> {
        match self {
            Self::Raymarch(raymarch) => raymarch.plan(site, light),
        }
    }
}
