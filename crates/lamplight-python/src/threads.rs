//! Threads that compute: a pool that all share, or one of a solver's own.

use crate::json::value_error;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

/// Most threads that may be asked for, as in the command.
const MOST: i128 = 1024;

/// A pool, made when it is first needed, and left to others in the end.
pub struct Threads {
    /// None: a thread per core.
    count: Option<usize>,
    /// The pool, and the process that it belongs to: a child made by a fork has none of its parent's threads, and
    /// would wait for them forever.
    pool: Mutex<Option<(u32, Arc<ThreadPool>)>>,
}

/// Pools that were left, and their processes. A worker of Dask has another solver for every task: threads of its own
/// would begin and end with each, and every new one fetches memory anew that those before still hold.
static LEFT: Mutex<Vec<(u32, Arc<ThreadPool>)>> = Mutex::new(Vec::new());
/// The largest number of pools that are kept there.
const MOST_LEFT: usize = 16;

impl Drop for Threads {
    fn drop(&mut self) {
        let pool = self.pool.get_mut().unwrap_or_else(PoisonError::into_inner).take();
        let mut left = LEFT.lock().unwrap_or_else(PoisonError::into_inner);
        match pool {
            Some((owner, pool)) if owner == std::process::id() && left.len() < MOST_LEFT => {
                left.push((owner, pool));
            }
            // The parent's threads are not here to be ended.
            Some((owner, pool)) if owner != std::process::id() => std::mem::forget(pool),
            _ => {}
        }
    }
}

/// Takes a pool of so many threads that was left in this process.
fn left(process: u32, count: usize) -> Option<Arc<ThreadPool>> {
    let mut left = LEFT.lock().unwrap_or_else(PoisonError::into_inner);
    let fits = |(owner, pool): &(u32, Arc<ThreadPool>)| {
        *owner == process && pool.current_num_threads() == count
    };
    let at = left.iter().position(fits)?;
    Some(left.swap_remove(at).1)
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
        let made = match self.count.and_then(|count| left(process, count)) {
            Some(pool) => pool,
            None => {
                let made = ThreadPoolBuilder::new().num_threads(self.count.unwrap_or(0)).build();
                Arc::new(made.map_err(value_error)?)
            }
        };
        // The parent's threads are not here to be ended.
        std::mem::forget(pool.replace((process, made.clone())));
        Ok(made)
    }
}
