//! The scene that every contender lights: where lamps and occluders are.

use bevy::math::{Rect, Vec2};
use fastrand::Rng;

/// Pixels of the target, and world units that the camera sees: one a pixel, around the origin.
pub const VIEW: [u32; 2] = [640, 360];
/// The range of a lamp, world units.
pub const RANGE: f32 = 128.0;
/// Side of an occluder, world units.
pub const SIDE: f32 = 8.0;

/// Places by a fixed seed: with more lamps or occluders, those that were there stay.
pub struct Scene {
    pub lamps: Vec<Vec2>,
    pub occluders: Vec<Vec2>,
}

impl Scene {
    /// Occluders anywhere in the view; lamps where no occluder is, for in one most plugins would draw
    /// nothing.
    pub fn new(lamps: u32, occluders: u32) -> Self {
        let mut places = Places(Rng::with_seed(1));
        let occluders: Vec<_> = (0..occluders).map(|_| places.next()).collect();
        let solid = Solid::of(&occluders);
        let mut places = Places(Rng::with_seed(2));
        let mut free = || loop {
            let place = places.next();
            if !solid.at(place) {
                break place;
            }
        };
        Self { lamps: (0..lamps).map(|_| free()).collect(), occluders }
    }

    /// Share of the view that lies in occluders.
    pub fn solid(&self) -> f64 {
        let pixels = Solid::of(&self.occluders).0;
        pixels.iter().filter(|pixel| **pixel).count() as f64 / pixels.len() as f64
    }
}

/// Which pixels lie in occluders.
struct Solid(Vec<bool>);

impl Solid {
    fn of(occluders: &[Vec2]) -> Self {
        let [width, height] = VIEW;
        let mut pixels = vec![false; (width * height) as usize];
        for occluder in occluders {
            let covered = Rect::from_center_size(*occluder + half_view(), Vec2::splat(SIDE));
            let Rect { min, max } = covered.intersect(Rect::from_corners(Vec2::ZERO, view()));
            for y in min.y as u32..max.y.ceil() as u32 {
                for x in min.x as u32..max.x.ceil() as u32 {
                    pixels[(y * width + x) as usize] = true;
                }
            }
        }
        Self(pixels)
    }

    fn at(&self, place: Vec2) -> bool {
        let pixel = (place + half_view()).as_uvec2();
        self.0[(pixel.y * VIEW[0] + pixel.x) as usize]
    }
}

fn view() -> Vec2 {
    VIEW.map(|v| v as f32).into()
}

fn half_view() -> Vec2 {
    0.5 * view()
}

/// Random places in the view.
struct Places(Rng);

impl Places {
    fn next(&mut self) -> Vec2 {
        Vec2::new(self.0.f32(), self.0.f32()) * view() - half_view()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_stay_when_there_are_more() {
        let [few, many] = [10, 1000].map(|count| Scene::new(4, count));
        assert_eq!(few.occluders[..], many.occluders[..10]);
        let [few, many] = [10, 1000].map(|count| Scene::new(count, 10));
        assert_eq!(few.lamps[..], many.lamps[..10]);
    }

    #[test]
    fn lamps_stand_free_even_where_most_is_solid() {
        let scene = Scene::new(4, 10_000);
        assert!((0.9..1.0).contains(&scene.solid()), "{}", scene.solid());
        let inside = |lamp: &Vec2| {
            scene.occluders.iter().any(|o| (*o - *lamp).abs().max_element() < 0.5 * SIDE)
        };
        assert!(!scene.lamps.iter().any(inside));
        assert!(scene.occluders.iter().all(|o| o.abs().cmple(half_view()).all()));
    }
}
