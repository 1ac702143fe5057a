//! The picture: input, then light.

use super::App;
use crate::message::message;
use crate::platform;
use crate::window::benchmark::Benchmark;
use crate::window::halves::{Half, Halves};
use crate::window::inspect::PictureView;
use crate::window::light::Lit;
use crate::window::panels::tools::Tools;
use crate::window::probe::meter;
use crate::window::subject::Subject;
use crate::window::view::{PictureFrame, Pointer, is_inside};
use anyhow::Result;
use eframe::egui::{Color32, Context, Event, Key, Stroke, Ui};
use lamplight::resample::upsample;
use lamplight_sandbox::worlds::{Input, STEP};

impl App {
    /// Applies input to the subject, then lights and draws it.
    pub(super) fn picture(&mut self, ui: &mut Ui) {
        let view = PictureFrame::new(ui, self.subject.size(), self.whole);
        let pointer = view.pointer(ui);
        let passed = f64::from(ui.input(|input| input.stable_dt));
        // Scripts are deterministic.
        let seconds = if self.script.is_some() { STEP } else { passed };
        let applied = match &mut self.subject {
            Subject::Canvas(canvas) => self.tools.apply(canvas, pointer),
            Subject::World(playing) => {
                playing.play(seconds, &self.tools.input(ui, pointer));
                Ok(())
            }
        };
        if let Err(why) = applied {
            self.message = Some(why);
        }
        match self.light(pointer.at, passed) {
            Ok(()) => self.unlit = None,
            Err(why) => self.give_up(ui.ctx(), &why),
        }
        if self.inspector.view.is_lit() {
            self.halves.draw(ui, view.place);
        } else {
            self.inspector.draw(ui.painter(), view.place);
        }
        let next = self.saving.go_on(&self.halves.left.lit, self.shown.display, &self.name);
        let saved = next.and_then(|file| file.map(|file| platform::save(&[file])).transpose());
        self.say(saved);
        if self.subject.has_meter()
            && let (Subject::World(playing), Some(light)) = (&self.subject, self.probe.light())
            && let cells = self.subject.cells()
            && let Ok(light) = upsample(light, self.resolution.cells(cells), cells)
            && let Some(lit) = playing.world.lit(&light)
        {
            meter(ui, view.place, lit);
        }
        self.timings.push(self.halves.edited().lit.stages(), passed);
        if self.benchmark.settings().is_none() && self.inspector.view.is_lit() {
            self.resolution.watch(passed, self.timings.light(), self.subject.size()[0]);
        }
        if let (Some(at), Subject::Canvas(_)) = (pointer.at, &self.subject) {
            let scale = view.place.width() / self.subject.size()[0] as f32;
            let stroke = Stroke::new(1.0, Color32::from_white_alpha(140));
            ui.painter().circle_stroke(view.to_window(at), self.tools.radius * scale, stroke);
        }
        self.view = Some(view);
    }

    /// Computes the light of the frame, and the current view.
    fn light(&mut self, at: Option<[f32; 2]>, passed: f64) -> Result<()> {
        let view = self.inspector.view;
        self.shown.light_alone = view == PictureView::Light;
        let cells = self.relief.shown(self.subject.cells(), self.shown.light_alone);
        self.resolution.prepare(cells)?;
        if self.benchmark.settings().is_some() {
            return self.time(passed);
        }
        let asks = self.subject.has_meter() || view.needs_light();
        let found = if view.is_lit() {
            self.halves.find(cells, &self.resolution, self.shown)
        } else if asks {
            self.halves.edited().find(cells, &self.resolution, self.shown)
        } else {
            Ok(())
        };
        // Views do not need light, and each half has its own: the pointer is in one of them.
        let at = at.filter(|at| view.is_lit() && is_inside(self.subject.size(), *at));
        let half = match at {
            Some([x, _]) => self.halves.under(x / cells.width() as f32),
            None => self.halves.edited(),
        };
        let Half { settings, lit, .. } = half;
        let (cells, settings) = (self.resolution.cells(cells), self.resolution.settings(settings));
        if found.is_ok() {
            self.probe.look(lit, cells, at, asks)?;
        }
        let looked = self.inspector.look(cells, &settings, self.shown.display, self.probe.light());
        found.and(looked)
    }

    /// Lights a frame of the benchmark.
    fn time(&mut self, passed: f64) -> Result<()> {
        if self.benchmark.subject != self.benchmark_subject() {
            // A table holds times of one subject only.
            self.benchmark = Benchmark::default();
        }
        let Some(settings) = self.benchmark.settings() else { return Ok(()) };
        let settings = self.resolution.settings(settings);
        let picture = self.relief.shown(self.subject.cells(), self.shown.light_alone);
        let cells = self.resolution.cells(picture);
        let lit = &mut self.halves.left.lit;
        lit.forget();
        match lit.find(cells, picture, &settings, self.shown) {
            Ok(()) => self.benchmark.lit(lit.stages(), passed),
            // The next method may work.
            Err(_) => self.benchmark.refused(),
        }
        Ok(())
    }

    /// Shows why there is no light. If the GPU failed, switches to the CPU.
    fn give_up(&mut self, context: &Context, why: &anyhow::Error) {
        use lamplight_wgpu::error::PrepareError::{Device, TooLarge};
        self.unlit = Some(message(why));
        if matches!(why.downcast_ref(), Some(Device(_) | TooLarge { .. }))
            && let Ok(lit) = Lit::on_cpu(context, &self.halves.left.settings)
        {
            self.message = Some(format!("{}; switched to the CPU", message(why)));
            self.halves = Halves::new(self.halves.left.settings.clone(), lit);
        }
    }
}

impl Tools {
    /// The input of a world.
    fn input(&self, ui: &Ui, pointer: Pointer) -> Input {
        // In a text field, keys do not move the player.
        if ui.ctx().egui_wants_keyboard_input() {
            return self.pointing(pointer);
        }
        let (direction, action, switch) = ui.input(|input| {
            let down =
                |keys: [Key; 2]| f32::from(u8::from(keys.iter().any(|&key| input.key_down(key))));
            let right = down([Key::ArrowRight, Key::D]) - down([Key::ArrowLeft, Key::A]);
            let lower = down([Key::ArrowDown, Key::S]) - down([Key::ArrowUp, Key::W]);
            // Systems repeat the press of a key that is held: doors would flap.
            let pressed = |wanted| {
                input.events.iter().any(|event| {
                    matches!(event, Event::Key { key, pressed: true, repeat: false, .. } if *key == wanted)
                })
            };
            ([right, lower], pressed(Key::Space) || pressed(Key::E), pressed(Key::F))
        });
        Input { direction, action, switch, ..self.pointing(pointer) }
    }

    /// The input of the pointer only.
    fn pointing(&self, pointer: Pointer) -> Input {
        Input {
            pointer: pointer.at,
            pressed: pointer.held,
            just_pressed: pointer.pressed,
            just_released: pointer.released,
            brush: self.brush,
            radius: self.radius,
            ..Input::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Modifiers, RawInput};

    #[test]
    fn a_key_that_is_held_acts_once() {
        let context = Context::default();
        let input = |repeat| {
            let event = |key| Event::Key {
                key,
                physical_key: None,
                pressed: true,
                repeat,
                modifiers: Modifiers::NONE,
            };
            let events = [Key::Space, Key::F, Key::ArrowLeft].map(event).to_vec();
            let mut seen = Input::default();
            let mut output = context.run_ui(RawInput { events, ..RawInput::default() }, |ui| {
                seen = Tools::default().input(ui, Pointer::default());
            });
            // No renderer takes the font's texture: egui panics on deltas dropped in silence.
            output.textures_delta.clear();
            (seen.action, seen.switch, seen.direction)
        };
        assert_eq!(input(false), (true, true, [-1.0, 0.0]));
        assert_eq!(input(true), (false, false, [-1.0, 0.0]));
    }
}
