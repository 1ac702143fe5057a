//! `lamplight probe`: the light at points, as gameplay code asks for it.

use crate::args::{DisplayArgs, LightingArgs, Position};
use crate::error::{CliError, Result};
use crate::job::RenderJob;
use crate::output;
use crate::table::{number, table};
use lamplight::Cells;
use lamplight::srgb::luminance;
use serde_json::json;
use std::path::PathBuf;

/// Print the light at points of a scene
#[derive(clap::Args, Debug)]
pub struct ProbeArgs {
    /// The scene file (TOML or JSON), or a map (.tmx, .world, .ldtk)
    scene: PathBuf,
    /// Points in px from the top left, such as 160,90 or 40.5,30.5; the centre of the first cell is
    /// 0.5,0.5
    #[arg(required = true, value_name = "X,Y")]
    points: Vec<Position>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    lighting: LightingArgs,
}

/// The cell that a point lies in.
fn cell_of(Position([x, y]): Position, cells: &Cells) -> Result<usize> {
    let (w, h) = (cells.width(), cells.height());
    if (0.0..w as f32).contains(&x) && (0.0..h as f32).contains(&y) {
        return Ok(cells.index(x as u32, y as u32));
    }
    Err(CliError::bad_input(format_args!("the point {x},{y} lies outside the {w}×{h} scene"))
        .hint(format_args!("x runs from 0 to below {w}, y from 0 to below {h}")))
}

pub fn run(args: ProbeArgs) -> Result {
    args.lighting.machine.run(|_| {
        let display = DisplayArgs::default();
        let job = RenderJob::resolve(&args.scene, &args.lighting, &display, true)?;
        let at: Vec<(Position, usize)> = args
            .points
            .iter()
            .map(|&point| Ok((point, cell_of(point, &job.cells)?)))
            .collect::<Result<_>>()?;
        let lit = job.light()?;
        let answers = at
            .into_iter()
            .map(|(Position([x, y]), cell)| (x, y, lit.light.sample([x, y]), lit.light.solid()[cell]));
        if args.json {
            let points: Vec<_> = answers
                .map(|(x, y, light, solid)| {
                    json!({ "x": x, "y": y, "light": light, "luminance": luminance(light),
                            "solid": solid })
                })
                .collect();
            return output::print(json!({
                "width": job.cells.width(), "height": job.cells.height(), "method": lit.renderer.name(),
                "backend": lit.device.backend(), "points": points,
            }));
        }
        let rows = answers.map(|(x, y, light, solid)| {
            let mut row = vec![x.to_string(), y.to_string()];
            row.extend(light.iter().chain([&luminance(light)]).map(|&v| number(v.into())));
            row.push(if solid { "wall" } else { "open" }.to_owned());
            row
        });
        output::print(table(&["x", "y", "red", "green", "blue", "luminance", "cell"], &[6], rows))
    })
}
