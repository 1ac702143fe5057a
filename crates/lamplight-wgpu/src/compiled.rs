//! Methods that are compiled: those of the settings used last are kept, so that going back to them, or on
//! to some that were announced, takes no time.

use crate::Result;
use crate::guarded::guarded;
use crate::methods::Method;
use lamplight::Settings;
use std::sync::Arc;
use wgpu::{Device, Queue};

/// Methods that are kept. A slider that is drawn leaves one at every stop.
const MOST: usize = 16;

/// The methods used last, the last at the end.
#[derive(Debug, Default)]
pub struct Compiled(Vec<(Settings, Arc<Method>)>);

impl Compiled {
    /// The method of these settings, which have been checked.
    pub fn method(
        &mut self,
        device: &Device,
        queue: &Queue,
        settings: &Settings,
    ) -> Result<Arc<Method>> {
        let key = key(settings);
        let known = self.0.iter().position(|(known, _)| *known == key);
        let method = match known {
            Some(known) => self.0.remove(known).1,
            None => Arc::new(guarded(device, || Ok(Method::new(device, queue, settings)))?),
        };
        if self.0.len() == MOST {
            self.0.remove(0);
        }
        self.0.push((key, method.clone()));
        Ok(method)
    }
}

/// Whether settings share what is compiled.
pub fn alike(a: &Settings, b: &Settings) -> bool {
    key(a) == key(b)
}

/// Settings without those that pipelines do not know.
fn key(settings: &Settings) -> Settings {
    Settings { seed: 0, wall_depth: 0.0, ..settings.clone() }
}
