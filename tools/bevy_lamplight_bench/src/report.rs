//! The measurements as a document.

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
    /// Threads of the CPU, which may also be the adapter.
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
Bevy. Every figure is measured, in one run:
`cargo run --profile bench -p bevy_lamplight_bench -- -o docs/bevy-performance.md`.

- Adapter: {name} ({kind}, {backend}, {driver}); {threads} threads of a CPU.
- Target: {width}×{height}, no window, no multisampling. Bevy {bevy}{build}.
- Scene: one white sprite as the ground; lamps that reach {RANGE:.0} world units (pixels); occluders of
  {SIDE:.0}×{SIDE:.0}. Positions are random but fixed, and nothing moves. Each plugin has its default settings,
  with shadows.
- Times: median in ms of up to {frames} frames, or of one if frames are slow, from the start of a frame until the
  GPU has finished it. In brackets: until its commands are recorded, which is the CPU's part. Plugins take
  turns, one frame each. A frame that takes seconds is measured once, after a long wait; its brackets are
  larger than those of consecutive frames.

## Lamps

**`bevy_lamplight` lights a grid, so its time changes little with the number of lamps, while that of the others
grows about in proportion to it.** With {few_occluders} occluders.

{}
## Occluders

**No plugin's time grows in proportion to the number of occluders. It grows most in `bevy_light_2d`, which visits every
occluder in reach of a lamp.** With {few_lamps} lamps, none of them in an occluder.

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

**This adapter is a software GPU: the times above show how cost grows, not how long frames take on hardware**, where
the brackets weigh more. On it `bevy_lamplight` lets the CPU find the light (`LightBackend::Auto`), so its brackets
hold most of its time, where a GPU would find the light after them. The tables below count the work of all threads,
median in ms, which other programs on the same CPU do not lengthen.

{}
{}
",
                lamps(Outcome::work),
                occluders(Outcome::work),
            );
        }
        text += "\
## What each plugin draws

The plugins draw different things, so their times are not a ranking. From the sources of these versions:

";
        for entry in self.lamps.0.first().map_or(&[][..], |column| &column.entries) {
            if let Some(draws) = entry.contender.draws() {
                text += &format!("**{}**: {draws}\n\n", name_of(entry.contender));
            }
        }
        text += &format!(
            "\
Left out: `bevy_firefly` 0.19.0, `bevy_lit` 0.11.0 and `bevy_fast_light` 0.11.0-rc.3 (Bevy 0.19), and
`bevy_magic_light_2d` 0.8.1 (Bevy 0.14), which have no release for Bevy {bevy}.
"
        );
        text
    }
}

/// A crate, or a placeholder for none.
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

    /// The fraction of the view that occluders cover, scene by scene.
    fn solid(&self) -> String {
        let shares = self.0.iter().map(|Column { counts: Counts { lamps, occluders }, .. }| {
            let share = 100.0 * Scene::new(*lamps, *occluders).solid();
            format!("{share:.0} % at {occluders}")
        });
        let shares: Vec<_> = shares.collect();
        format!("Occluders overlap; of the view they cover {}.\n", shares.join(", "))
    }
}
