//! The choice between GPU and CPU by the times of the first frames.
//!
//! Some frames of light are timed on the GPU. If it is quick, it stays. Otherwise a few frames are found on the CPU too,
//! while those of the GPU are still shown, and the faster one stays. Both find the same light, so nobody sees the change.

use crate::cpu_backend::{CAN_WAIT, CpuBackend};
use crate::options::Backend;
use crate::timing::Timer;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use wgpu::{Device, Queue};

/// Timed frames. The first are slow on both, while memory is new; with feedback the CPU's light settles meanwhile.
const FRAMES: usize = 6;
/// The GPU's light takes no longer than this, and the CPU is not tried: half of a frame at 60 Hz.
const QUICK: Duration = Duration::from_millis(8);
/// The CPU's time must be less than this fraction of the GPU's, since the host's own work waits for it.
const WORTHWHILE: f64 = 0.5;

/// The times of frames so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameTimes {
    gpu: Vec<Duration>,
    cpu: Vec<Duration>,
}

/// The next step of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialStep {
    /// A frame has to be timed on the GPU.
    TimeGpu,
    /// Likewise on the CPU.
    TimeCpu,
    /// The backend is chosen.
    Choose(Backend),
}

impl FrameTimes {
    /// Returns the next step.
    pub fn next(&self) -> TrialStep {
        let least = |times: &[Duration]| times.iter().min().copied().unwrap_or_default();
        let [gpu, cpu] = [least(&self.gpu), least(&self.cpu)];
        if self.gpu.len() < FRAMES {
            TrialStep::TimeGpu
        } else if gpu <= QUICK {
            TrialStep::Choose(Backend::Gpu)
        } else if self.cpu.len() < FRAMES {
            TrialStep::TimeCpu
        } else if cpu.as_secs_f64() < WORTHWHILE * gpu.as_secs_f64() {
            TrialStep::Choose(Backend::Cpu)
        } else {
            TrialStep::Choose(Backend::Gpu)
        }
    }
}

/// A trial that is not over.
#[derive(Debug)]
pub struct Trial {
    times: FrameTimes,
    /// Frames are recorded from a shared reference.
    timer: Mutex<Timer>,
    /// The number of the timed frame that was read last.
    read: u64,
    /// The CPU, which is ready if it is chosen.
    pub cpu: CpuBackend,
}

impl Trial {
    /// Begins a trial; none on a device without timestamps, where the GPU's light cannot be timed.
    pub fn new(device: &Device, queue: &Queue) -> Option<Self> {
        let timer = Mutex::new(Timer::new(device, queue)?);
        Some(Self { times: FrameTimes::default(), timer, read: 0, cpu: CpuBackend::new(CAN_WAIT) })
    }

    /// Reads the time of a frame that the GPU has finished since, and returns the next step.
    pub fn next(&mut self) -> TrialStep {
        let timer = self.timer.get_mut().unwrap_or_else(PoisonError::into_inner);
        let total = timer.read().iter().map(|(_, time)| *time).sum();
        if timer.latest() > self.read {
            self.read = timer.latest();
            self.times.gpu.push(total);
        }
        self.times.next()
    }

    /// Adds the time of a frame on the CPU.
    pub fn add_cpu(&mut self, time: Duration) {
        self.times.cpu.push(time);
    }

    /// The timer for a frame that is recorded, if it has to be timed.
    pub fn timer(&self) -> Option<&Mutex<Timer>> {
        (self.times.next() == TrialStep::TimeGpu).then_some(&self.timer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The steps of a trial in which a frame takes so many milliseconds, up to the choice.
    fn steps([gpu, cpu]: [u64; 2]) -> (usize, usize, Backend) {
        let mut times = FrameTimes::default();
        loop {
            // The first frame of each is slow.
            let time = |known: &[Duration], ms| {
                Duration::from_millis(if known.is_empty() { 10 * ms } else { ms })
            };
            match times.next() {
                TrialStep::TimeGpu => times.gpu.push(time(&times.gpu, gpu)),
                TrialStep::TimeCpu => times.cpu.push(time(&times.cpu, cpu)),
                TrialStep::Choose(backend) => return (times.gpu.len(), times.cpu.len(), backend),
            }
        }
    }

    #[test]
    fn a_quick_gpu_stays_and_the_cpu_is_not_tried() {
        assert_eq!(steps([8, 1]), (FRAMES, 0, Backend::Gpu));
        assert_eq!(steps([9, 1]), (FRAMES, FRAMES, Backend::Cpu), "a slow one stays untried");
    }

    #[test]
    fn the_cpu_has_to_be_much_faster() {
        assert_eq!(steps([40, 19]).2, Backend::Cpu);
        assert_eq!(steps([40, 20]).2, Backend::Gpu);
        assert_eq!(steps([40, 400]).2, Backend::Gpu);
    }
}
