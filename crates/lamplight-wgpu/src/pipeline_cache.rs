//! A cache of methods. Switching back to recently used or precompiled settings does not compile again.

use crate::compiler::Compiler;
use crate::error::DeviceError;
use crate::error_scope::with_error_scope;
use crate::methods::Method;
use lamplight::Settings;
use std::sync::Arc;
use wgpu::Queue;

/// The number of cached methods. A slider that is dragged adds one at every stop.
const CAPACITY: usize = 16;

/// The methods used last, the latest at the end.
#[derive(Debug, Default)]
pub struct PipelineCache(Vec<(Key, Arc<Method>)>);

/// The settings that affect pipelines, and whether frames have inflow.
type Key = (Settings, bool);

impl PipelineCache {
    /// Returns the compiled method of settings, which have been checked. `inflow`: for frames with some.
    pub fn method<E: From<DeviceError> + From<lamplight::Error>>(
        &mut self,
        compiler: &Compiler,
        queue: &Queue,
        settings: &Settings,
        inflow: bool,
    ) -> Result<Arc<Method>, E> {
        let key = (key(settings), inflow);
        let known = self.0.iter().position(|(known, _)| *known == key);
        let method = match known {
            Some(known) => self.0.remove(known).1,
            None => {
                let compile = || Method::new(compiler, queue, settings, inflow).map_err(E::from);
                Arc::new(with_error_scope(&compiler.device, compile)?)
            }
        };
        if self.0.len() == CAPACITY {
            self.0.remove(0);
        }
        self.0.push((key, method.clone()));
        Ok(method)
    }
}

/// Returns whether settings share their pipelines.
pub fn share_pipelines(a: &Settings, b: &Settings) -> bool {
    key(a) == key(b)
}

/// Settings without those that do not affect pipelines.
fn key(settings: &Settings) -> Settings {
    Settings { seed: 0, wall_depth: 0.0, elevation: Settings::ELEVATION, ..settings.clone() }
}
