//! The interface of a world.

use crate::look::Look;
use lamplight::Cells;

/// Seconds per step of a world.
pub const STEP: f64 = 1.0 / 60.0;

/// The input of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    /// Position of the pointer, in cells from the top left; `None` outside of the picture.
    pub pointer: Option<[f32; 2]>,
    /// True if the pointer button is down.
    pub pressed: bool,
    /// True if the button was pressed since the last step.
    pub just_pressed: bool,
    /// True if the button was released since the last step.
    pub just_released: bool,
    /// Index into [`World::brushes`].
    pub brush: usize,
    /// Radius of the brush, px; worlds clamp it to their range.
    pub radius: f32,
    /// Direction keys: −1, 0 or 1, positive to the right and down.
    pub direction: [f32; 2],
    /// True if the action key (Space) was pressed since the last step.
    pub action: bool,
    /// True if the switch key (F) was pressed since the last step.
    pub switch: bool,
}

impl Input {
    /// Removes events, which reach exactly one step.
    #[must_use]
    pub fn held(&self) -> Self {
        Self { just_pressed: false, just_released: false, action: false, switch: false, ..*self }
    }

    /// Adds the events of an earlier input that have not reached a step yet.
    #[must_use]
    pub fn after(&self, before: &Self) -> Self {
        Self {
            just_pressed: self.just_pressed || before.just_pressed,
            just_released: self.just_released || before.just_released,
            action: self.action || before.action,
            switch: self.switch || before.switch,
            ..*self
        }
    }
}

/// A world that the user plays with.
pub trait World {
    /// Columns and rows.
    fn size(&self) -> [u32; 2];

    /// Advances by [`STEP`] seconds.
    fn step(&mut self, input: &Input);

    /// Replaces matter, lamps and the sky of cells that have the world's size. Cells of another size stay
    /// unchanged. Only the first call allocates.
    fn draw(&self, cells: &mut Cells);

    /// One line of instructions.
    fn help(&self) -> &'static str;

    /// Names of the brushes; empty if the world has none.
    fn brushes(&self) -> &'static [&'static str] {
        &[]
    }

    /// Its preferred light and display settings.
    fn look(&self) -> Look;

    /// Returns true if it has a player, whose light [`World::lit`] measures.
    fn has_player(&self) -> bool {
        false
    }

    /// Brightness of the player, 0 to 1; `None` without a player.
    fn lit(&self, _light: &lamplight::Light) -> Option<f32> {
        None
    }
}

/// Returns whether cells have a world's size.
pub(super) fn fits(size: [u32; 2], cells: &Cells) -> bool {
    size == [cells.width(), cells.height()]
}

/// Copies everything except the lamps, without allocating.
pub(super) fn copy(from: &Cells, to: &mut Cells) {
    to.emission_mut().copy_from_slice(from.emission());
    to.opacity_mut().copy_from_slice(from.opacity());
    to.tint_mut().copy_from_slice(from.tint());
    to.albedo_mut().copy_from_slice(from.albedo());
    if let Some(color) = from.color() {
        to.color_mut().copy_from_slice(color);
    }
    if let Some(normals) = from.normals() {
        to.normals_mut().copy_from_slice(normals);
    }
    to.set_sky(from.sky().clone());
}
