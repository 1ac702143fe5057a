//! The time of each stage of a frame on the GPU.

use crate::error::ReadBackError;
use crate::pipeline::Dispatch;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePassDescriptor,
    ComputePassTimestampWrites, Device, Features, MapMode, PollType,
    QUERY_RESOLVE_BUFFER_ALIGNMENT, QUERY_SIZE, QuerySet, QuerySetDescriptor, QueryType, Queue,
};

/// Stretches of a frame that are timed separately; the rest is timed as one.
const STRETCHES: u32 = 256;
const QUERIES: u32 = 2 * STRETCHES;
/// The label of the last stretch if there are more.
const REST: &str = "rest";

/// Frames whose times may be in flight at once. GPUs are two or three frames behind.
const FRAMES: usize = 4;

/// Times stages on the GPU, for [`crate::Lighting::record_timed`].
///
/// Reading never waits: it returns the times of the latest frame that the GPU has finished. Each stage gets a
/// compute pass of its own, since only passes can be timed. That separates stages which would otherwise
/// overlap, and makes the frame a little slower. Browsers round times to 0.1 ms.
#[derive(Debug)]
pub struct Timer {
    device: Device,
    queries: QuerySet,
    resolved: Buffer,
    /// Nanoseconds per tick.
    period: f64,
    frames: [TimedFrame; FRAMES],
    /// Frames timed so far.
    count: u64,
    times: Vec<(&'static str, Duration)>,
    /// The frame of `times`.
    latest: u64,
}

/// The ticks of one frame, in flight to the CPU.
#[derive(Debug)]
struct TimedFrame {
    ticks: Buffer,
    /// Labels of the stretches, in order.
    stretches: Vec<&'static str>,
    number: u64,
    /// Shared with the map callback. If the callback is gone and the frame is still in flight, its encoder was
    /// dropped.
    state: Arc<AtomicU8>,
}

const FREE: u8 = 0;
const IN_FLIGHT: u8 = 1;
const ARRIVED: u8 = 2;
/// Final: the device was lost.
const FAILED: u8 = 3;

impl Timer {
    /// Creates a timer. Returns `None` if the device was created without [`Features::TIMESTAMP_QUERY`]
    /// ([`crate::required_features`] requests it if the adapter has it).
    pub fn new(device: &Device, queue: &Queue) -> Option<Self> {
        if !device.features().contains(Features::TIMESTAMP_QUERY) {
            return None;
        }
        let bytes =
            u64::from(QUERIES * QUERY_SIZE).next_multiple_of(QUERY_RESOLVE_BUFFER_ALIGNMENT);
        let buffer = |usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some("timestamps"),
                size: bytes,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            device: device.clone(),
            queries: device.create_query_set(&QuerySetDescriptor {
                label: Some("timestamps"),
                ty: QueryType::Timestamp,
                count: QUERIES,
            }),
            resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            period: queue.get_timestamp_period().into(),
            frames: std::array::from_fn(|_| TimedFrame {
                ticks: buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ),
                stretches: Vec::new(),
                number: 0,
                state: Arc::default(),
            }),
            count: 0,
            times: Vec::new(),
            latest: 0,
        })
    }

    /// Returns the time of each stage of the latest finished frame, in the order in which they ran; empty before
    /// the first. Call after submitting to the queue or polling the device.
    pub fn read(&mut self) -> &[(&'static str, Duration)] {
        for frame in &mut self.frames {
            if frame.state.load(Ordering::Acquire) != ARRIVED {
                continue;
            }
            if frame.number > self.latest {
                self.latest = frame.number;
                frame.add_up(self.period, &mut self.times);
            }
            frame.ticks.unmap();
            frame.state.store(FREE, Ordering::Release);
        }
        &self.times
    }

    /// The number of the frame whose times were read last; 0 before the first.
    pub(crate) fn latest(&self) -> u64 {
        self.latest
    }

    /// Waits until all submitted work is done, and reads: for tests and files, not for a game's frame.
    pub fn wait(&mut self) -> Result<&[(&'static str, Duration)], ReadBackError> {
        let waited = self.device.poll(PollType::wait_indefinitely());
        waited.map_err(|e| ReadBackError::Failed(e.to_string()))?;
        Ok(self.read())
    }

    /// Records dispatches, one pass per stretch of the same label.
    pub(crate) fn record<'a>(
        &mut self,
        encoder: &mut CommandEncoder,
        dispatches: impl Iterator<Item = &'a Dispatch>,
    ) {
        let frame = self.frames.iter_mut().find_map(|frame| frame.is_free().then_some(frame));
        let mut stretches = Vec::new();
        let mut dispatches = dispatches.peekable();
        while let Some(first) = dispatches.peek() {
            let number = stretches.len() as u32;
            let rest = number + 1 == STRETCHES;
            let label = if rest { REST } else { first.pipeline.label };
            stretches.push(label);
            let writes = ComputePassTimestampWrites {
                query_set: &self.queries,
                beginning_of_pass_write_index: Some(2 * number),
                end_of_pass_write_index: Some(2 * number + 1),
            };
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
                label: Some(label),
                timestamp_writes: Some(writes),
            });
            while let Some(dispatch) =
                dispatches.next_if(|next| rest || next.pipeline.label == label)
            {
                dispatch.record(&mut pass);
            }
        }
        // All frames are in flight, since the CPU has not read for long: this one is not timed.
        let (Some(frame), false) = (frame, stretches.is_empty()) else { return };
        let queries = 2 * stretches.len() as u32;
        encoder.resolve_query_set(&self.queries, 0..queries, &self.resolved, 0);
        let bytes = u64::from(queries * QUERY_SIZE);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &frame.ticks, 0, bytes);
        self.count += 1;
        frame.number = self.count;
        frame.stretches = stretches;
        frame.state = Arc::new(IN_FLIGHT.into());
        let state = frame.state.clone();
        encoder.map_buffer_on_submit(&frame.ticks, MapMode::Read, 0..bytes, move |mapped| {
            state.store(if mapped.is_ok() { ARRIVED } else { FAILED }, Ordering::Release);
        });
    }
}

impl TimedFrame {
    /// Returns whether it is not in flight, or its encoder was dropped.
    fn is_free(&mut self) -> bool {
        // Read this first: the callback stores its result before it drops its reference.
        let alone = Arc::get_mut(&mut self.state).is_some();
        match self.state.load(Ordering::Acquire) {
            FREE => true,
            IN_FLIGHT => alone,
            _ => false,
        }
    }

    fn add_up(&self, period: f64, times: &mut Vec<(&'static str, Duration)>) {
        times.clear();
        let bytes = self.stretches.len() as u64 * 2 * u64::from(QUERY_SIZE);
        // A device that was lost in the meantime maps nothing: the frame then has no times.
        let Ok(mapped) = self.ticks.get_mapped_range(..bytes) else { return };
        let ticks: Vec<[u64; 2]> = bytemuck::pod_collect_to_vec(&mapped);
        for (&label, [begin, end]) in self.stretches.iter().zip(ticks) {
            // The clocks of some GPUs restart.
            let nanoseconds = end.saturating_sub(begin) as f64 * period;
            let time = Duration::from_nanos(nanoseconds as u64);
            match times.iter_mut().find(|(known, _)| *known == label) {
                Some((_, sum)) => *sum += time,
                None => times.push((label, time)),
            }
        }
    }
}
