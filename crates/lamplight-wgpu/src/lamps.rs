//! Lamps as shaders know them: `Lamps` of shaders/lamps.wgsl.

use bytemuck::{Pod, Zeroable};
use lamplight::Falloff;
#[cfg(test)]
use std::mem::offset_of;
use wgpu::{Buffer, Queue};

/// Bytes of a ray in the largest buffer that keeps something of each.
pub const RAY_BYTES: u64 = 16;
/// Rays of a workgroup, which are of one lamp.
pub const TOGETHER: u32 = 64;
/// Stands for a lamp that lights all round.
const NO_CONE: [f32; 3] = [0.0, -1.0, 0.0];

/// `Lamp` of shaders/lamps.wgsl, which says what the fields are.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Lamp {
    position: [f32; 2],
    reach: f32,
    range: f32,
    strength: [f32; 3],
    size: f32,
    falloff: u32,
    first: u32,
    count: u32,
    per_radian: f32,
    cone: [f32; 3],
    spread: f32,
}

impl Lamp {
    /// Fields in order, with where they begin.
    #[cfg(test)]
    pub const OFFSETS: [(&'static str, usize); 11] = [
        ("position", offset_of!(Lamp, position)),
        ("reach", offset_of!(Lamp, reach)),
        ("range", offset_of!(Lamp, range)),
        ("strength", offset_of!(Lamp, strength)),
        ("size", offset_of!(Lamp, size)),
        ("falloff", offset_of!(Lamp, falloff)),
        ("first", offset_of!(Lamp, first)),
        ("count", offset_of!(Lamp, count)),
        ("per_radian", offset_of!(Lamp, per_radian)),
        ("cone", offset_of!(Lamp, cone)),
        ("spread", offset_of!(Lamp, spread)),
    ];
}

/// How a method lights a lamp.
#[derive(Clone, Copy, Debug)]
pub struct Fan {
    /// px that its rays go.
    pub reach: f32,
    /// Rays.
    pub count: u32,
    /// px of its size that soften edges.
    pub soft: f32,
    /// How it fades; the rule of the source of `flood` where it does not by its own.
    pub falloff: Option<Falloff>,
}

/// How many lamps and rays there is room for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Room {
    pub lamps: u64,
    /// Of all lamps, each filled up to whole workgroups.
    pub rays: u64,
}

impl Room {
    /// Whether there is as much room as another needs.
    pub fn holds(&self, other: Self) -> bool {
        self.lamps >= other.lamps && self.rays >= other.rays
    }

    /// Room for others, half as much again as there was where that was too little and the device
    /// allows it: lamps that come one by one do not make buffers anew one by one.
    pub fn grown(&self, need: Self, most: Self) -> Self {
        let grown = |had: u64, need: u64, most: u64| match need <= had {
            true => had,
            false => (had + had / 2).min(most).max(need),
        };
        Self {
            lamps: grown(self.lamps, need.lamps, most.lamps),
            rays: grown(self.rays, need.rays, most.rays),
        }
    }
}

/// The lamps of a frame on their way to the GPU.
#[derive(Debug, Default)]
pub struct Lamps {
    list: Vec<Lamp>,
    need: Room,
}

/// Bytes before the list: how many lamps, and how many rays.
const HEAD: u64 = 16;

impl Lamps {
    /// Takes the lamps of a frame, each lit as `fan` says.
    pub fn take(&mut self, lamps: &[lamplight::Lamp], fan: impl Fn(&lamplight::Lamp) -> Fan) {
        self.list.clear();
        self.need = Room::default();
        for lamp in lamps {
            let Fan { reach, count, soft, falloff } = fan(lamp);
            let per_radian = count as f32 / std::f32::consts::TAU;
            let half = |angle: f32| 0.5 * angle;
            self.list.push(Lamp {
                position: lamp.position,
                reach,
                range: lamp.range,
                strength: lamp.color.map(|c| c * lamp.intensity),
                size: lamp.size,
                falloff: match falloff {
                    Some(Falloff::Linear) => 0,
                    Some(Falloff::Smooth) => 1,
                    Some(Falloff::Inverse) => 2,
                    None => 3,
                },
                // Cut off only where there are too many rays for any buffer.
                first: self.need.rays as u32,
                count,
                per_radian,
                cone: lamp.cone.map_or(NO_CONE, |cone| {
                    [cone.direction, half(cone.angle), cone.softness * half(cone.angle)]
                }),
                spread: soft * per_radian,
            });
            self.need.lamps += 1;
            self.need.rays += u64::from(count.next_multiple_of(TOGETHER));
        }
    }

    /// What they need.
    pub fn need(&self) -> Room {
        self.need
    }

    /// Bytes of a buffer that holds so many.
    pub fn bytes(lamps: u64) -> u64 {
        HEAD + lamps.max(1) * size_of::<Lamp>() as u64
    }

    /// How many a buffer of so many bytes holds.
    pub fn most(bytes: u64) -> u64 {
        bytes.saturating_sub(HEAD) / size_of::<Lamp>() as u64
    }

    /// Hands them over.
    pub fn write(&self, queue: &Queue, buffer: &Buffer) {
        let head = [self.need.lamps as u32, self.need.rays as u32, 0, 0];
        queue.write_buffer(buffer, 0, bytemuck::bytes_of(&head));
        queue.write_buffer(buffer, HEAD, bytemuck::cast_slice(&self.list));
    }
}
