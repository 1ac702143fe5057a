//! What a script makes the window do.

use super::App;
use crate::platform;
use crate::window::Script;
use crate::window::script::Line;
use crate::window::subject::Subject;
use crate::window::words;
use anyhow::{Context as _, Result};
use eframe::egui::{
    Context, DroppedFile, Event, Modifiers, PointerButton, UserData, ViewportCommand,
};
use lamplight::{Settings, SettingsTable};

/// Points of the longest side that a script may give the window.
const MOST_POINTS: f32 = 4096.0;

impl App {
    /// Does what the script says next.
    pub(super) fn follow(&mut self, context: &Context) {
        // A picture of the window comes a frame later, and shows that frame.
        if !self.shots.is_empty() {
            return;
        }
        if let Some(over) = self.script.take_if(|script| script.is_over())
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
            self.message = Some(words(&why));
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
                // A preset takes the place of all that it sets.
                let mut over = SettingsTable::default();
                over.set_from_text(&text)?;
                table.merge(over);
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
            Line::Lose => self.gpu.lose(),
            Line::Size(size) => {
                let size = size.map(|side| side.clamp(1.0, MOST_POINTS));
                context.send_viewport_cmd(ViewportCommand::InnerSize(size.into()));
            }
            Line::Table => print!("{}", self.benchmark.markdown()),
            Line::Factor(factor) => self.resolution.choose(factor),
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
            Line::Warn(said) => {
                // Beside what went wrong before.
                let before = self.message.take().map(|before| format!(" ({before})"));
                self.message = Some(said + &before.unwrap_or_default());
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
                let begun = self.save(kind);
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
    pub(super) fn take_shots(&mut self, context: &Context) -> Result<()> {
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
