//! Execution of scripts.

use super::App;
use super::shot::Shot;
use crate::message::message;
use crate::platform::{self, Dropped};
use crate::window::script::{Line, Script};
use crate::window::subject::Subject;
use anyhow::{Context as _, Result};
use eframe::egui::{Context, Event, Modifiers, PointerButton, ViewportCommand};
use lamplight::{Settings, SettingsTable};

/// The largest width and height that a script may set, points.
const MAX_POINTS: f32 = 4096.0;

impl App {
    /// Executes the next line of the script.
    pub(super) fn follow(&mut self, context: &Context) {
        // A screenshot shows the next frame, and the script waits for it.
        if self.shot.is_some() {
            return;
        }
        // What is being saved would be lost.
        if let Some(over) =
            self.script.take_if(|script| script.is_over() && !self.saving.is_waiting())
            && over.closes
        {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
        if self.script.is_none()
            && let Some(text) = platform::next_script()
        {
            self.script = Script::read(&text, false).map_err(|why| self.say(Err(why))).ok();
        }
        let Some(line) = self.script.as_mut().and_then(Script::next) else { return };
        if let Err(why) = self.obey(context, line) {
            self.message = Some(message(&why));
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
                let mut over = SettingsTable::default();
                over.set_from_text(&text)?;
                self.halves.edited().set(over)?;
            }
            Line::Move([x, y]) => {
                let view = self.view.as_ref().context("there is no picture yet")?;
                self.played.push(Event::PointerMoved(view.to_window([x, y])));
            }
            Line::View(view, inside) => {
                (self.inspector.view, self.inspector.inside) = (view, inside);
            }
            Line::Benchmark => self.begin_benchmark(),
            Line::Lose => self.gpu.lose(),
            Line::Size(size) => {
                let size = size.map(|side| side.clamp(1.0, MAX_POINTS));
                context.send_viewport_cmd(ViewportCommand::InnerSize(size.into()));
            }
            Line::Table => platform::say(self.benchmark.markdown().trim_end()),
            Line::Relief(is_on) => self.relief.is_on = is_on,
            Line::Factor(factor) => self.resolution.choose(factor),
            Line::Split(method) => {
                let settings = self.halves.left.settings.clone();
                self.halves.split(Settings { method: method.into(), ..settings })?;
            }
            Line::Press => self.played.push(button(true, there)),
            Line::Release => self.played.push(button(false, there)),
            Line::Clear => {
                if let Subject::Canvas(canvas) = &mut self.subject {
                    self.tools.clear(canvas);
                }
            }
            Line::Lamp => self.tools.choose_lamp(),
            Line::Drop(path) => self.inbox.receive(Dropped { path, bytes: None, is_layer: false }),
            Line::Warn(said) => {
                // Keeps the previous message.
                let before = self.message.take().map(|before| format!(" ({before})"));
                self.message = Some(said + &before.unwrap_or_default());
            }
            Line::Say(word) => platform::say(&word),
            Line::Tell => {
                let message = self.message.as_ref().or(self.unlit.as_ref());
                platform::say(message.map_or("all is well", String::as_str));
            }
            Line::Place => {
                let place = self.view.as_ref().context("there is no picture yet")?.place;
                let [x, y, w, h] = [place.min.x, place.min.y, place.width(), place.height()];
                platform::say(&format!("{x} {y} {w} {h}"));
            }
            Line::Save(kind) => {
                let begun = self.save(kind);
                self.say(begun);
            }
            Line::Shot(path) => self.shot = Some(Shot::request(context, path)),
        }
        Ok(())
    }

    /// Saves the screenshot if it has arrived.
    pub(super) fn take_shot(&mut self) -> Result<()> {
        let Some(saved) = self.shot.as_ref().and_then(Shot::save_if_ready) else { return Ok(()) };
        self.shot = None;
        saved
    }
}
