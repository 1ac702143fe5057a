//! What was measured, as a document.

use crate::contender::{Contender, locked_version};
use crate::headless::Adapter;
use crate::race::{Counts, Entry, Outcome};
use crate::scene::{RANGE, SIDE, Scene};
use serde::Serialize;
use std::fmt::Write;

/// All of a run.
#[derive(Serialize)]
pub struct Report {
    pub bevy: &'static str,
    pub adapter: Adapter,
    /// Of the CPU that the adapter may be, too.
    pub threads: usize,
    pub target: [u32; 2],
    /// Most frames measured of each.
    pub frames: usize,
    pub lamps: Table,
    pub occluders: Table,
}

/// One scene after the other, with more and more of something.
#[derive(Serialize)]
pub struct Table(pub Vec<Column>);

/// A scene.
#[derive(Serialize)]
pub struct Column {
    pub counts: Counts,
    pub entries: Vec<Entry>,
}

impl Report {
    /// The release of Bevy that everything is built with.
    pub fn bevy() -> &'static str {
        locked_version("bevy")
    }

    /// A Markdown document.
    pub fn markdown(&self) -> String {
        let Self { bevy, adapter, threads, target: [width, height], frames, .. } = self;
        let Adapter { name, driver, backend, kind } = adapter;
        let build = if cfg!(debug_assertions) { ", with debug assertions" } else { "" };
        let few =
            |table: &Table, of: fn(&Counts) -> u32| table.0.first().map_or(0, |c| of(&c.counts));
        let few_occluders = few(&self.lamps, |counts| counts.occluders);
        let few_lamps = few(&self.occluders, |counts| counts.lamps);
        let lamps = |cell| self.lamps.markdown("lamps", |counts| counts.lamps, cell);
        let occluders =
            |cell| self.occluders.markdown("occluders", |counts| counts.occluders, cell);
        let mut text = format!(
            "\
# Lights for Bevy, side by side

Frame times of `bevy_lamplight` and of the other 2D light plugins published for the same release of
Bevy. Everything here but the words is measured, in one run:
`cargo run --profile bench -p bevy_lamplight_bench -- -o docs/bevy-performance.md`.

- Adapter: {name} ({kind}, {backend}, {driver}); {threads} threads of a CPU.
- Target: {width}×{height}, no window, no multisampling. Bevy {bevy}{build}.
- Scene: one white sprite as the ground; lamps that reach {RANGE:.0} world units (pixels); occluders of
  {SIDE:.0}×{SIDE:.0}. Places are random but fixed, and nothing moves. Settings as each plugin comes, lamps with
  shadows.
- Times: median of up to {frames} frames in ms, of one where they are slow, from the begin of a frame until the
  GPU has done all of it. In brackets until its commands are complete: the part of the CPU. Contenders
  take turns, a frame each. Where frames take seconds there is one, after a long wait: its brackets are
  larger than those of frames that follow each other.

## Lamps

With {few_occluders} occluders.

{}
## Occluders

With {few_lamps} lamps, none of them in an occluder.

{}
{}
",
            lamps(Outcome::time),
            occluders(Outcome::time),
            self.occluders.solid(),
        );
        if kind == "Cpu" {
            text += &format!(
                "\
## As work

This adapter is a CPU that plays a GPU. It says how times grow, and little about how long frames take
on a GPU: there the brackets weigh more. Other programs may take turns on the same CPU; they do not
lengthen this: the work of all threads, median in ms.

{}
{}
",
                lamps(Outcome::work),
                occluders(Outcome::work),
            );
        }
        text += "\
## What each of them draws

Times compare only what is drawn alike, and little is. From the sources of these versions:

";
        for entry in self.lamps.0.first().map_or(&[][..], |column| &column.entries) {
            if let Some(draws) = entry.contender.draws() {
                text += &format!("**{}**: {draws}\n\n", name_of(entry.contender));
            }
        }
        text += &format!(
            "\
Left out: `bevy_light_2d` from 0.11 on (Bevy 0.20) and `bevy_magic_light_2d` 0.8.1 (Bevy 0.14) do not
build with Bevy {bevy}.
"
        );
        text
    }
}

/// A crate, or what stands for none.
fn name_of(contender: Contender) -> String {
    contender.package().map_or_else(|| contender.title(), |package| format!("`{package}`"))
}

impl Table {
    /// Rows of contenders, columns of scenes.
    fn markdown(
        &self,
        what: &str,
        count: fn(&Counts) -> u32,
        cell: fn(&Outcome) -> String,
    ) -> String {
        let mut text = String::from("| ms |");
        for column in &self.0 {
            let _ = write!(text, " {} {what} |", count(&column.counts));
        }
        let _ = write!(text, "\n| --- |{}\n", " ---: |".repeat(self.0.len()));
        for (row, entry) in
            self.0.first().map_or(&[][..], |column| &column.entries).iter().enumerate()
        {
            let _ = write!(text, "| {} |", entry.contender.title());
            for column in &self.0 {
                let _ = write!(text, " {} |", cell(&column.entries[row].outcome));
            }
            text.push('\n');
        }
        text
    }

    /// How much of the view is occluders, scene by scene.
    fn solid(&self) -> String {
        let shares = self.0.iter().map(|Column { counts: Counts { lamps, occluders }, .. }| {
            let share = 100.0 * Scene::new(*lamps, *occluders).solid();
            format!("{share:.0} % at {occluders}")
        });
        let shares: Vec<_> = shares.collect();
        format!("Occluders overlap; of the view they cover {}.\n", shares.join(", "))
    }
}
