//! The picture: what the pointer and the keys do to it, then its light.

use super::App;
use crate::window::benchmark::Benchmark;
use crate::window::halves::{Half, Halves};
use crate::window::inspect::View as Seen;
use crate::window::light::Lit;
use crate::window::panels::tools::Tools;
use crate::window::probe::meter;
use crate::window::subject::Subject;
use crate::window::view::{Pointer, View};
use crate::window::words;
use anyhow::Result;
use eframe::egui::{Color32, Context, Key, Stroke, Ui};
use lamplight::coarse::spread;
use lamplight_sandbox::clock::Clock;
use lamplight_sandbox::worlds::Input;

impl App {
    /// The picture: what the pointer and the keys do to it, then its light.
    pub(super) fn picture(&mut self, ui: &mut Ui) {
        let view = View::new(ui, self.subject.size(), self.whole);
        let pointer = view.pointer(ui);
        let passed = f64::from(ui.input(|input| input.stable_dt));
        // A script is the same on every machine.
        let seconds = if self.script.is_some() { Clock::STEP } else { passed };
        let told = match &mut self.subject {
            Subject::Canvas(canvas) => self.tools.apply(canvas, pointer),
            Subject::World(playing) => {
                playing.play(seconds, &self.tools.input(ui, pointer));
                Ok(())
            }
        };
        if let Err(why) = told {
            self.message = Some(why);
        }
        match self.light(pointer.at, passed) {
            Ok(()) => self.unlit = None,
            Err(why) => self.give_up(ui.ctx(), &why),
        }
        match self.inspector.view.is_lit() {
            true => self.halves.draw(ui, view.place),
            false => self.inspector.draw(ui.painter(), view.place),
        }
        let saved = self.saving.go_on(&self.halves.left.lit, self.shown.display, &self.name);
        self.say(saved);
        if self.subject.has_meter()
            && let (Subject::World(playing), Some(light)) = (&self.subject, self.probe.light())
            && let cells = self.subject.cells()
            && let Some(light) = spread(light, self.resolution.cells(cells), cells)
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

    /// Finds the light of the frame, and what else the view asks for.
    fn light(&mut self, at: Option<[f32; 2]>, passed: f64) -> Result<()> {
        let (cells, view) = (self.subject.cells(), self.inspector.view);
        self.resolution.prepare(cells)?;
        self.shown.light_alone = view == Seen::Light;
        if self.benchmark.settings().is_some() {
            return self.time(passed);
        }
        let asks = self.subject.has_meter() || view.needs_light();
        let found = match view.is_lit() {
            true => self.halves.find(cells, &self.resolution, self.shown),
            false if asks => self.halves.edited().find(cells, &self.resolution, self.shown),
            false => Ok(()),
        };
        // A view needs no light, and one half none of the other's.
        let Half { settings, lit, .. } = self.halves.edited();
        let (cells, settings) = (self.resolution.cells(cells), self.resolution.settings(settings));
        if found.is_ok() {
            self.probe.look(lit, cells, at.filter(|_| view.is_lit()), asks)?;
        }
        let looked = self.inspector.look(cells, &settings, self.shown.display, self.probe.light());
        found.and(looked)
    }

    /// Finds the light of a frame of the benchmark.
    fn time(&mut self, passed: f64) -> Result<()> {
        if self.benchmark.subject != self.what_is_timed() {
            // Times of other cells do not belong into the same table.
            self.benchmark = Benchmark::default();
        }
        let Some(settings) = self.benchmark.settings() else { return Ok(()) };
        let settings = self.resolution.settings(settings);
        let cells = self.resolution.cells(self.subject.cells());
        let lit = &mut self.halves.left.lit;
        lit.forget();
        match lit.find(cells, self.subject.cells(), &settings, self.shown) {
            Ok(()) => self.benchmark.lit(lit.stages(), passed),
            // Whatever it is: the next one may be able to.
            Err(_) => self.benchmark.refused(),
        }
        Ok(())
    }

    /// Says why there is no light; where it is the GPU that cannot, the CPU goes on.
    fn give_up(&mut self, context: &Context, why: &anyhow::Error) {
        use lamplight_wgpu::Error::{Device, TooLarge};
        self.unlit = Some(words(why));
        if matches!(why.downcast_ref(), Some(Device(_) | TooLarge { .. }))
            && let Ok(lit) = Lit::on_cpu(context, &self.halves.left.settings)
        {
            self.message = Some(format!("{}; the CPU goes on", words(why)));
            self.halves = Halves::new(self.halves.left.settings.clone(), lit);
        }
    }
}

impl Tools {
    /// What a world is told.
    fn input(&self, ui: &Ui, pointer: Pointer) -> Input {
        // Who types a name does not walk.
        if ui.ctx().egui_wants_keyboard_input() {
            return self.pointing(pointer);
        }
        let (direction, action, switch) = ui.input(|input| {
            let down =
                |keys: [Key; 2]| f32::from(u8::from(keys.iter().any(|&key| input.key_down(key))));
            let right = down([Key::ArrowRight, Key::D]) - down([Key::ArrowLeft, Key::A]);
            let lower = down([Key::ArrowDown, Key::S]) - down([Key::ArrowUp, Key::W]);
            let action = input.key_pressed(Key::Space) || input.key_pressed(Key::E);
            ([right, lower], action, input.key_pressed(Key::F))
        });
        Input { direction, action, switch, ..self.pointing(pointer) }
    }

    /// The same without keys.
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
