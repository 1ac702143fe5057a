//! The window's content, frame by frame.

use super::{CELLS, Script, Start};
use crate::platform;
use crate::window::benchmark::Benchmark;
use crate::window::files::Inbox;
use crate::window::folded::{Folded, Side};
use crate::window::fonts::fonts;
use crate::window::halves::{Half, Halves};
use crate::window::inspect::{Inspector, View as Seen};
use crate::window::light::{self, Lit, Shown};
use crate::window::panels::timings::Timings;
use crate::window::panels::tools::Tools;
use crate::window::panels::{settings, settings::Panel, view};
use crate::window::probe::{Probe, meter};
use crate::window::resolution::{Resolution, at_cells};
use crate::window::saving::{Kind, Saving};
use crate::window::script::Line;
use crate::window::subject::{Choice, Subject};
use crate::window::view::{Pointer, View};
use anyhow::{Context as _, Result};
use eframe::CreationContext;
use eframe::egui::{
    self, Button, CentralPanel, CollapsingHeader, Color32, Context, DroppedFile, Event, Frame, Key,
    KeyboardShortcut, Modifiers, PointerButton, RawInput, RichText, ScrollArea, Stroke, TextEdit,
    Theme, Ui, UserData, ViewportCommand,
};
use lamplight::settings::Holographic;
use lamplight::{Error, Settings, SettingsTable};
use lamplight_sandbox::clock::Clock;
use lamplight_sandbox::worlds::Input;
use std::path::PathBuf;

/// Everything there is.
pub struct App {
    choice: Choice,
    subject: Subject,
    size: [u32; 2],
    seed: u64,
    halves: Halves,
    resolution: Resolution,
    benchmark: Benchmark,
    inspector: Inspector,
    shown: Shown,
    /// Each cell as many whole pixels as fit.
    whole: bool,
    probe: Probe,
    tools: Tools,
    panel: Panel,
    folded: Folded,
    timings: Timings,
    /// What went wrong, to be read.
    message: Option<String>,
    /// Why there is no light, as long as there is none.
    unlit: Option<String>,
    saving: Saving,
    /// What files are saved as.
    name: String,
    script: Option<Script>,
    /// What the script's person does to the window, in its next frame.
    played: Vec<Event>,
    dropped: Vec<DroppedFile>,
    inbox: Inbox,
    /// Where the picture was in the last frame, for the script's person.
    view: Option<View>,
    shots: Vec<PathBuf>,
}

impl App {
    pub fn new(context: &CreationContext, start: &Start, script: Option<Script>) -> Result<Self> {
        context.egui_ctx.set_fonts(fonts());
        // Light is judged against the dark.
        context.egui_ctx.set_theme(Theme::Dark);
        let gpu = light::gpu(context, start.backend);
        let cells = if gpu.is_some() { CELLS } else { platform::CELLS_ON_CPU };
        let size = start.size.unwrap_or(cells);
        let subject = Subject::new(start.world, size, start.seed)?;
        let look = subject.look();
        let mut settings = look.settings();
        let lit = Lit::new(&context.egui_ctx, gpu, &settings)?;
        if !lit.is_gpu() {
            // A GPU has time for more.
            settings.holographic = Holographic::preset("fast").unwrap_or_default();
        }
        Ok(Self {
            choice: start.world,
            probe: Probe::default(),
            subject,
            size,
            seed: start.seed,
            halves: Halves::new(settings, lit),
            // A script is the same on every machine.
            resolution: Resolution::new(script.is_none())?,
            benchmark: Benchmark::default(),
            inspector: Inspector::new(&context.egui_ctx),
            shown: Shown { display: look.display, ..Shown::default() },
            whole: true,
            tools: Tools::default(),
            panel: Panel::new(),
            folded: Folded::default(),
            timings: Timings::default(),
            message: None,
            unlit: None,
            saving: Saving::default(),
            name: "painting".to_owned(),
            script,
            played: Vec::new(),
            dropped: Vec::new(),
            inbox: Inbox::default(),
            view: None,
            shots: Vec::new(),
        })
    }

    /// Goes over to another subject, lit as it asks to be, by the method at hand.
    fn choose(&mut self, choice: Choice) {
        match Subject::new(choice, self.size, self.seed) {
            Ok(subject) => {
                let look = subject.look();
                let asked = look.settings();
                for half in self.halves.each() {
                    half.settings.bounces = asked.bounces;
                    half.settings.wall_depth = asked.wall_depth;
                }
                self.shown.display = look.display;
                (self.choice, self.subject) = (choice, subject);
                self.tools.brush = 0;
            }
            Err(why) => self.message = Some(why.to_string()),
        }
    }

    /// What is on, how it is lit, how fast.
    fn bar(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            self.folded.buttons(ui);
            for choice in Choice::ALL {
                if ui.selectable_label(self.choice == choice, choice.name()).clicked() {
                    self.choose(choice);
                }
            }
            if let Subject::World(playing) = &mut self.subject {
                ui.separator();
                let label = if playing.paused { "Play" } else { "Pause" };
                if ui.button(label).clicked() {
                    playing.paused = !playing.paused;
                }
                if ui.button("Restart").clicked() {
                    self.choose(self.choice);
                }
            }
            ui.separator();
            ui.label(self.subject.help());
        });
    }

    fn settings(&mut self, ui: &mut Ui) {
        let [w, h] = self.subject.size();
        ui.label(format!("{w}×{h} cells on {}", self.halves.left.lit.place()));
        let (ms, fps) = (self.timings.last(), self.timings.frames_a_second());
        ui.label(format!("{ms:.1} ms of light, {fps:.0} frames a second"));
        ui.label(RichText::new(self.probe.words(w)).monospace())
            .on_hover_text("The light at the pointer: linear red, green, blue");
        ui.separator();
        CollapsingHeader::new("View").default_open(true).show(ui, |ui| {
            view::show(ui, &mut self.inspector);
            if let Err(why) = view::split(ui, &mut self.halves) {
                self.message = Some(why);
            }
            if let Some(size) = view::size(ui, self.subject.size()) {
                self.resize(size);
            }
            view::resolution(ui, &mut self.resolution);
        });
        self.panel.show(ui, &mut self.halves.edited().settings);
        CollapsingHeader::new("Picture").default_open(true).show(ui, |ui| {
            settings::display(ui, &mut self.shown.display);
            ui.checkbox(&mut self.shown.smooth, "smooth")
                .on_hover_text("Between cells; off: pixel art");
            ui.checkbox(&mut self.whole, "whole pixels")
                .on_hover_text("Each cell as many whole pixels as fit, so that all are alike");
        });
        CollapsingHeader::new("Save").default_open(true).show(ui, |ui| self.files(ui));
        CollapsingHeader::new("Times").default_open(true).show(ui, |ui| {
            let words = "Runs every method and preset in turn on what is shown";
            if ui.button("Benchmark").on_hover_text(words).clicked() {
                self.begin_benchmark();
            }
            self.timings.show(ui);
            if let Some(bytes) = self.halves.memory() {
                ui.label(format!("{:.1} MB held by the light", bytes as f64 / 1e6));
            }
        });
    }

    fn begin_benchmark(&mut self) {
        let cells = self.resolution.cells(self.subject.cells());
        let (w, h) = (cells.width(), cells.height());
        let (what, place) = (self.choice.name(), self.halves.left.lit.place());
        let subject = format!("{w}×{h} cells of {what} on {place}");
        self.benchmark.begin(&self.halves.left.settings, subject);
    }

    /// Begins anew at another size; a canvas that was painted on stays.
    fn resize(&mut self, size: [u32; 2]) {
        if let Subject::Canvas(canvas) = &self.subject
            && canvas.history_depth() != [0, 0]
        {
            self.message = Some(
                "another size begins anew: save this canvas, and choose Paint for a new one".into(),
            );
            return;
        }
        self.size = size;
        self.choose(self.choice);
    }

    fn tools(&mut self, ui: &mut Ui) {
        match &mut self.subject {
            Subject::Canvas(canvas) => self.tools.show_canvas(ui, canvas),
            Subject::World(playing) => self.tools.show_world(ui, playing.world.brushes()),
        }
    }

    /// The picture: what the pointer and the keys do to it, then its light.
    fn picture(&mut self, ui: &mut Ui) {
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
        let saved = self.saving.go_on(&self.halves.left.lit, self.shown.display, &self.name);
        self.say(saved);
        match self.inspector.view.is_lit() {
            true if self.unlit.is_none() => self.halves.draw(ui, view.place),
            true => {}
            false => self.inspector.draw(ui.painter(), view.place),
        }
        if let (Subject::World(playing), Some(light)) = (&self.subject, self.probe.light())
            && let Some(light) = at_cells(light, self.subject.cells())
            && let Some(lit) = playing.world.lit(&light)
        {
            meter(ui, view.place, lit);
        }
        self.timings.push(self.halves.edited().lit.stages(), passed);
        if self.benchmark.settings().is_none() && self.inspector.view.is_lit() {
            self.resolution.watch(passed, self.timings.light());
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
        if view.is_lit() || view.needs_light() || self.subject.has_meter() {
            self.halves.find(cells, &self.resolution, self.shown, view.is_lit())?;
        }
        let asks = self.subject.has_meter() || view.needs_light();
        let Half { settings, lit } = &self.halves.left;
        let (cells, settings) = (self.resolution.cells(cells), self.resolution.settings(settings));
        self.probe.look(lit, cells, at.filter(|_| view.is_lit()), asks)?;
        self.inspector.look(cells, &settings, self.shown.display, self.probe.light())
    }

    /// Finds the light of a frame of the benchmark.
    fn time(&mut self, passed: f64) -> Result<()> {
        let Some(settings) = self.benchmark.settings() else { return Ok(()) };
        let settings = self.resolution.settings(settings);
        let cells = self.resolution.cells(self.subject.cells());
        let lit = &mut self.halves.left.lit;
        lit.forget();
        match lit.find(cells, &settings, self.shown) {
            Ok(()) => self.benchmark.lit(lit.stages(), passed),
            Err(why) if matches!(why.downcast_ref(), Some(Error::Unsuited { .. })) => {
                self.benchmark.refused();
            }
            Err(why) => return Err(why),
        }
        Ok(())
    }

    /// Says why there is no light; where it is the GPU that cannot, the CPU goes on.
    fn give_up(&mut self, context: &Context, why: &anyhow::Error) {
        use lamplight_wgpu::Error::{Device, TooLarge};
        self.unlit = Some(format!("{why:#}"));
        if matches!(why.downcast_ref(), Some(Device(_) | TooLarge { .. }))
            && let Ok(lit) = Lit::on_cpu(context, &self.halves.left.settings)
        {
            self.message = Some(format!("{why:#}; the CPU goes on"));
            self.halves = Halves::new(self.halves.left.settings.clone(), lit);
        }
    }

    /// Takes files that were dropped on the window.
    fn take_files(&mut self, context: &Context) {
        for file in context.input(|input| input.raw.dropped_files.clone()) {
            match self.inbox.take(file, context.time(), &mut self.subject) {
                Ok(said) => {
                    self.choice = Choice::Paint;
                    let look = self.subject.look();
                    self.shown.display = look.display;
                    self.message = said;
                }
                Err(why) => self.message = Some(format!("{why:#}")),
            }
        }
    }

    /// What went wrong.
    fn messages(&mut self, ui: &mut Ui) {
        let color = ui.visuals().warn_fg_color;
        if let Some(unlit) = &self.unlit {
            ui.colored_label(color, unlit);
        }
        if let Some(message) = &self.message {
            let read = ui.horizontal(|ui| {
                ui.colored_label(color, message);
                ui.button("OK").clicked()
            });
            if read.inner {
                self.message = None;
            }
        }
    }

    /// Where to save, and what.
    fn files(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label("Name");
            ui.add(TextEdit::singleline(&mut self.name).desired_width(120.0));
        });
        ui.horizontal(|ui| {
            for kind in Kind::ALL {
                let can = kind != Kind::Scene || matches!(self.subject, Subject::Canvas(_));
                let button = ui.add_enabled(can, Button::new(kind.name()));
                if button.on_hover_text(kind.words()).clicked() {
                    let begun =
                        self.saving.begin(kind, &self.halves.left.lit, &self.subject, &self.name);
                    self.say(begun);
                }
            }
        });
    }

    /// Keeps what there is to say, and what went wrong, to be read.
    pub fn say(&mut self, said: Result<Option<String>>) {
        match said {
            Ok(None) => {}
            Ok(said) => self.message = said,
            Err(why) => self.message = Some(format!("{why:#}")),
        }
    }

    /// Keys that work everywhere.
    fn keys(&mut self, context: &Context) {
        let Subject::Canvas(canvas) = &mut self.subject else { return };
        let struck = |modifiers, key| {
            context
                .input_mut(|input| input.consume_shortcut(&KeyboardShortcut::new(modifiers, key)))
        };
        // The longer one first: it holds the other.
        if struck(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
            || struck(Modifiers::COMMAND, Key::Y)
        {
            canvas.redo();
        } else if struck(Modifiers::COMMAND, Key::Z) {
            canvas.undo();
        }
    }

    /// Does what the script says next.
    fn follow(&mut self, context: &Context) {
        // A picture of the window comes a frame later, and shows that frame.
        if !self.shots.is_empty() {
            return;
        }
        if self.script.as_ref().is_some_and(Script::is_over) {
            self.script = None;
            platform::script_is_over(context);
        }
        if self.script.is_none()
            && let Some(text) = platform::next_script()
        {
            self.script = Script::read(&text).map_err(|why| self.say(Err(why))).ok();
        }
        let Some(line) = self.script.as_mut().and_then(Script::next) else { return };
        if let Err(why) = self.obey(context, line) {
            self.message = Some(format!("{why:#}"));
        }
    }

    fn obey(&mut self, context: &Context, line: Line) -> Result<()> {
        let button = |pressed, pos| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let there = context.pointer_latest_pos().unwrap_or_default();
        match line {
            Line::Frames(_) => {}
            Line::World(choice) => self.choose(choice),
            Line::Set(text) => {
                let settings = &mut self.halves.edited().settings;
                let mut table: SettingsTable =
                    serde_json::from_value(serde_json::to_value(&*settings)?)?;
                table.set_from_text(&text)?;
                *settings = table.resolve()?;
            }
            Line::Move([x, y]) => {
                let view = self.view.as_ref().context("there is no picture yet")?;
                self.played.push(Event::PointerMoved(view.to_window([x, y])));
            }
            Line::View(view, inside) => {
                (self.inspector.view, self.inspector.inside) = (view, inside);
            }
            Line::Benchmark => self.begin_benchmark(),
            Line::Lose => self.halves.left.lit.lose(),
            Line::Size(size) => {
                context.send_viewport_cmd(ViewportCommand::InnerSize(size.into()));
            }
            Line::Table => print!("{}", self.benchmark.markdown()),
            Line::Factor(factor) => {
                self.resolution.factor = factor;
                self.resolution.adapts = false;
            }
            Line::Split(method) => {
                let settings = self.halves.left.settings.clone();
                self.halves.split(Settings { method, ..settings })?;
            }
            Line::Press => self.played.push(button(true, there)),
            Line::Release => self.played.push(button(false, there)),
            Line::Clear => {
                if let Subject::Canvas(canvas) = &mut self.subject {
                    canvas.clear();
                }
            }
            Line::Lamp => self.tools.choose_lamp(),
            Line::Drop(path) => {
                self.dropped.push(DroppedFile { path: Some(path), ..DroppedFile::default() });
            }
            Line::Say(word) => platform::say(&word),
            Line::Tell => {
                let told = self.message.as_ref().or(self.unlit.as_ref());
                platform::say(told.map_or("all is well", String::as_str));
            }
            Line::Place => {
                let place = self.view.as_ref().context("there is no picture yet")?.place;
                let [x, y, w, h] = [place.min.x, place.min.y, place.width(), place.height()];
                platform::say(&format!("{x} {y} {w} {h}"));
            }
            Line::Save(kind) => {
                let begun =
                    self.saving.begin(kind, &self.halves.left.lit, &self.subject, &self.name);
                self.say(begun);
            }
            Line::Shot(path) => {
                self.shots.push(path);
                context.send_viewport_cmd(ViewportCommand::Screenshot(UserData::default()));
            }
        }
        Ok(())
    }

    /// Saves the pictures of the window that have come.
    fn take_shots(&mut self, context: &Context) -> Result<()> {
        let come = context.input(|input| {
            let shots = input.events.iter().filter_map(|event| match event {
                Event::Screenshot { image, .. } => Some(image.clone()),
                _ => None,
            });
            shots.collect::<Vec<_>>()
        });
        for shot in come {
            let Some(path) = (!self.shots.is_empty()).then(|| self.shots.remove(0)) else { break };
            let [w, h] = shot.size.map(|side| side as u32);
            let pixels: Vec<u8> = shot.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
            let picture = image::RgbaImage::from_raw(w, h, pixels).context("a broken picture")?;
            picture.save(&path).with_context(|| format!("cannot write {}", path.display()))?;
        }
        Ok(())
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        if let Err(why) = self.take_shots(&context) {
            self.message = Some(format!("{why:#}"));
        }
        self.take_files(&context);
        self.keys(&context);
        self.follow(&context);
        egui::Panel::top("bar").show(ui, |ui| self.bar(ui));
        if self.message.is_some() || self.unlit.is_some() {
            egui::Panel::bottom("message").show(ui, |ui| self.messages(ui));
        }
        if let Some(panel) = self.folded.panel(&context, Side::Tools) {
            panel.show(ui, |ui| ScrollArea::vertical().show(ui, |ui| self.tools(ui)));
        }
        if let Some(panel) = self.folded.panel(&context, Side::Settings) {
            panel.show(ui, |ui| ScrollArea::vertical().show(ui, |ui| self.settings(ui)));
        }
        CentralPanel::default()
            .frame(Frame::NONE.fill(Color32::BLACK))
            .show(ui, |ui| self.picture(ui));
        if self.benchmark.is_on() {
            let window = egui::Window::new("Benchmark").resizable(false).collapsible(false);
            let open = window.show(&context, |ui| self.benchmark.show(ui));
            if open.and_then(|open| open.inner) == Some(false) {
                self.benchmark = Benchmark::default();
            }
        }
        // Light and worlds go on.
        context.request_repaint();
    }

    fn raw_input_hook(&mut self, _: &Context, input: &mut RawInput) {
        input.events.append(&mut self.played);
        input.dropped_files.append(&mut self.dropped);
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
