//! The content of the window, frame by frame.

mod follow;
mod picture;
mod shot;

use shot::Shot;

use crate::message::message;
use crate::platform::{self, CELLS};
use crate::window::benchmark::Benchmark;
use crate::window::files::{Inbox, Opened, layers};
use crate::window::folded::{Folded, Side};
use crate::window::fonts::fonts;
use crate::window::former::Former;
use crate::window::gpu_loss::{GpuGuard, handover};
use crate::window::halves::{Half, Halves};
use crate::window::inspect::{Inspector, PictureView};
use crate::window::light::{self, Backend, Lit, Shown};
use crate::window::panels::timings::Timings;
use crate::window::panels::tools::Tools;
use crate::window::panels::{settings, settings::Panel, view};
use crate::window::probe::Probe;
use crate::window::relief::Relief;
use crate::window::resolution::Resolution;
use crate::window::saving::{SaveKind, Saving};
use crate::window::script::Script;
use crate::window::start::Start;
use crate::window::subject::{Choice, Subject};
use crate::window::view::PictureFrame;
use anyhow::{Result, ensure};
use eframe::CreationContext;
use eframe::egui::{
    self, Button, CentralPanel, CollapsingHeader, Color32, Context, Event, Frame, Key,
    KeyboardShortcut, Label, Modifiers, RawInput, RichText, ScrollArea, TextEdit, Theme, Ui,
};
use lamplight::Settings;
use lamplight_sandbox::look::Look;

/// The state of the window.
pub struct App {
    choice: Choice,
    subject: Subject,
    former: Former,
    size: [u32; 2],
    seed: u64,
    backend: Backend,
    gpu: GpuGuard,
    halves: Halves,
    resolution: Resolution,
    benchmark: Benchmark,
    inspector: Inspector,
    shown: Shown,
    relief: Relief,
    /// True if cells are drawn as a whole number of pixels.
    whole: bool,
    probe: Probe,
    tools: Tools,
    panel: Panel,
    folded: Folded,
    timings: Timings,
    /// The message that the user has to confirm.
    message: Option<String>,
    /// The error because of which there is no light.
    unlit: Option<String>,
    saving: Saving,
    /// The name of saved files.
    name: String,
    script: Option<Script>,
    /// Events of the script for the next frame.
    played: Vec<Event>,
    inbox: Inbox,
    /// The picture in the last frame, for scripts.
    view: Option<PictureFrame>,
    shot: Option<Shot>,
}

impl App {
    pub fn new(context: &CreationContext, start: &Start, script: Option<Script>) -> Result<Self> {
        context.egui_ctx.set_fonts(fonts());
        // Light is easier to judge on a dark background.
        context.egui_ctx.set_theme(Theme::Dark);
        let gpu = light::gpu(context, start.backend);
        let cells = if gpu.is_some() { CELLS } else { platform::CELLS_ON_CPU };
        let size = start.size.unwrap_or(cells);
        let subject = Subject::new(start.world, size, start.seed)?;
        let look = subject.look();
        let mut settings = look.settings();
        let lit = Lit::new(&context.egui_ctx, gpu, start.backend, &settings)?;
        if !lit.is_gpu() {
            // The default preset is too slow on the CPU.
            settings.set_quality(lamplight::Quality::Fast)?;
        }
        Ok(Self {
            choice: start.world,
            probe: Probe::default(),
            subject,
            former: Former::default(),
            size,
            seed: start.seed,
            backend: start.backend,
            gpu: GpuGuard::new(context),
            halves: Halves::new(settings, lit),
            // Scripts are deterministic.
            resolution: Resolution::new(script.as_ref().is_none_or(|script| !script.closes))?,
            benchmark: Benchmark::default(),
            inspector: Inspector::new(&context.egui_ctx),
            shown: Shown { display: look.display, ..Shown::default() },
            relief: Relief::new()?,
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
            inbox: Inbox::default(),
            view: None,
            shot: None,
        })
    }

    /// Switches to another subject and its look. The method stays. From a world, Paint leads back to the canvas.
    fn choose(&mut self, choice: Choice) {
        let from_world = matches!(self.subject, Subject::World(_));
        let back = if choice == Choice::Paint && from_world { self.former.take() } else { None };
        let next = match back {
            Some(canvas) => Ok(Subject::Canvas(canvas)),
            None => Subject::new(choice, self.size, self.seed),
        };
        match next {
            Ok(subject) if from_world && choice == self.choice => {
                // It begins anew, with the tool and the look that are in use.
                self.subject = subject;
                self.tools.let_go();
            }
            Ok(subject) => {
                self.choice = choice;
                self.replace(subject);
            }
            Err(why) => self.message = Some(why.to_string()),
        }
    }

    /// Replaces the subject and its look. A canvas is set aside.
    fn replace(&mut self, subject: Subject) {
        let is_canvas = matches!(subject, Subject::Canvas(_));
        let look = Look::of(&self.halves.left.settings, self.shown.display);
        let before = std::mem::replace(&mut self.subject, subject);
        if self.former.keep(before, look) && is_canvas {
            self.message = Some("Undo brings the former canvas back".into());
        }
        self.tools.reset();
        self.take_look();
    }

    /// Undoes the last edit of the canvas, or its replacement by one that has no edits.
    fn undo(&mut self) {
        let Subject::Canvas(canvas) = &mut self.subject else { return };
        // A stroke that is still being drawn is an edit, too.
        canvas.end();
        if !self.former.precedes(canvas) {
            return self.tools.undo(canvas);
        }
        if let Some(former) = self.former.take() {
            self.subject = Subject::Canvas(former);
            self.message = None;
            self.tools.reset();
            self.take_look();
        }
    }

    /// Applies the look of the subject.
    fn take_look(&mut self) {
        let look = self.subject.look();
        let asked = look.settings();
        for half in self.halves.each() {
            half.settings.bounces = asked.bounces;
            half.settings.wall_depth = asked.wall_depth;
            half.settings.elevation = asked.elevation;
        }
        self.shown.display = look.display;
    }

    /// The bar at the top.
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
        let fps = self.timings.frames_per_second();
        ui.label(format!("{}{fps:.0} frames per second", light.unwrap_or_default()));
        ui.label(self.probe.words(w))
            .on_hover_text("Light at the pointer: linear red, green, blue");
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
        let half = self.halves.edited();
        let method = self.panel.method(ui, half.settings.method());
        if let Err(why) = half.choose(method) {
            self.message = Some(why.to_string());
        }
        self.panel.show(ui, &mut half.settings);
        CollapsingHeader::new("Picture").default_open(true).show(ui, |ui| {
            settings::display(ui, &mut self.shown.display);
            let has_normals = self.subject.cells().normals().is_some();
            let relief = has_normals.then_some(&mut self.relief.is_on);
            view::picture(ui, &mut self.shown.smooth, &mut self.whole, relief);
        });
        CollapsingHeader::new("Save").default_open(true).show(ui, |ui| self.files(ui));
        CollapsingHeader::new("Times").default_open(true).show(ui, |ui| {
            let words = "Runs every method and preset on the current scene";
            if ui.button("Benchmark").on_hover_text(words).clicked() {
                self.begin_benchmark();
            }
            self.timings.show(ui);
            if let Some(bytes) = self.halves.memory() {
                ui.label(format!("{:.1} MB of GPU memory for light", bytes as f64 / 1e6));
            }
        });
    }

    fn begin_benchmark(&mut self) {
        let subject = self.benchmark_subject();
        self.benchmark.begin(&self.halves.left.settings, subject);
    }

    /// A description of what the benchmark measures.
    fn benchmark_subject(&self) -> String {
        let cells = self.resolution.cells(self.subject.cells());
        let (w, h) = (cells.width(), cells.height());
        let (what, place) = (self.choice.name(), self.halves.left.lit.place());
        format!("{w}×{h} cells of {what} on {place}")
    }

    /// Restarts at another size. A canvas with edits stays.
    fn resize(&mut self, size: [u32; 2]) {
        if let Subject::Canvas(canvas) = &self.subject
            && canvas.history_depth() != [0, 0]
        {
            self.message = Some(
                "a new size clears the canvas: save it, then choose Paint for a new one".into(),
            );
            return;
        }
        self.size = size;
        self.choose(self.choice);
    }

    fn tools(&mut self, ui: &mut Ui) {
        match &mut self.subject {
            Subject::Canvas(canvas) => {
                let has_former = self.former.precedes(canvas);
                if self.tools.show_canvas(ui, canvas, has_former) {
                    self.undo();
                }
            }
            Subject::World(playing) => self.tools.show_world(ui, playing.world.brushes()),
        }
    }

    /// Opens files that were dropped on the window.
    fn take_files(&mut self, context: &Context) {
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        let is_layer = layers(&dropped, |file| file.path());
        for (file, is_layer) in dropped.into_iter().zip(is_layer) {
            // In a folder, a scene finds its images itself.
            if !(is_layer && platform::HAS_FOLDERS) {
                platform::read_dropped(file, is_layer, self.inbox.sender());
            }
        }
        while let Some(file) = self.inbox.next() {
            let kind = self.tools.image();
            let opened =
                file.and_then(|file| self.inbox.open(file, context.time(), kind, &self.subject));
            match opened {
                // The scene that it belongs to has not arrived.
                Ok(None) => {}
                Ok(Some(Opened { canvas, is_scene, said })) => {
                    (self.choice, self.message) = (Choice::Paint, said);
                    let canvas = Subject::Canvas(canvas);
                    match self.subject {
                        // A picture on a canvas is an edit, and keeps the look.
                        Subject::Canvas(_) if !is_scene => {
                            self.subject = canvas;
                            self.tools.reset();
                        }
                        _ => self.replace(canvas),
                    }
                }
                Err(why) => self.message = Some(message(&why)),
            }
        }
    }

    /// The messages at the bottom.
    fn messages(&mut self, ui: &mut Ui) {
        let color = ui.visuals().warn_fg_color;
        if let Some(unlit) = &self.unlit {
            ui.colored_label(color, unlit);
        }
        if let Some(message) = &self.message {
            // The button comes first because the message may take several lines.
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

    /// The controls that save files.
    fn files(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label("Name");
            ui.add(TextEdit::singleline(&mut self.name).desired_width(120.0));
        });
        ui.horizontal(|ui| {
            for kind in SaveKind::ALL {
                let can = kind != SaveKind::Scene || matches!(self.subject, Subject::Canvas(_));
                let button = ui.add_enabled(can, Button::new(kind.name()));
                if button.on_hover_text(kind.words()).clicked() {
                    let begun = self.save(kind);
                    self.say(begun);
                }
            }
        });
    }

    /// Saves a file, or requests the light for it. Returns a message.
    fn save(&mut self, kind: SaveKind) -> Result<Option<String>> {
        let Half { settings, lit, .. } = &mut self.halves.left;
        if kind == SaveKind::Scene {
            let files = self.subject.scene(settings, self.shown.display, &self.name)?;
            ensure!(!files.is_empty(), "only a canvas is saved as a scene");
            return platform::save(&files).map(Some);
        }
        // At full size in every view.
        let cells = self.relief.shown(self.subject.cells(), false);
        if self.resolution.factor == 1 && self.inspector.view == PictureView::Picture {
            lit.find(cells, cells, settings, self.shown)?;
            self.saving.begin(kind, lit, cells)?;
        } else {
            // The window has not lit these cells, over whose frames light would grow.
            let bounces = settings.bounces.within_a_frame();
            let settings = &Settings { bounces, ..settings.clone() };
            let mut lit = lit.beside(settings)?;
            lit.find(cells, cells, settings, self.shown)?;
            self.saving.begin(kind, &lit, cells)?;
        }
        Ok(None)
    }

    /// Opens another window, which continues where this one is.
    fn reopen(&mut self) -> Result<()> {
        let begins = (self.choice, self.size, self.seed, self.backend);
        let settings = &self.halves.left.settings;
        let mut next =
            handover(begins, &mut self.subject, &self.former, settings, self.shown.display)?;
        let closes = self.script.as_ref().is_some_and(|script| script.closes);
        next.lines.extend(self.script.iter().flat_map(Script::rest).map(str::to_owned));
        platform::hand_over(&next, closes)
    }

    /// Shows a message or an error.
    pub fn say(&mut self, said: Result<Option<String>>) {
        match said {
            Ok(None) => {}
            Ok(said) => self.message = said,
            Err(why) => self.message = Some(message(&why)),
        }
    }

    /// Keyboard shortcuts.
    fn keys(&mut self, context: &Context) {
        // In a text field, the shortcuts edit the text.
        if context.egui_wants_keyboard_input() {
            return;
        }
        let Subject::Canvas(canvas) = &mut self.subject else { return };
        let is_pressed = |modifiers, key| {
            context
                .input_mut(|input| input.consume_shortcut(&KeyboardShortcut::new(modifiers, key)))
        };
        // The longer shortcut comes first, because it contains the other one.
        if is_pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
            || is_pressed(Modifiers::COMMAND, Key::Y)
        {
            self.tools.redo(canvas);
        } else if is_pressed(Modifiers::COMMAND, Key::Z) {
            self.undo();
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        if let Err(why) = self.take_shot() {
            self.message = Some(message(&why));
        }
        self.take_files(&context);
        self.keys(&context);
        self.follow(&context);
        if self.gpu.take_loss()
            && let Err(why) = self.reopen()
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
        // Worlds and light move every frame.
        context.request_repaint();
    }

    fn raw_input_hook(&mut self, _: &Context, input: &mut RawInput) {
        input.events.append(&mut self.played);
    }
}
