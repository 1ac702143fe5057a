//! The matter around the grid of a camera, drawn on the rings of its surroundings.

use crate::placement::Placement;
use crate::quads::{ExtractedScene, SceneAssets};
use crate::raster::{digest_around, digest_of, images_around, rasterize_around};
use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::image::Image;
use bevy::math::Rect;
use bevy::platform::collections::HashSet;
use lamplight::Cells;
use lamplight::surroundings::{RingSurroundings, RingWindow};
use lamplight_wgpu::{GridPlacement, VisibleRect};

/// Rings, and what is drawn on them.
pub struct CameraRings {
    grid: GridPlace,
    rings: RingSurroundings,
    /// The pictures of all rings; empty if these are.
    drawn: Vec<DrawnRing>,
    /// The [`digest_of`] the scene that they show; `None` if it is not known.
    scene: Option<u64>,
    /// The cells of each ring.
    cells: Vec<Cells>,
}

/// The place of a camera's grid.
#[derive(Clone, Copy, PartialEq)]
pub struct GridPlace {
    cell: f32,
    origin: [i32; 2],
    size: [u32; 2],
}

impl GridPlace {
    pub fn of(placement: &Placement) -> Self {
        let Placement { cell, placed, .. } = placement;
        Self { cell: *cell, origin: placed.origin, size: placed.size }
    }

    /// The grid of a ring around it.
    fn ring(&self, window: RingWindow) -> Placement {
        let cell = self.cell * window.cell as f32;
        let side = window.cell as i32;
        let origin = [0, 1].map(|a| (self.origin[a] + window.first[a]).div_euclid(side));
        let visible = VisibleRect { corner: [0.0; 2], right: [1.0, 0.0], down: [0.0, 1.0] };
        let placed = GridPlacement { size: window.size, origin, visible };
        Placement { cell, requested: cell, placed }
    }
}

/// All that the matter of a ring depends on, but for the texels of images.
#[derive(Clone, Copy, PartialEq)]
struct RingPicture {
    place: Placement,
    /// The middle, which is not seen.
    hidden: Rect,
    /// The [`digest_around`] of the matter.
    digest: u64,
}

/// The picture of a ring.
#[derive(Default)]
struct DrawnRing {
    /// `None` if it has to be drawn.
    picture: Option<RingPicture>,
    /// The images of its matter.
    images: HashSet<AssetId<Image>>,
}

impl CameraRings {
    /// Returns empty rings around a grid.
    pub fn new(grid: GridPlace, count: usize) -> lamplight::Result<Self> {
        let rings = RingSurroundings::new(grid.size, grid.origin, count)?;
        Ok(Self { grid, rings, drawn: Vec::new(), scene: None, cells: Vec::new() })
    }

    /// Places them around another grid.
    pub fn place(&mut self, grid: GridPlace, count: usize) -> lamplight::Result<()> {
        self.rings.place(grid.size, grid.origin, count)?;
        self.grid = grid;
        self.scene = None;
        Ok(())
    }

    /// The rings, which know the light.
    pub fn light(&self) -> &RingSurroundings {
        &self.rings
    }

    /// The grid that they are around.
    pub fn grid(&self) -> GridPlace {
        self.grid
    }

    /// The area of the world that they cover.
    pub fn area(&self) -> Rect {
        let outermost = self.rings.window(self.rings.rings() - 1);
        self.grid.ring(outermost).area()
    }

    /// Draws those anew at the next time that show an image, because it has changed.
    pub fn forget(&mut self, image: AssetId<Image>) {
        for drawn in self.drawn.iter_mut().filter(|drawn| drawn.images.contains(&image)) {
            drawn.picture = None;
            self.scene = None;
        }
    }

    /// Draws the matter around an area, the grid's own, on those rings that do not show it yet. Returns their number.
    pub fn draw(
        &mut self,
        scene: &ExtractedScene,
        area: Rect,
        layers: &RenderLayers,
        assets: &SceneAssets,
    ) -> lamplight::Result<usize> {
        let Self { grid, rings, drawn, scene: shown, cells } = self;
        if scene.groups.is_empty() {
            rings.clear();
            *shown = None;
            return Ok(drawn.drain(..).count());
        }
        // In most frames nothing has changed, which takes less time to see than what each ring shows.
        let digest = Some(digest_of(scene));
        if *shown == digest {
            return Ok(0);
        }
        *shown = None;
        drawn.resize_with(rings.rings(), DrawnRing::default);
        while cells.len() < rings.rings() {
            cells.push(Cells::new(1, 1)?);
        }
        let mut count = 0;
        for (ring, (drawn, cells)) in drawn.iter_mut().zip(cells).enumerate() {
            let window = rings.window(ring);
            let place = grid.ring(window);
            let hidden = hidden(ring, &place, area);
            let digest = digest_around(scene, &place, hidden, layers);
            let picture = Some(RingPicture { place, hidden, digest });
            if drawn.picture == picture {
                continue;
            }
            drawn.picture = None;
            if [cells.width(), cells.height()] != window.size {
                *cells = Cells::new(window.size[0], window.size[1])?;
            }
            drawn.images.clear();
            drawn.images.extend(images_around(scene, &place, hidden, layers));
            rasterize_around(scene, &place, hidden, layers, assets, cells);
            rings.set(ring, cells)?;
            drawn.picture = picture;
            count += 1;
        }
        *shown = digest;
        Ok(count)
    }
}

/// The middle of a ring that is not seen, as rings nearer by cover it: in the first one, the grid itself. In the others it
/// is a little less, so that it stays with the ring while the camera moves.
fn hidden(ring: usize, place: &Placement, grid: Rect) -> Rect {
    if ring == 0 {
        return grid;
    }
    /// Cells by which the ring nearer by moves within this one.
    const STEPS: f32 = 4.0;
    let area = place.area();
    let rest = 0.25 * area.size() + STEPS * place.cell;
    Rect { min: area.min + rest, max: area.max - rest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::LightOccluder2d;
    use crate::quads::Gather;
    use bevy::ecs::system::SystemState;
    use bevy::math::Vec2;
    use bevy::prelude::{GlobalTransform, Transform, World};

    #[test]
    fn only_rings_whose_cells_or_matter_have_changed_are_drawn() {
        let mut world = World::new();
        let wall = |world: &mut World, x: f32| {
            let at = Transform::from_xyz(x, 0.0, 0.0);
            world.spawn((LightOccluder2d::rectangle(4.0, 4.0), GlobalTransform::from(at))).id()
        };
        let near = wall(&mut world, 200.0);
        wall(&mut world, 700.0);
        let grid = |x: i32| GridPlace { cell: 1.0, origin: [x - 128, -128], size: [256, 256] };
        let mut rings = CameraRings::new(grid(0), 3).unwrap();
        let mut draw = |world: &mut World, x: i32| {
            rings.place(grid(x), 3).unwrap();
            let area = Rect::from_center_half_size(Vec2::new(x as f32, 0.0), Vec2::splat(128.0));
            let mut state = SystemState::<(Gather, SceneAssets)>::new(world);
            let (gather, assets) = state.get(world).unwrap();
            let mut scene = ExtractedScene::default();
            gather.gather(&[rings.area()], &mut scene);
            rings.draw(&scene, area, &RenderLayers::default(), &assets).unwrap()
        };
        assert_eq!(draw(&mut world, 0), 3);
        assert_eq!(draw(&mut world, 0), 0);
        // The innermost has a new middle at every step, the next one other cells after sixteen.
        assert_eq!(draw(&mut world, 2), 1);
        assert_eq!(draw(&mut world, 18), 2);
        world.entity_mut(near).despawn();
        assert_eq!(draw(&mut world, 18), 1);
    }
}
