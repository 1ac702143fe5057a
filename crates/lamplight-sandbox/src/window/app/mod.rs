//! The window's content, frame by frame.

mod follow;
mod picture;

use super::{CELLS, Script, Start};
use crate::platform;
use crate::window::anew::{Anew, Guard};
use crate::window::benchmark::Benchmark;
use crate::window::files::Inbox;
use crate::window::folded::{Folded, Side};
use crate::window::fonts::fonts;
use crate::window::halves::{Half, Halves};
use crate::window::inspect::Inspector;
use crate::window::light::{self, Backend, Lit, Shown};
use crate::window::panels::timings::Timings;
use crate::window::panels::tools::Tools;
use crate::window::panels::{settings, settings::Panel, view};
use crate::window::probe::Probe;
use crate::window::resolution::Resolution;
use crate::window::saving::{Kind, Saving};
use crate::window::subject::{Choice, Subject};
use crate::window::view::View;
use crate::window::words;
use anyhow::Result;
use eframe::CreationContext;
use eframe::egui::{
    self, Button, CentralPanel, CollapsingHeader, Color32, Context, DroppedFile, Event, Frame, Key,
    KeyboardShortcut, Label, Modifiers, RawInput, RichText, ScrollArea, TextEdit, Theme, Ui,
};
use lamplight::settings::Holographic;
use std::path::PathBuf;

/// Everything there is.
pub struct App {
    choice: Choice,
    subject: Subject,
    size: [u32; 2],
    seed: u64,
    backend: Backend,
    gpu: Guard,
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
            backend: start.backend,
            gpu: Guard::new(context),
            halves: Halves::new(settings, lit),
            // A script is the same on every machine.
            resolution: Resolution::new(script.as_ref().is_none_or(|script| !script.closes))?,
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
                (self.choice, self.subject) = (choice, subject);
                self.tools.let_all_go();
                self.take_look();
            }
            Err(why) => self.message = Some(why.to_string()),
        }
    }

    /// Lights and shows what is on as it asks to be.
    fn take_look(&mut self) {
        let look = self.subject.look();
        let asked = look.settings();
        for half in self.halves.each() {
            half.settings.bounces = asked.bounces;
            half.settings.wall_depth = asked.wall_depth;
        }
        self.shown.display = look.display;
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
        let light =
            self.timings.light().map(|seconds| format!("{:.1} ms of light, ", 1e3 * seconds));
        let fps = self.timings.frames_a_second();
        ui.label(format!("{}{fps:.0} frames a second", light.unwrap_or_default()));
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
        let subject = self.what_is_timed();
        self.benchmark.begin(&self.halves.left.settings, subject);
    }

    /// What a benchmark is of.
    fn what_is_timed(&self) -> String {
        let cells = self.resolution.cells(self.subject.cells());
        let (w, h) = (cells.width(), cells.height());
        let (what, place) = (self.choice.name(), self.halves.left.lit.place());
        format!("{w}×{h} cells of {what} on {place}")
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

    /// Takes files that were dropped on the window.
    fn take_files(&mut self, context: &Context) {
        for file in context.input(|input| input.raw.dropped_files.clone()) {
            let (kind, before) = (self.tools.image(), self.subject.look());
            match self.inbox.take(file, context.time(), kind, &mut self.subject) {
                Ok(said) => {
                    self.choice = Choice::Paint;
                    self.tools.let_all_go();
                    // What a picture is laid on stays as it is lit.
                    if self.subject.look() != before {
                        self.take_look();
                    }
                    self.message = said;
                }
                Err(why) => self.message = Some(words(&why)),
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
            // The button first: words may take several lines.
            let read = ui.horizontal(|ui| {
                let read = ui.button("OK").clicked();
                ui.add(Label::new(RichText::new(message).color(color)).wrap());
                read
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
                    let begun = self.save(kind);
                    self.say(begun);
                }
            }
        });
    }

    /// Begins to save; says what there is to say.
    fn save(&mut self, kind: Kind) -> Result<Option<String>> {
        let Half { settings, lit, .. } = &mut self.halves.left;
        if let (Kind::Scene, Subject::Canvas(_)) = (kind, &self.subject) {
            let files = self.subject.scene(settings, self.shown.display, &self.name)?;
            return platform::save(&files).map(Some);
        }
        // At full size, whatever is in view.
        let cells = self.subject.cells();
        lit.find(cells, cells, settings, self.shown)?;
        self.saving.begin(kind, lit, cells)?;
        Ok(None)
    }

    /// Opens another window, which goes on where this one is.
    fn go_on_anew(&mut self) -> Result<()> {
        let begins = (self.choice, self.size, self.seed, self.backend);
        let settings = &self.halves.left.settings;
        let mut anew = Anew::new(begins, &mut self.subject, settings, self.shown.display)?;
        let closes = self.script.as_ref().is_some_and(|script| script.closes);
        anew.lines.extend(self.script.iter().flat_map(Script::rest).map(str::to_owned));
        platform::go_on_anew(&anew, closes)
    }

    /// Keeps what there is to say, and what went wrong, to be read.
    pub fn say(&mut self, said: Result<Option<String>>) {
        match said {
            Ok(None) => {}
            Ok(said) => self.message = said,
            Err(why) => self.message = Some(words(&why)),
        }
    }

    /// Keys that work everywhere.
    fn keys(&mut self, context: &Context) {
        // Who types a name takes back what was typed.
        if context.egui_wants_keyboard_input() {
            return;
        }
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
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        if let Err(why) = self.take_shots(&context) {
            self.message = Some(words(&why));
        }
        self.take_files(&context);
        self.keys(&context);
        self.follow(&context);
        if self.gpu.take_loss()
            && let Err(why) = self.go_on_anew()
        {
            self.say(Err(why.context("the GPU was lost")));
        }
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
