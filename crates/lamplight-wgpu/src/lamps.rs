//! The lamps of a frame, as shaders/shared/lamps.wgsl reads them.

use crate::cookies::{CookieAtlas, PlacedCookie};
use crate::error::{Result, unsupported};
use crate::gpu_struct::gpu_struct;
use lamplight::{Cone, Falloff};
use wgpu::{Buffer, Queue};

/// Bytes per ray in the largest buffer that stores something for each.
pub const RAY_BYTES: u64 = size_of::<[u32; 4]>() as u64;
/// Rays of a workgroup, all of one lamp.
pub const GROUP_RAYS: u32 = 64;
/// The cone of a lamp that shines, or of a viewer that looks, in all directions.
const NO_CONE: [f32; 3] = [0.0, -1.0, 0.0];

gpu_struct! {
    /// `Lamp` of shaders/shared/lamps.wgsl, where the fields are explained.
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
        mask: u32,
        number: u32,
        profile_count: u32,
        height: f32,
        cookie_axis: [f32; 2],
        cookie_size: u32,
        cookie_first: u32,
        profile: [[f32; 4]; 4],
    }
}

/// Returns a cone as shaders/shared/cone.wgsl reads it.
pub fn cone_of(cone: Option<Cone>) -> [f32; 3] {
    cone.map_or(NO_CONE, |cone| {
        let half = 0.5 * cone.angle;
        [cone.direction, half, cone.softness * half]
    })
}

/// The rays by which a method lights a lamp.
#[derive(Clone, Copy, Debug)]
pub struct LampRays {
    /// Length of the rays, px.
    pub reach: f32,
    /// Number of rays.
    pub count: u32,
    /// Radius of the lamp that softens edges, px.
    pub soft: f32,
    /// Falloff; `None`: the rule of the source of `flood`.
    pub falloff: Option<Falloff>,
}

/// Numbers of lights and rays that buffers can hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacity {
    /// Lamps that the method lights by its own rule.
    pub lamps: u64,
    /// Rays of all these lamps, each lamp padded to whole workgroups.
    pub rays: u64,
    /// Lamps with exact direct light below the light of a method.
    pub exact_lamps: u64,
    pub suns: u64,
}

impl Capacity {
    /// Returns whether it suffices for another.
    pub fn holds(&self, other: Self) -> bool {
        self.lamps >= other.lamps
            && self.rays >= other.rays
            && self.exact_lamps >= other.exact_lamps
            && self.suns >= other.suns
    }

    /// Returns whether there is room for direct light beside that of the method.
    pub fn has_direct(&self) -> bool {
        self.exact_lamps > 0 || self.suns > 0
    }

    /// Grows to what is needed, by at least half if the device allows it: lamps that are added one by one do
    /// not reallocate buffers one by one.
    pub fn grown(&self, needed: Self, most: Self) -> Self {
        let grown = |present: u64, needed: u64, most: u64| {
            if needed <= present {
                return present;
            }
            (present + present / 2).min(most).max(needed)
        };
        Self {
            lamps: grown(self.lamps, needed.lamps, most.lamps),
            rays: grown(self.rays, needed.rays, most.rays),
            exact_lamps: grown(self.exact_lamps, needed.exact_lamps, most.exact_lamps),
            suns: grown(self.suns, needed.suns, most.suns),
        }
    }
}

/// The lamps of a frame before they are written to the GPU.
#[derive(Debug, Default)]
pub struct LampList {
    lamps: Vec<Lamp>,
    needed: Capacity,
    /// True if other direct light is added to that of these lamps.
    pub more_follows: bool,
}

/// Bytes before the lamps: their number, the number of rays, and whether more light follows.
const HEAD: u64 = size_of::<[u32; 4]>() as u64;

impl LampList {
    /// Removes all lamps.
    pub fn clear(&mut self) {
        self.lamps.clear();
        self.needed = Capacity::default();
    }

    /// Replaces the lamps, each lit by the rays that `rays` returns; their cookies have places already.
    pub fn set<'a>(
        &mut self,
        lamps: impl IntoIterator<Item = &'a lamplight::Lamp>,
        cookies: &CookieAtlas,
        rays: impl Fn(&lamplight::Lamp) -> Result<LampRays, lamplight::Error>,
    ) -> Result<(), lamplight::Error> {
        self.clear();
        for lamp in lamps {
            let LampRays { reach, count, soft, falloff } = rays(lamp)?;
            let per_radian = count as f32 / std::f32::consts::TAU;
            let profile = lamp.cone.as_ref().and_then(|cone| cone.profile.as_ref());
            let profile = profile.map_or(&[][..], |profile| profile.values());
            let PlacedCookie { axis: cookie_axis, size: cookie_size, first: cookie_first } =
                cookies.placed(lamp.cookie.as_ref());
            self.lamps.push(Lamp {
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
                    Some(other) => return Err(unsupported("falloff", other)),
                },
                // Truncated only if there are too many rays for any buffer.
                first: self.needed.rays as u32,
                count,
                per_radian,
                cone: cone_of(lamp.cone),
                spread: soft * per_radian,
                mask: lamp.mask.into(),
                // Truncated only if there are too many lamps for any buffer.
                number: self.needed.lamps as u32,
                profile_count: profile.len() as u32,
                height: lamp.height.unwrap_or_default(),
                cookie_axis,
                cookie_size,
                cookie_first,
                profile: std::array::from_fn(|row| {
                    std::array::from_fn(|k| profile.get(4 * row + k).copied().unwrap_or_default())
                }),
            });
            self.needed.lamps += 1;
            self.needed.rays += u64::from(count.next_multiple_of(GROUP_RAYS));
        }
        Ok(())
    }

    /// The capacity that the lamps need.
    pub fn needed(&self) -> Capacity {
        self.needed
    }

    /// Bytes of a buffer for a number of lamps.
    pub fn bytes(lamps: u64) -> u64 {
        HEAD + lamps.max(1) * size_of::<Lamp>() as u64
    }

    /// The number of lamps that a buffer of `bytes` holds.
    pub fn max_lamps(bytes: u64) -> u64 {
        bytes.saturating_sub(HEAD) / size_of::<Lamp>() as u64
    }

    /// Writes the lamps to a buffer.
    pub fn write(&self, queue: &Queue, buffer: &Buffer) {
        let Capacity { lamps, rays, .. } = self.needed;
        let head = [lamps as u32, rays as u32, self.more_follows.into(), 0];
        queue.write_buffer(buffer, 0, bytemuck::bytes_of(&head));
        queue.write_buffer(buffer, HEAD, bytemuck::cast_slice(&self.lamps));
    }
}
