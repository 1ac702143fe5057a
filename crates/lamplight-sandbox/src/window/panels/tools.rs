//! What the pointer does: brushes of a world, or the tools of the canvas.

use crate::window::view::Pointer;
use eframe::egui::{Button, ComboBox, Slider, Ui, color_picker};
use lamplight::{Lamp, Rgb};
use lamplight_sandbox::canvas::{As, Brush, Canvas, Stuff, Tool};

/// Kinds of stuff, as they are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Wall,
    Glass,
    Fog,
    Glow,
    Lamp,
    Backdrop,
    Erase,
}

impl Kind {
    const ALL: [(Self, &str, &str); 7] = [
        (Self::Wall, "Wall", "Stops light and throws its colour back"),
        (Self::Glass, "Glass", "Colours the light that passes"),
        (Self::Fog, "Fog", "Takes some light, and sends some on"),
        (Self::Glow, "Glow", "Solid matter that gives off light"),
        (Self::Lamp, "Lamp", "Click to put one down, drag to move it, right click to take it away"),
        (Self::Backdrop, "Backdrop", "What is seen behind open space"),
        (Self::Erase, "Erase", "Open space again"),
    ];
}

/// What is chosen.
pub struct Tools {
    kind: Kind,
    tool: Tool,
    color: [f32; 3],
    /// Times the colour, for what glows.
    intensity: f32,
    opacity: f32,
    pub radius: f32,
    /// The brush of a world.
    pub brush: usize,
    /// The lamp that is dragged.
    dragged: Option<usize>,
}

impl Default for Tools {
    fn default() -> Self {
        Self {
            kind: Kind::Glow,
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
    /// The tools of a canvas.
    pub fn show_canvas(&mut self, ui: &mut Ui, canvas: &mut Canvas) {
        for (kind, name, words) in Kind::ALL {
            ui.selectable_value(&mut self.kind, kind, name).on_hover_text(words);
        }
        ui.separator();
        if self.kind != Kind::Erase {
            ui.label("Colour");
            color_picker::color_edit_button_rgb(ui, &mut self.color);
        }
        if matches!(self.kind, Kind::Glow | Kind::Lamp) {
            ui.label("Brightness");
            ui.add(
                Slider::new(&mut self.intensity, 0.1..=100.0).logarithmic(true).show_value(true),
            );
        }
        if self.kind == Kind::Fog {
            ui.label("Thickness");
            ui.add(Slider::new(&mut self.opacity, 0.001..=0.9).logarithmic(true));
        }
        self.radius(ui);
        if self.kind != Kind::Lamp {
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
        ui.horizontal(|ui| {
            if ui.add_enabled(undo > 0, Button::new("Undo")).clicked() {
                canvas.undo();
            }
            if ui.add_enabled(redo > 0, Button::new("Redo")).clicked() {
                canvas.redo();
            }
        });
        if ui.button("Clear").clicked() {
            canvas.clear();
        }
    }

    /// The brushes of a world.
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

    /// Lets go of what belongs to a canvas or a world that is gone.
    pub fn let_all_go(&mut self) {
        (self.brush, self.dragged) = (0, None);
    }

    /// What a picture that is dropped becomes: what is chosen, where that can have colours; else walls.
    pub fn image(&self) -> As {
        match self.kind {
            Kind::Glow => As::Glow(self.intensity),
            Kind::Glass => As::Glass,
            Kind::Backdrop => As::Backdrop,
            Kind::Wall | Kind::Fog | Kind::Lamp | Kind::Erase => As::Wall,
        }
    }

    /// Chooses lamps.
    pub fn choose_lamp(&mut self) {
        self.kind = Kind::Lamp;
    }

    /// Lets the pointer work on a canvas; says what went wrong.
    pub fn apply(&mut self, canvas: &mut Canvas, pointer: Pointer) -> Result<(), String> {
        let Some(at) = pointer.at else {
            if pointer.released {
                self.let_go(canvas);
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
            self.let_go(canvas);
        }
        Ok(())
    }

    fn press(&mut self, canvas: &mut Canvas, at: [f32; 2], other: bool) -> Result<(), String> {
        // Lamps can be taken hold of whatever is chosen.
        let lamp = canvas.lamp_at(at);
        if let (Some(lamp), true) = (lamp, other) {
            return canvas.remove_lamp(lamp).map_err(|e| e.to_string());
        }
        if lamp.is_some() || self.kind == Kind::Lamp {
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

    fn let_go(&mut self, canvas: &mut Canvas) {
        match self.dragged.take() {
            Some(_) => canvas.end(),
            None => canvas.release(),
        }
    }

    fn lamp(&self, position: [f32; 2]) -> Lamp {
        let (color, intensity) = (self.color, 4.0 * self.intensity);
        Lamp { position, color, intensity, size: self.radius.clamp(1.0, 8.0), ..Lamp::default() }
    }

    fn stuff(&self) -> Stuff {
        let color: Rgb = self.color;
        match self.kind {
            Kind::Wall => Stuff::Wall(color),
            Kind::Glass => Stuff::Glass(color),
            Kind::Fog => Stuff::Fog(self.opacity, color),
            Kind::Glow => Stuff::Glow(color.map(|v| v * self.intensity)),
            Kind::Backdrop => Stuff::Backdrop(color),
            Kind::Erase | Kind::Lamp => Stuff::Erase,
        }
    }
}
