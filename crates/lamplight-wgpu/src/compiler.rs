//! Programs that are shared by all that ask for them, so that each is compiled once.

use crate::pipeline::ComputePipelines;
use crate::programs::Program;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::Device;

/// The number of programs above which those that nobody else holds are dropped: a few methods with all variants.
const CAPACITY: usize = 128;

/// The host's device, and the programs that were last asked for.
#[derive(Debug)]
pub struct Compiler {
    pub device: Device,
    /// The latest at the end.
    known: Arc<Mutex<Vec<ComputePipelines>>>,
    /// Programs asked for, if they are listed.
    asked: Option<Mutex<Vec<ComputePipelines>>>,
    waits: Arc<AtomicUsize>,
}

impl Compiler {
    pub fn new(device: &Device) -> Self {
        let (device, known, waits) = (device.clone(), Arc::default(), Arc::default());
        Self { device, known, asked: None, waits }
    }

    /// A compiler with the same programs.
    pub fn share(&self) -> Self {
        let Self { device, known, waits, .. } = self;
        let (device, known, waits) = (device.clone(), known.clone(), waits.clone());
        Self { device, known, asked: None, waits }
    }

    /// Returns a program with constants, the values of the shader's overrides: one that has been asked for before, or a new
    /// one.
    pub fn program(&self, program: &Program, constants: &[(&str, f64)]) -> ComputePipelines {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.iter().position(|known| known.is(program, constants));
        let found = match found {
            Some(found) => known.remove(found),
            None => ComputePipelines::uncompiled(&self.device, program, constants, &self.waits),
        };
        while known.len() >= CAPACITY
            && let Some(unused) = known.iter().position(ComputePipelines::is_unshared)
        {
            known.remove(unused);
        }
        known.push(found.clone());
        if let Some(asked) = &self.asked {
            asked.lock().unwrap_or_else(PoisonError::into_inner).push(found.clone());
        }
        found
    }

    /// Returns the programs that a function asks for.
    pub fn programs_of<T, E>(
        &self,
        make: impl FnOnce(&Self) -> Result<T, E>,
    ) -> Result<(T, Vec<ComputePipelines>), E> {
        let listing = Self { asked: Some(Mutex::default()), ..self.share() };
        let made = make(&listing)?;
        let asked = listing.asked.unwrap_or_default().into_inner();
        Ok((made, asked.unwrap_or_else(PoisonError::into_inner)))
    }

    /// Forgets what is compiled, as some of it may be invalid.
    pub fn forget(&self) {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.iter().for_each(ComputePipelines::forget);
    }

    /// The number of pipelines compiled so far when they were first used.
    pub fn waits(&self) -> usize {
        self.waits.load(Ordering::Relaxed)
    }
}
