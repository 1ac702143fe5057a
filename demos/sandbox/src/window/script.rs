//! Scripts: input from a file instead of mouse and keys, for tests and pictures.

use crate::window::inspect::PictureView;
use crate::window::saving::SaveKind;
use crate::window::subject::Choice;
use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use lamplight::Method;
use lamplight::resample::MAX_FACTOR;
use std::collections::VecDeque;
use std::path::PathBuf;

/// One line of a script.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// Waits for this many frames.
    Frames(u32),
    /// Chooses the subject.
    World(Choice),
    /// Sets a setting, as `--set` of the command line does.
    Set(String),
    /// Chooses a view and the index of an intermediate result, from 0.
    View(PictureView, u32),
    /// Starts the benchmark.
    Benchmark,
    /// Destroys the GPU device, as if the driver had restarted.
    Lose,
    /// Resizes the window, in points.
    Size([f32; 2]),
    /// Prints the benchmark's table.
    Table,
    /// Sets the size of cells of light, in cells.
    Factor(u32),
    /// Splits the picture, with this method on the right.
    Split(Method),
    /// Switches relief on or off.
    Relief(bool),
    /// Moves the pointer to a position in the picture, in cells.
    Move([f32; 2]),
    Press,
    Release,
    /// Clears the canvas.
    Clear,
    /// Chooses lamps.
    Lamp,
    /// Drops a file on the window.
    Drop(PathBuf),
    /// Shows a message at the bottom of the window.
    Warn(String),
    /// Prints a word.
    Say(String),
    /// Prints the message of the window, or `all is well`.
    Tell,
    /// Prints the place of the picture in the window, in points: left, top, width, height.
    Place,
    /// Saves a file, as the button does.
    Save(SaveKind),
    /// Saves a screenshot of the window.
    Shot(PathBuf),
}

/// The remaining lines.
#[derive(Debug, Default)]
pub struct Script {
    lines: VecDeque<(Line, String)>,
    wait: u32,
    /// True if the window closes at the end.
    pub closes: bool,
}

impl Script {
    /// Parses a script. Empty lines and comments after `#` are ignored.
    pub fn read(text: &str, closes: bool) -> Result<Self> {
        let mut lines = VecDeque::new();
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.trim();
            // File names and messages may contain spaces and `#`.
            let words: Vec<_> = match line.split_once(' ') {
                Some((what @ ("drop" | "shot" | "warn"), rest)) => vec![what, rest.trim()],
                _ => line.split('#').next().unwrap_or_default().split_whitespace().collect(),
            };
            if words.is_empty() {
                continue;
            }
            let read = read(&words).with_context(|| format!("line {number}: `{line}`"))?;
            lines.push_back((read, line.to_owned()));
        }
        Ok(Self { lines, wait: 0, closes })
    }

    /// The line of this frame; `None` while the script waits.
    pub fn next(&mut self) -> Option<Line> {
        if self.wait > 0 {
            self.wait -= 1;
            return None;
        }
        let (line, _) = self.lines.pop_front()?;
        if let Line::Frames(frames) = line {
            self.wait = frames;
        }
        Some(line)
    }

    /// The text of the remaining lines.
    pub fn rest(&self) -> impl Iterator<Item = &str> {
        self.lines.iter().map(|(_, text)| text.as_str())
    }

    pub fn is_over(&self) -> bool {
        self.lines.is_empty() && self.wait == 0
    }
}

fn read(words: &[&str]) -> Result<Line> {
    Ok(match *words {
        ["frames", count] => Line::Frames(count.parse()?),
        ["world", name] => {
            Line::World(Choice::from_str(name, true).map_err(|e| anyhow::anyhow!(e))?)
        }
        ["set", text] => Line::Set(text.to_owned()),
        ["view", name] => Line::View(view(name)?, 0),
        ["view", "inside", number] => Line::View(PictureView::Inside, number.parse()?),
        ["benchmark"] => Line::Benchmark,
        ["table"] => Line::Table,
        ["lose"] => Line::Lose,
        ["size", w, h] => Line::Size([w.parse()?, h.parse()?]),
        ["factor", factor] => {
            let factor = factor.parse()?;
            ensure!((1..=MAX_FACTOR).contains(&factor), "a factor is from 1 to {MAX_FACTOR}");
            Line::Factor(factor)
        }
        ["split", name] => Line::Split(
            Method::ALL.iter().copied().find(|m| m.name() == name).context("no such method")?,
        ),
        ["relief", "on"] => Line::Relief(true),
        ["relief", "off"] => Line::Relief(false),
        ["move", x, y] => Line::Move([x.parse()?, y.parse()?]),
        ["press"] => Line::Press,
        ["release"] => Line::Release,
        ["clear"] => Line::Clear,
        ["lamp"] => Line::Lamp,
        ["drop", path] => Line::Drop(path.into()),
        ["warn", words] => Line::Warn(words.to_owned()),
        ["tell"] => Line::Tell,
        ["place"] => Line::Place,
        ["save", kind] => Line::Save(SaveKind::from_str(kind, true).map_err(anyhow::Error::msg)?),
        ["say", word] => Line::Say(word.to_owned()),
        ["shot", path] => Line::Shot(path.into()),
        _ => bail!(
            "expected one of: frames N, world NAME, set key=value, view NAME, view inside N, split METHOD, \
             factor N, relief on, relief off, benchmark, table, move X Y, press, release, lamp, clear, drop FILE, \
             save KIND, size W H, lose, warn WORDS, say WORD, tell, place, shot FILE"
        ),
    })
}

fn view(name: &str) -> Result<PictureView> {
    PictureView::ALL.into_iter().find(|view| view.name() == name).context("no such view")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_executes_one_line() {
        let mut script =
            Script::read("world sand # comment\n\nframes 2\nmove 3 4.5\npress", true).unwrap();
        assert_eq!(script.next(), Some(Line::World(Choice::Sand)));
        assert_eq!(script.next(), Some(Line::Frames(2)));
        assert_eq!([script.next(), script.next()], [None, None]);
        assert_eq!(script.next(), Some(Line::Move([3.0, 4.5])));
        assert!(!script.is_over());
        assert_eq!(script.next(), Some(Line::Press));
        assert!(script.is_over() && script.next().is_none());
    }

    #[test]
    fn file_names_may_contain_spaces_and_hashes() {
        let script = Script::read("drop /a b/t #1  /x.toml\nsay a # b\n", true).unwrap();
        let lines: Vec<_> = script.lines.iter().map(|(line, _)| line.clone()).collect();
        assert_eq!(lines, [Line::Drop("/a b/t #1  /x.toml".into()), Line::Say("a".into())]);
        // The window that continues this one parses the rest again.
        let rest = script.rest().collect::<Vec<_>>().join("\n");
        assert_eq!(Script::read(&rest, true).unwrap().lines, script.lines);
    }

    #[test]
    fn errors_name_the_line() {
        for (text, line) in
            [("frames", "line 1"), ("press\nworld moon", "line 2"), ("move 1 x", "line 1")]
        {
            let error = format!("{:#}", Script::read(text, true).unwrap_err());
            assert!(error.contains(line), "{error}");
        }
    }
}
