//! The window's content, frame by frame.

use super::{CELLS, Script, Start};
use crate::platform;
use crate::window::files::Inbox;
use crate::window::folded::{Folded, Side};
use crate::window::fonts::fonts;
use crate::window::light::{self, Lit, Shown};
use crate::window::panels::timings::Timings;
use crate::window::panels::tools::Tools;
use crate::window::panels::{settings, settings::Panel};
use crate::window::probe::{Probe, meter};
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
use lamplight::{Settings, SettingsTable};
use lamplight_sandbox::clock::Clock;
use lamplight_sandbox::worlds::Input;
use std::path::PathBuf;

/// Everything there is.
pub struct App {
    choice: Choice,
    subject: Subject,
    size: [u32; 2],
    seed: u64,
    settings: Settings,
    shown: Shown,
    /// Each cell as many whole pixels as fit.
    whole: bool,
    lit: Lit,
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
            lit,
            probe: Probe::default(),
            subject,
            size,
            seed: start.seed,
            settings,
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
                self.settings.bounces = asked.bounces;
                self.settings.wall_depth = asked.wall_depth;
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
        ui.label(format!("{w}×{h} cells on {}", self.lit.place()));
        let (ms, fps) = (self.timings.last(), self.timings.frames_a_second());
        ui.label(format!("{ms:.1} ms of light, {fps:.0} frames a second"));
        ui.label(RichText::new(self.probe.words()).monospace())
            .on_hover_text("The light at the pointer: linear red, green, blue");
        ui.separator();
        self.panel.show(ui, &mut self.settings);
        CollapsingHeader::new("Picture").default_open(true).show(ui, |ui| {
            settings::display(ui, &mut self.shown.display);
            ui.checkbox(&mut self.shown.light_alone, "light alone")
                .on_hover_text("The light that arrives, on white");
            ui.checkbox(&mut self.shown.smooth, "smooth")
                .on_hover_text("Between cells; off: pixel art");
            ui.checkbox(&mut self.whole, "whole pixels")
                .on_hover_text("Each cell as many whole pixels as fit, so that all are alike");
        });
        CollapsingHeader::new("Save").default_open(true).show(ui, |ui| self.files(ui));
        CollapsingHeader::new("Times").default_open(true).show(ui, |ui| {
            self.timings.show(ui);
            if let Some(bytes) = self.lit.memory() {
                ui.label(format!("{:.1} MB held by the light", bytes as f64 / 1e6));
            }
        });
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
        let found = self.lit.find(self.subject.cells(), &self.settings, self.shown);
        match found {
            Ok(()) => {
                self.unlit = None;
                self.lit.draw(ui, view.place);
            }
            Err(why) => self.give_up(ui.ctx(), &why),
        }
        let asks = self.subject.has_meter();
        let looked = self.probe.look(&self.lit, self.subject.cells(), pointer.at, asks);
        self.say(looked.map(|()| None));
        let saved = self.saving.go_on(&self.lit, self.shown.display, &self.name);
        self.say(saved);
        if let (Subject::World(playing), Some(light)) = (&self.subject, self.probe.light())
            && let Some(lit) = playing.world.lit(light)
        {
            meter(ui, view.place, lit);
        }
        self.timings.push(self.lit.stages(), passed);
        if let (Some(at), Subject::Canvas(_)) = (pointer.at, &self.subject) {
            let scale = view.place.width() / self.subject.size()[0] as f32;
            let stroke = Stroke::new(1.0, Color32::from_white_alpha(140));
            ui.painter().circle_stroke(view.to_window(at), self.tools.radius * scale, stroke);
        }
        self.view = Some(view);
    }

    /// Says why there is no light; where it is the GPU that cannot, the CPU goes on.
    fn give_up(&mut self, context: &Context, why: &anyhow::Error) {
        use lamplight_wgpu::Error::{Device, TooLarge};
        self.unlit = Some(format!("{why:#}"));
        if matches!(why.downcast_ref(), Some(Device(_) | TooLarge { .. }))
            && let Ok(lit) = Lit::on_cpu(context, &self.settings)
        {
            self.message = Some(format!("{why:#}; the CPU goes on"));
            self.lit = lit;
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
                    let begun = self.saving.begin(kind, &self.lit, &self.subject, &self.name);
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
                let mut table: SettingsTable =
                    serde_json::from_value(serde_json::to_value(&self.settings)?)?;
                table.set_from_text(&text)?;
                self.settings = table.resolve()?;
            }
            Line::Move([x, y]) => {
                let view = self.view.as_ref().context("there is no picture yet")?;
                self.played.push(Event::PointerMoved(view.to_window([x, y])));
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
                let begun = self.saving.begin(kind, &self.lit, &self.subject, &self.name);
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
