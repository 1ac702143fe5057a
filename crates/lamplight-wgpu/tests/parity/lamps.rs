//! Lamps to light cells with.

use crate::common::seeded;
use lamplight::{ALL_LAYERS, Cells, Cone, Cookie, CookiePixels, Direct, Falloff, Lamp, Profile};

/// Random lamps, in the grid and a little beyond, some with a cone.
pub fn lamps(width: u32, height: u32, count: u32, seed: u64) -> Vec<Lamp> {
    let mut random = seeded(seed);
    let falloffs = [Falloff::Linear, Falloff::Smooth, Falloff::Inverse];
    let lamp = |i| {
        let [x, y] = [width, height].map(|side| (1.2 * random.f32() - 0.1) * side as f32);
        let cone = Cone {
            direction: 6.0 * random.f32() - 3.0,
            angle: 0.2 + 4.0 * random.f32(),
            softness: [0.0, 0.5, 1.0][random.usize(..3)],
            profile: [None, Some(2), Some(5), Some(16)][random.usize(..4)].map(|count| {
                let values: Vec<f32> = (0..count).map(|_| random.f32()).collect();
                Profile::new(&values).unwrap()
            }),
        };
        Lamp {
            // Every third in the middle of a cell, every third on a corner: there rays meet ties.
            position: match i % 3 {
                0 => [x, y],
                1 => [x.floor() + 0.5, y.floor() + 0.5],
                _ => [x.floor(), y.floor()],
            },
            color: std::array::from_fn(|_| random.f32()),
            intensity: 3.0 * random.f32(),
            range: 1.0 + 90.0 * random.f32(),
            size: 0.05 + 4.0 * random.f32(),
            falloff: falloffs[random.usize(..3)],
            cone: (random.u32(..3) == 0).then_some(cone),
            cookie: None,
            height: None,
            direct: Direct::Glow,
            mask: ALL_LAYERS,
            solid: i % 2 == 1,
            visible: false,
        }
    };
    (0..count).map(lamp).collect()
}

/// Gives every lamp but the first a random cookie, the second and the third one picture.
pub fn with_cookies(cells: &mut Cells, seed: u64) {
    let mut random = seeded(seed);
    let mut picture = || {
        let [width, height] = [1, 2].map(|least| random.u32(least..12));
        let pixels: Vec<_> = (0..width * height)
            .map(|_| std::array::from_fn(|_| if random.bool() { 2.0 * random.f32() } else { 0.0 }))
            .collect();
        let cookie = Cookie::new(CookiePixels::new([width, height], &pixels).unwrap(), 1.0);
        Cookie { size: 8.0 + 60.0 * random.f32(), turn: 6.0 * random.f32() - 3.0, ..cookie }
    };
    for lamp in cells.lamps_mut().iter_mut().skip(1) {
        lamp.cookie = Some(picture());
    }
    if let [_, second, third, ..] = &mut cells.lamps_mut()[..] {
        let shared = second.cookie.as_ref().map(|cookie| cookie.picture.clone());
        third.cookie.iter_mut().zip(shared).for_each(|(cookie, shared)| cookie.picture = shared);
    }
}
