//! Brushes, and the tools that apply them.

use crate::paint::{Paint, mix};
use lamplight::{Normal, Rgb};

/// The surface behind open space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Backdrop {
    pub color: Rgb,
    pub normal: Normal,
}

impl Backdrop {
    /// Matter through which it is seen, in a mixture of both colours.
    fn behind(self, paint: Paint, color: Rgb) -> Paint {
        Paint { color, normal: self.normal, ..paint }
    }
}

/// Matter to paint. Values out of range are clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stuff {
    /// A wall of a linear colour.
    Wall(Rgb),
    /// Clear glass with a tint per px.
    Glass(Rgb),
    /// Fog: the fraction of light lost per px, and its colour.
    Fog(f32, Rgb),
    /// A solid that emits this radiance, 0 to [`Stuff::MAX_RADIANCE`].
    Glow(Rgb),
    /// The colour behind open space. Matter and normals do not change.
    Backdrop(Rgb),
    /// Open space.
    Erase,
}

impl Stuff {
    /// The largest radiance that can be painted.
    pub const MAX_RADIANCE: f32 = 1000.0;

    /// The paint in front of a backdrop; `None` if only the backdrop changes.
    pub(super) fn paint(self, backdrop: Backdrop) -> Option<Paint> {
        let Backdrop { color: behind, .. } = backdrop;
        Some(match self {
            Self::Wall(color) => Paint::wall(unit(color)),
            Self::Glass(tint) => {
                let tint = unit(tint);
                let color = std::array::from_fn(|c| tint[c] * behind[c]);
                backdrop.behind(Paint::glass(tint), color)
            }
            Self::Fog(opacity, color) => {
                // An opacity of 1 would be a wall.
                let fog = Paint::fog(within(opacity, 0.99), unit(color));
                backdrop.behind(fog, mix(behind, unit(color), 0.5))
            }
            Self::Glow(radiance) => Paint::glow(radiance.map(|v| within(v, Self::MAX_RADIANCE))),
            Self::Backdrop(_) => return None,
            Self::Erase => backdrop.behind(Paint::open(behind), behind),
        })
    }
}

/// Clamps a value to 0 to `max`; NaN becomes 0.
fn within(value: f32, max: f32) -> f32 {
    if value > 0.0 { value.min(max) } else { 0.0 }
}

pub(super) fn unit(rgb: Rgb) -> Rgb {
    rgb.map(|v| within(v, 1.0))
}

/// A brush: matter and a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brush {
    /// The matter that it paints.
    pub stuff: Stuff,
    /// Its radius, px: 0.5 is one cell, and at most [`Brush::MAX_RADIUS`].
    pub radius: f32,
}

impl Brush {
    /// The largest radius, px.
    pub const MAX_RADIUS: f32 = 256.0;

    pub(super) fn reach(&self) -> f32 {
        if self.radius > 0.5 { self.radius.min(Self::MAX_RADIUS) } else { 0.5 }
    }
}

/// A tool: the shape that a drag of the pointer paints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tool {
    /// The path of the pointer.
    Free,
    /// A straight line from the start of the drag.
    Line,
    /// A rectangle from the start of the drag, filled or as an outline as thick as the brush.
    Rectangle {
        /// True if it is filled.
        filled: bool,
    },
    /// The connected cells of the same matter at the start of the drag.
    Fill,
}

/// The largest coordinate of a pointer, px, far outside of any canvas.
const FAR: f32 = 65_536.0;

/// Clamps a point; `None` if it is not finite.
pub(super) fn point(at: [f32; 2]) -> Option<[f32; 2]> {
    let good = at.iter().all(|v| v.is_finite());
    good.then(|| at.map(|v| v.clamp(-FAR, FAR)))
}

/// Visits the cells within `radius` px of the line between two points.
pub(super) fn capsule(
    size: [u32; 2],
    from: [f32; 2],
    to: [f32; 2],
    radius: f32,
    mut visit: impl FnMut(usize),
) {
    if radius < 1.0 {
        return thin(size, from, to, visit);
    }
    let along = [to[0] - from[0], to[1] - from[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let span = |i: usize| {
        let low = (from[i].min(to[i]) - radius).floor().max(0.0) as u32;
        let high = (from[i].max(to[i]) + radius).ceil().clamp(0.0, size[i] as f32) as u32;
        low..high
    };
    for y in span(1) {
        for x in span(0) {
            let p = [x as f32 + 0.5 - from[0], y as f32 + 0.5 - from[1]];
            let t = if squared > 0.0 {
                ((p[0] * along[0] + p[1] * along[1]) / squared).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let (dx, dy) = (p[0] - t * along[0], p[1] - t * along[1]);
            if dx * dx + dy * dy <= radius * radius + 1e-4 {
                visit((y * size[0] + x) as usize);
            }
        }
    }
}

/// Visits one cell per step along the longer axis, without gaps and duplicates.
fn thin(size: [u32; 2], from: [f32; 2], to: [f32; 2], mut visit: impl FnMut(usize)) {
    let (from, to) = (from.map(f32::floor), to.map(f32::floor));
    let along = [to[0] - from[0], to[1] - from[1]];
    let steps = along[0].abs().max(along[1].abs());
    for k in 0..=steps as u32 {
        let t = if steps > 0.0 { k as f32 / steps } else { 0.0 };
        let [x, y] = [0, 1].map(|i| (from[i] + along[i] * t).round());
        if (0.0..size[0] as f32).contains(&x) && (0.0..size[1] as f32).contains(&y) {
            visit((y as u32 * size[0] + x as u32) as usize);
        }
    }
}

/// Visits the cells of the rectangle between two points, filled or as an outline.
pub(super) fn rectangle(
    size: [u32; 2],
    from: [f32; 2],
    to: [f32; 2],
    outline: Option<f32>,
    mut visit: impl FnMut(usize),
) {
    let (low, high) =
        ([0, 1].map(|i| from[i].min(to[i]).floor()), [0, 1].map(|i| from[i].max(to[i]).floor()));
    let span = |i: usize| {
        low[i].clamp(0.0, size[i] as f32) as u32..(high[i] + 1.0).clamp(0.0, size[i] as f32) as u32
    };
    for y in span(1) {
        for x in span(0) {
            let at = [x as f32, y as f32];
            let deep = |i: usize| (at[i] - low[i]).min(high[i] - at[i]);
            if outline.is_none_or(|thick| deep(0).min(deep(1)) < thick) {
                visit((y * size[0] + x) as usize);
            }
        }
    }
}
