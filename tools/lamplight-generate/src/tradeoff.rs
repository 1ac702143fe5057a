//! Error against time of `holographic` for settings between and beyond its presets.

use crate::generated::root;
use crate::lone_lamps;
use anyhow::{Result, ensure};
use lamplight::settings::Holographic;
use lamplight::{Bounces, Cells, Rgb, Scene, Settings, Solver};
use lamplight_truth::scenes::open_cells;
use lamplight_truth::{Measures, PathTracer};
use std::fmt::Write;

/// The size of the grid that is timed.
pub const SIZE: &str = "512x512";

/// `lattice_spacing`, `gather_level`, `gather_length`, `gather_rays` and `bundle_rays` of each row.
const ROWS: [[u32; 5]; 17] = [
    [4, 2, 1, 2, 8],
    [4, 3, 2, 3, 8],
    [2, 2, 1, 2, 8],
    [2, 3, 2, 3, 8],
    [1, 1, 1, 1, 4],
    [1, 1, 1, 3, 8],
    [1, 1, 2, 3, 8],
    [1, 2, 1, 1, 4],
    [1, 2, 2, 1, 8],
    [1, 2, 2, 3, 8],
    [1, 2, 4, 3, 8],
    [1, 3, 2, 3, 8],
    [1, 3, 4, 3, 12],
    [1, 3, 8, 3, 12],
    [1, 4, 2, 2, 8],
    [1, 4, 6, 2, 12],
    [1, 4, 15, 4, 16],
];

/// Scenes whose error is measured, by direct light at some open cells.
const SCENES: [&str; 2] = ["grove", "dungeon"];
const CELLS: usize = 2000;
const PATHS: u32 = 16_384;

/// A scene and its light as the path tracer finds it.
struct Judged {
    cells: Cells,
    at: Vec<[u32; 2]>,
    truth: Vec<Rgb>,
}

impl Judged {
    fn new(name: &str) -> Result<Self> {
        println!("trace {name}");
        let cells = Scene::load(root().join(format!("scenes/{name}.toml")))?.cells()?;
        let at = open_cells(&cells, CELLS, 1);
        let tracer = PathTracer {
            samples: PATHS,
            bounces: Bounces::Count(0),
            wall_depth: 0.0,
            elevation: Settings::ELEVATION,
            seed: 1,
        };
        let truth = tracer.at(&cells, &at)?.into_iter().map(|(light, _)| light).collect();
        Ok(Self { cells, at, truth })
    }

    /// The relative RMSE of settings.
    fn error(&self, settings: Holographic) -> Result<f64> {
        let mut solver = Solver::new(Settings::direct(settings))?;
        let light = solver.solve(&self.cells)?;
        let seen: Vec<Rgb> = self.at.iter().map(|&[x, y]| light.at(x, y)).collect();
        Ok(Measures::of(&seen, &self.truth, &vec![false; seen.len()]).relative_rmse)
    }
}

/// The table. `times_faster` times settings in the form of a flag against the yardstick.
pub fn table(times_faster: impl Fn(&str) -> Result<f64>) -> Result<String> {
    let judged = SCENES.map(Judged::new).into_iter().collect::<Result<Vec<_>>>()?;
    let mut table = String::from(
        "| `lattice_spacing` | `gather_level` | `gather_length` | `gather_rays` | `bundle_rays` | preset |",
    );
    SCENES.iter().for_each(|name| table += &format!(" {name} |"));
    table += " ripple | worst place | times faster |\n";
    table += &format!("| {}--- |\n", "--- | ".repeat(8 + SCENES.len()));
    for row @ [lattice_spacing, gather_level, gather_length, gather_rays, bundle_rays] in ROWS {
        println!("holographic {row:?}");
        let settings = Holographic {
            lattice_spacing,
            gather_level,
            gather_length,
            gather_rays,
            bundle_rays,
            ..Holographic::default()
        };
        let same = |name: &&&str| Holographic::preset(name).as_ref() == Some(&settings);
        let preset = Holographic::PRESETS.iter().find(same).copied().unwrap_or_default();
        row.iter().try_for_each(|value| write!(table, "| {value} "))?;
        write!(table, "| {preset} |")?;
        for scene in &judged {
            write!(table, " {:.1} % |", 100.0 * scene.error(settings.clone())?)?;
        }
        let ripple = lone_lamps::worst(settings.clone())?;
        let flag = format!(
            "holographic={{ lattice_spacing = {lattice_spacing}, gather_level = {gather_level}, \
             gather_length = {gather_length}, gather_rays = {gather_rays}, bundle_rays = {bundle_rays} }}"
        );
        let faster = times_faster(&flag)?;
        let [rms, worst] = [ripple.rms, ripple.worst].map(|part| 100.0 * part);
        writeln!(table, " {rms:.2} % | {worst:.1} % | {faster:.2} |")?;
    }
    let presets = ["default", "fast", "coarse", "high"];
    let have_rows = presets.iter().all(|name| table.contains(&format!("| {name} |")));
    ensure!(have_rows, "every preset has a row");
    writeln!(
        table,
        "\nRelative RMSE of direct light at {CELLS} open cells against {PATHS} paths each. {}. `times faster` is \
         for {} cells, as above.",
        lone_lamps::caption(),
        SIZE.replace('x', "×")
    )?;
    Ok(table)
}
