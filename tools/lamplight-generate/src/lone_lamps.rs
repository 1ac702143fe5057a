//! The ripple of the light of lone lamps, by method and preset.

use anyhow::{Context, Result};
use lamplight::settings::MethodSettings;
use lamplight::{Cells, Lamp, Method, Settings, Solver};
use lamplight_truth::grain::{FAR, Residue, ripple};
use std::fmt::Write;

/// Positions and radii of lone lamps in a room of [`ROOM`] cells.
const LONE: [([f32; 2], f32); 4] =
    [([60.5, 90.5], 2.0), ([100.3, 60.8], 1.5), ([160.0, 40.0], 2.5), ([33.7, 141.2], 3.0)];
const ROOM: [u32; 2] = [320, 180];

/// Returns the largest ripple of several lamps.
pub fn worst(settings: impl Into<MethodSettings>) -> Result<Residue> {
    let mut solver = Solver::new(Settings::new(settings))?;
    let mut most = Residue::default();
    for (position, size) in LONE {
        let mut cells = Cells::new(ROOM[0], ROOM[1])?;
        cells.lamps_mut().push(Lamp { position, size, ..Lamp::default() });
        let found = ripple(solver.solve(&cells)?, position, size.into());
        (most.rms, most.worst) = (most.rms.max(found.rms), most.worst.max(found.worst));
    }
    Ok(most)
}

/// The table of the methods without noise, by preset.
pub fn table() -> Result<String> {
    let mut table =
        String::from("| method | preset | ripple | worst place |\n| --- | --- | --- | --- |\n");
    for method in [Method::Cascades, Method::Holographic] {
        for &preset in method.presets() {
            println!("ripple {} {preset}", method.name());
            let found = worst(MethodSettings::preset(method, preset).context("a preset")?)?;
            let [rms, worst] = [found.rms, found.worst].map(|part| 100.0 * part);
            writeln!(table, "| {} | {preset} | {rms:.2} % | {worst:.1} % |", method.name())?;
        }
    }
    writeln!(table, "\n{}.", caption())?;
    Ok(table)
}

/// Explains the figures.
pub fn caption() -> String {
    let sizes = LONE.map(|(_, size)| size.to_string()).join(", ");
    format!(
        "Root mean square, and the worst place, over {}×{} cells farther than {FAR} px from the lamp; the worst of \
         four lamps of radius {sizes} px at different places",
        ROOM[0], ROOM[1]
    )
}
