//! Pipelines compiled in the background, before a frame needs them.
//!
//! A frame compiles what it uses. Afterwards a thread compiles what the next may use: the rest of the method's entry
//! points, and its programs after one change, to frames with or without inflow, to other bounces, or to the first moment
//! (which cells with normals need); then those of direct lamps and suns, of sight and of the distance field. Methods share
//! programs ([`crate::compiler`]), so that most changes at once find theirs too.

use crate::compiler::Compiler;
use crate::methods::Method;
use crate::pipeline::ComputePipelines;
use crate::pipeline_cache::share_pipelines;
use crate::stages::direct::Direct;
use crate::stages::distance::DistancePipelines;
use crate::stages::sight::SightPipelines;
use crate::stages::walls::{MomentWalls, Walls};
use lamplight::{Bounces, Settings};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, JoinHandle};
use wgpu::Queue;

/// The thread, and the method that it compiles programs for.
#[derive(Debug, Default)]
pub struct Ahead {
    /// The settings of the last frame, and whether it had inflow.
    last: Option<(Settings, bool)>,
    shared: Arc<AheadShared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct AheadShared {
    job: Mutex<Job>,
    /// True if the thread has to stop, or to look for another job.
    interrupted: AtomicBool,
}

/// The next work of the thread.
#[derive(Debug, Default)]
struct Job {
    next: Option<(Settings, bool)>,
    running: bool,
}

impl AheadShared {
    fn lock(&self) -> MutexGuard<'_, Job> {
        self.job.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Ahead {
    /// Begins to compile what frames may need after one with these settings, unless it was begun for the frame before.
    pub fn follow(
        &mut self,
        compiler: &Compiler,
        queue: &Queue,
        settings: &Settings,
        inflow: bool,
    ) {
        let same =
            |(last, with): &(Settings, bool)| *with == inflow && share_pipelines(last, settings);
        if self.last.as_ref().is_some_and(same) {
            return;
        }
        self.last = Some((settings.clone(), inflow));
        let mut job = self.shared.lock();
        job.next.clone_from(&self.last);
        self.shared.interrupted.store(true, Ordering::Relaxed);
        if !job.running {
            let (shared, compiler, queue) = (self.shared.clone(), compiler.share(), queue.clone());
            let work = move || shared.work(&compiler, &queue);
            // Without a thread, frames compile what they need.
            self.thread = Builder::new().name("lamplight pipelines".to_owned()).spawn(work).ok();
            job.running = self.thread.is_some();
        }
    }

    /// Waits until everything is compiled.
    pub fn wait(&mut self) {
        if let Some(thread) = self.thread.take() {
            // A panic of the thread's has been reported by then.
            let _ = thread.join();
        }
    }
}

impl Drop for Ahead {
    /// Waits for the pipeline that is being compiled, since drivers do not expect a process to end meanwhile.
    fn drop(&mut self) {
        self.shared.lock().next = None;
        self.shared.interrupted.store(true, Ordering::Relaxed);
        self.wait();
    }
}

impl AheadShared {
    /// Compiles for one job after another, until there is none.
    fn work(&self, compiler: &Compiler, queue: &Queue) {
        loop {
            let mut job = self.lock();
            self.interrupted.store(false, Ordering::Relaxed);
            let Some((settings, inflow)) = job.next.take() else {
                job.running = false;
                return;
            };
            drop(job);
            let programs = likely_programs(compiler, queue, &settings, inflow);
            let entries =
                programs.iter().flat_map(|p| (0..p.entries()).map(move |entry| (p, entry)));
            for (program, entry) in entries {
                // Errors appear where the pipeline is used.
                if self.interrupted.load(Ordering::Relaxed) || program.compile_ahead(entry).is_err()
                {
                    break;
                }
            }
        }
    }
}

/// The programs that frames may need after one with these settings, likely ones first.
fn likely_programs(
    compiler: &Compiler,
    queue: &Queue,
    settings: &Settings,
    inflow: bool,
) -> Vec<ComputePipelines> {
    let bounces = [Bounces::Count(1), Bounces::Converged, Bounces::Feedback];
    let bounces = bounces.map(|bounces| (Settings { bounces, ..settings.clone() }, inflow));
    let moment = Settings { moment: !settings.moment, ..settings.clone() };
    let [same, other] = [inflow, !inflow].map(|inflow| (settings.clone(), inflow));
    let all = [same, other].into_iter().chain(bounces).chain([(moment, inflow)]);
    let methods = all.filter(|(settings, inflow)| {
        settings.check().is_ok() && (!inflow || settings.method.takes_inflow().is_ok())
    });
    let asked = compiler.programs_of(|compiler| {
        for (settings, inflow) in methods {
            Method::new(compiler, queue, &settings, inflow)?;
            Direct::new(compiler, &settings);
            if settings.moment {
                MomentWalls::new(compiler);
            }
        }
        Walls::new(compiler);
        SightPipelines::new(compiler);
        DistancePipelines::new(compiler);
        Ok::<_, lamplight::Error>(())
    });
    asked.map(|(_, programs)| programs).unwrap_or_default()
}
