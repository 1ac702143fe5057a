//! Threads that compute: a pool that all share, or one of a solver's own.

use crate::json::value_error;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

/// Most threads that may be asked for, as in the command.
const MOST: i128 = 1024;

/// A pool, made when it is first needed.
pub struct Threads {
    /// None: a thread per core.
    count: Option<usize>,
    /// The pool, and the process that it belongs to: a child made by a fork has none of its parent's threads, and
    /// would wait for them forever.
    pool: Mutex<Option<(u32, Arc<ThreadPool>)>>,
}

/// A thread per core, for all that asks for no other number.
pub static SHARED: Threads = Threads { count: None, pool: Mutex::new(None) };

impl Threads {
    /// A pool of its own.
    pub fn new(count: i128) -> PyResult<Self> {
        if !(1..=MOST).contains(&count) {
            let expected = format!("1 to {MOST}");
            return Err(value_error(lamplight::Error::value("threads", count, expected)));
        }
        Ok(Self { count: Some(count as usize), pool: Mutex::new(None) })
    }

    /// The number that was asked for.
    pub fn count(&self) -> Option<usize> {
        self.count
    }

    /// Runs work on the threads, without the GIL.
    pub fn run<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        let pool = self.pool()?;
        Ok(py.detach(|| pool.install(work)))
    }

    /// The pool of this process.
    pub fn pool(&self) -> PyResult<Arc<ThreadPool>> {
        let process = std::process::id();
        let mut pool = self.pool.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((owner, pool)) = &*pool
            && *owner == process
        {
            return Ok(pool.clone());
        }
        let made = ThreadPoolBuilder::new().num_threads(self.count.unwrap_or(0)).build();
        let made = Arc::new(made.map_err(value_error)?);
        // The parent's threads are not here to be ended.
        std::mem::forget(pool.replace((process, made.clone())));
        Ok(made)
    }
}
