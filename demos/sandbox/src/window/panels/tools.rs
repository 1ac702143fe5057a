//! The tools of the pointer: brushes of a world, or tools of the canvas.

use crate::window::view::{Pointer, is_inside};
use eframe::egui::{Button, ComboBox, Slider, Ui, color_picker};
use lamplight::{Lamp, Rgb};
use lamplight_sandbox::canvas::{As, Brush, Canvas, Stuff, Tool};

/// The kind of a brush.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BrushKind {
    Wall,
    Glass,
    Fog,
    Glow,
    Lamp,
    Backdrop,
    Erase,
}

impl BrushKind {
    const ALL: [(Self, &str, &str); 7] = [
        (Self::Wall, "Wall", "Blocks light and reflects its colour"),
        (Self::Glass, "Glass", "Colours the light that passes through"),
        (Self::Fog, "Fog", "Absorbs some light and scatters some"),
        (Self::Glow, "Glow", "Solid matter that emits light"),
        (Self::Lamp, "Lamp", "Click to add a lamp, drag to move it, right click to remove it"),
        (Self::Backdrop, "Backdrop", "The colour behind open space"),
        (Self::Erase, "Erase", "Removes matter"),
    ];
}

/// The selected tool and its settings.
pub struct Tools {
    kind: BrushKind,
    tool: Tool,
    color: [f32; 3],
    /// Multiplies the colour of glowing matter.
    intensity: f32,
    opacity: f32,
    pub radius: f32,
    /// The brush of a world.
    pub brush: usize,
    /// The lamp being dragged.
    dragged: Option<usize>,
}

impl Default for Tools {
    fn default() -> Self {
        Self {
            kind: BrushKind::Glow,
            tool: Tool::Free,
            color: [1.0, 0.55, 0.2],
            intensity: 4.0,
            opacity: 0.05,
            radius: 3.0,
            brush: 0,
            dragged: None,
        }
    }
}

impl Tools {
    /// Shows the tools of a canvas, which may have replaced a former one. Returns true if the user undoes.
    pub fn show_canvas(&mut self, ui: &mut Ui, canvas: &mut Canvas, has_former: bool) -> bool {
        for (kind, name, words) in BrushKind::ALL {
            ui.selectable_value(&mut self.kind, kind, name).on_hover_text(words);
        }
        ui.separator();
        if self.kind != BrushKind::Erase {
            ui.label("Colour");
            color_picker::color_edit_button_rgb(ui, &mut self.color);
        }
        if matches!(self.kind, BrushKind::Glow | BrushKind::Lamp) {
            ui.label("Brightness");
            ui.add(
                Slider::new(&mut self.intensity, 0.1..=100.0).logarithmic(true).show_value(true),
            );
        }
        if self.kind == BrushKind::Fog {
            ui.label("Thickness");
            ui.add(Slider::new(&mut self.opacity, 0.001..=0.9).logarithmic(true));
        }
        self.radius(ui);
        if self.kind != BrushKind::Lamp {
            let name = |tool| match tool {
                Tool::Free => "Free hand",
                Tool::Line => "Line",
                Tool::Rectangle { filled: false } => "Rectangle",
                Tool::Rectangle { filled: true } => "Filled rectangle",
                Tool::Fill => "Fill",
            };
            ComboBox::from_id_salt("tool").selected_text(name(self.tool)).show_ui(ui, |ui| {
                for tool in [
                    Tool::Free,
                    Tool::Line,
                    Tool::Rectangle { filled: false },
                    Tool::Rectangle { filled: true },
                    Tool::Fill,
                ] {
                    ui.selectable_value(&mut self.tool, tool, name(tool));
                }
            });
        }
        ui.separator();
        let [undo, redo] = canvas.history_depth();
        let undoes = ui.horizontal(|ui| {
            let undoes = ui.add_enabled(undo > 0 || has_former, Button::new("Undo")).clicked();
            if ui.add_enabled(redo > 0, Button::new("Redo")).clicked() {
                self.redo(canvas);
            }
            undoes
        });
        if ui.button("Clear").clicked() {
            self.clear(canvas);
        }
        undoes.inner
    }

    /// Undoes an edit. The pointer lets go of its lamp, which may no longer be there.
    pub fn undo(&mut self, canvas: &mut Canvas) {
        self.dragged = None;
        canvas.undo();
    }

    /// Redoes an edit; see [`Self::undo`].
    pub fn redo(&mut self, canvas: &mut Canvas) {
        self.dragged = None;
        canvas.redo();
    }

    /// Clears the canvas; see [`Self::undo`].
    pub fn clear(&mut self, canvas: &mut Canvas) {
        self.dragged = None;
        canvas.clear();
    }

    /// Shows the brushes of a world.
    pub fn show_world(&mut self, ui: &mut Ui, brushes: &[&str]) {
        for (number, name) in brushes.iter().enumerate() {
            ui.selectable_value(&mut self.brush, number, *name);
        }
        if !brushes.is_empty() {
            self.radius(ui);
        }
    }

    fn radius(&mut self, ui: &mut Ui) {
        ui.label("Size");
        ui.add(Slider::new(&mut self.radius, 0.5..=40.0).logarithmic(true));
    }

    /// Resets everything that refers to a former canvas or world.
    pub fn reset(&mut self) {
        self.brush = 0;
        self.let_go();
    }

    /// Lets go of what is dragged.
    pub fn let_go(&mut self) {
        self.dragged = None;
    }

    /// The matter of a dropped picture: that of the brush if it has colours, otherwise walls.
    pub fn image(&self) -> As {
        match self.kind {
            BrushKind::Glow => As::Glow(self.intensity),
            BrushKind::Glass => As::Glass,
            BrushKind::Backdrop => As::Backdrop,
            BrushKind::Wall | BrushKind::Fog | BrushKind::Lamp | BrushKind::Erase => As::Wall,
        }
    }

    /// Chooses lamps.
    pub fn choose_lamp(&mut self) {
        self.kind = BrushKind::Lamp;
    }

    /// Applies the pointer to a canvas. Returns an error message.
    pub fn apply(&mut self, canvas: &mut Canvas, pointer: Pointer) -> Result<(), String> {
        let Some(at) = pointer.at else {
            if pointer.released {
                self.release(canvas);
            }
            return Ok(());
        };
        if pointer.pressed {
            self.press(canvas, at, pointer.other)?;
        } else if pointer.held {
            match self.dragged {
                Some(lamp) => canvas.move_lamp(lamp, at).map_err(|e| e.to_string())?,
                None => canvas.drag(at),
            }
        }
        if pointer.released {
            self.release(canvas);
        }
        Ok(())
    }

    fn press(&mut self, canvas: &mut Canvas, at: [f32; 2], other: bool) -> Result<(), String> {
        // Lamps can be dragged with any brush.
        let lamp = canvas.lamp_at(at);
        if let (Some(lamp), true) = (lamp, other) {
            // It may be the one that the other button drags; the indices of others change.
            self.dragged = None;
            return canvas.remove_lamp(lamp).map_err(|e| e.to_string());
        }
        // Nobody sees a lamp outside, and the other button removes.
        let adds = !other && is_inside(canvas.size(), at);
        if lamp.is_none() && self.kind == BrushKind::Lamp && !adds {
            return Ok(());
        }
        if lamp.is_some() || self.kind == BrushKind::Lamp {
            canvas.begin();
            self.dragged = match lamp {
                Some(lamp) => Some(lamp),
                None => Some(canvas.add_lamp(self.lamp(at)).map_err(|e| e.to_string())?),
            };
            return Ok(());
        }
        let stuff = if other { Stuff::Erase } else { self.stuff() };
        canvas.press(self.tool, Brush { stuff, radius: self.radius }, at);
        Ok(())
    }

    fn release(&mut self, canvas: &mut Canvas) {
        match self.dragged.take() {
            Some(_) => canvas.end(),
            None => canvas.release(),
        }
    }

    fn lamp(&self, position: [f32; 2]) -> Lamp {
        let (color, intensity) = (self.color, 4.0 * self.intensity);
        // A lamp to be dragged has to be seen.
        let size = self.radius.clamp(1.0, 8.0);
        Lamp { position, color, intensity, size, visible: true, ..Lamp::default() }
    }

    fn stuff(&self) -> Stuff {
        let color: Rgb = self.color;
        match self.kind {
            BrushKind::Wall => Stuff::Wall(color),
            BrushKind::Glass => Stuff::Glass(color),
            BrushKind::Fog => Stuff::Fog(self.opacity, color),
            BrushKind::Glow => Stuff::Glow(color.map(|v| v * self.intensity)),
            BrushKind::Backdrop => Stuff::Backdrop(color),
            BrushKind::Erase | BrushKind::Lamp => Stuff::Erase,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pointer(at: [f32; 2]) -> Pointer {
        Pointer { at: Some(at), held: true, ..Pointer::default() }
    }

    fn press(at: [f32; 2]) -> Pointer {
        Pointer { pressed: true, ..pointer(at) }
    }

    /// A canvas with lamps at these places.
    fn canvas(lamps: &[[f32; 2]]) -> Canvas {
        let mut canvas = Canvas::new([64, 36]).unwrap();
        for &position in lamps {
            canvas.add_lamp(Lamp { position, ..Lamp::default() }).unwrap();
        }
        canvas
    }

    #[test]
    fn a_lamp_that_is_removed_while_it_is_dragged_moves_no_other() {
        let mut canvas = canvas(&[[10.0, 10.0], [50.0, 10.0]]);
        let mut tools = Tools::default();
        tools.apply(&mut canvas, press([10.0, 10.0])).unwrap();
        tools.apply(&mut canvas, pointer([20.0, 20.0])).unwrap();
        tools.apply(&mut canvas, Pointer { other: true, ..press([20.0, 20.0]) }).unwrap();
        tools.apply(&mut canvas, Pointer { other: true, ..pointer([30.0, 30.0]) }).unwrap();
        let places: Vec<_> = canvas.lamps().iter().map(|lamp| lamp.position).collect();
        assert_eq!(places, [[50.0, 10.0]]);
    }

    #[test]
    fn a_lamp_that_is_undone_or_cleared_while_it_is_dragged_is_let_go() {
        let acts: [fn(&mut Tools, &mut Canvas); 2] = [Tools::undo, Tools::clear];
        for (i, act) in acts.into_iter().enumerate() {
            let mut canvas = canvas(&[]);
            let mut tools = Tools::default();
            tools.choose_lamp();
            tools.apply(&mut canvas, press([10.0, 10.0])).unwrap();
            act(&mut tools, &mut canvas);
            for x in 11..20 {
                tools.apply(&mut canvas, pointer([x as f32, 10.0])).unwrap();
            }
            let end = Pointer { released: true, held: false, ..pointer([20.0, 10.0]) };
            tools.apply(&mut canvas, end).unwrap();
            assert!(canvas.lamps().is_empty());
            assert_eq!(canvas.history_depth()[0], 0, "{i}");
        }
    }

    #[test]
    fn a_move_that_is_undone_while_it_goes_on_ends() {
        let mut canvas = canvas(&[[10.0, 10.0]]);
        let mut tools = Tools::default();
        tools.apply(&mut canvas, press([10.0, 10.0])).unwrap();
        tools.apply(&mut canvas, pointer([20.0, 10.0])).unwrap();
        tools.undo(&mut canvas);
        for x in 21..30 {
            tools.apply(&mut canvas, pointer([x as f32, 10.0])).unwrap();
        }
        assert_eq!(canvas.lamps()[0].position, [10.0, 10.0]);
        assert_eq!(canvas.history_depth(), [1, 1]);
    }

    #[test]
    fn lamps_are_placed_in_the_picture_only() {
        let mut canvas = canvas(&[]);
        let mut tools = Tools::default();
        tools.choose_lamp();
        for at in [[-3.0, 10.0], [64.5, 10.0], [10.0, -9.0], [10.0, 36.0]] {
            tools.apply(&mut canvas, press(at)).unwrap();
            tools.apply(&mut canvas, Pointer { released: true, ..Pointer::default() }).unwrap();
        }
        assert!(canvas.lamps().is_empty() && canvas.history_depth() == [0, 0]);
        let missed = Pointer { other: true, ..press([30.0, 10.0]) };
        tools.apply(&mut canvas, missed).unwrap();
        assert!(canvas.lamps().is_empty(), "the button that removes lamps adds one");
        tools.apply(&mut canvas, press([0.5, 0.5])).unwrap();
        assert_eq!(canvas.lamps().len(), 1);
    }

    #[test]
    fn whatever_the_pointer_does_can_be_undone() {
        let seed = fastrand::u64(..);
        println!("seed {seed}");
        let mut rng = fastrand::Rng::with_seed(seed);
        for _ in 0..40 {
            let mut canvas = canvas(&[[10.0, 10.0], [50.0, 10.0]]);
            canvas.set_history_limit(usize::MAX);
            let undone = |canvas: &mut Canvas| {
                while canvas.undo() {}
                canvas.cells().clone()
            };
            let first = undone(&mut canvas.clone());
            let mut tools = Tools::default();
            let mut held = false;
            for _ in 0..300 {
                (tools.kind, _, _) = BrushKind::ALL[rng.usize(..BrushKind::ALL.len())];
                tools.tool = [Tool::Free, Tool::Line, Tool::Rectangle { filled: true }, Tool::Fill]
                    [rng.usize(..4)];
                match rng.usize(..20) {
                    0 => tools.undo(&mut canvas),
                    1 => tools.redo(&mut canvas),
                    2 if rng.usize(..8) == 0 => tools.clear(&mut canvas),
                    _ => {}
                }
                let pressed = rng.usize(..4) == 0;
                let released = rng.usize(..4) == 0;
                held = (held || pressed) && !released;
                let at = [80.0 * rng.f32() - 8.0, 52.0 * rng.f32() - 8.0];
                let at = (rng.usize(..10) > 0).then_some(at);
                let pointer = Pointer { at, held, pressed, released, other: rng.usize(..3) == 0 };
                tools.apply(&mut canvas, pointer).unwrap();
                canvas.cells().check().unwrap();
            }
            assert!(undone(&mut canvas) == first);
        }
    }
}
