//! `lamplight probe`: how lit is this point? What gameplay code asks.

use crate::args::Lighting;
use crate::failure::{Failure, Outcome};
use crate::lighting;
use crate::output;
use crate::table::{number, table};
use lamplight::Cells;
use lamplight::srgb::luminance;
use serde_json::json;
use std::path::PathBuf;
use std::str::FromStr;

/// Say how lit points of a scene are
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The scene file (TOML or JSON)
    scene: PathBuf,
    /// Points in px from the top left, such as 160,90 or 40.5,30.5; the centre of the first cell is
    /// 0.5,0.5
    #[arg(required = true, value_name = "X,Y")]
    points: Vec<Point>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    lighting: Lighting,
}

#[derive(Clone, Copy, Debug)]
struct Point([f32; 2]);

impl FromStr for Point {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.trim().parse().ok().filter(|v: &f32| v.is_finite());
        text.split_once(',')
            .and_then(|(x, y)| Some(Self([number(x)?, number(y)?])))
            .ok_or("a point is two numbers with a comma between them, such as 160,90")
    }
}

impl Point {
    /// The cell that the point lies in.
    fn cell(self, cells: &Cells) -> Outcome<usize> {
        let [x, y] = self.0;
        let (w, h) = (cells.width(), cells.height());
        if (0.0..w as f32).contains(&x) && (0.0..h as f32).contains(&y) {
            return Ok(cells.index(x as u32, y as u32));
        }
        Err(Failure::bad_input(format_args!("the point {x},{y} lies outside the {w}×{h} scene"))
            .hint(format_args!("x runs from 0 to {w}, y from 0 to {h}")))
    }
}

pub fn run(args: Args) -> Outcome {
    args.lighting.machine.run(|_| {
        let (scene, cells) = lighting::open(&args.scene, args.lighting.machine.quiet)?;
        let at: Vec<(Point, usize)> = args
            .points
            .iter()
            .map(|&point| Ok((point, point.cell(&cells)?)))
            .collect::<Outcome<_>>()?;
        let settings = args.lighting.resolve(&scene.light)?;
        let gpu = lighting::gpu(&args.lighting, &settings)?;
        let lit = lighting::light(&cells, &args.lighting, gpu.as_ref(), settings)?;
        let answers = at
            .into_iter()
            .map(|(Point([x, y]), cell)| (x, y, lit.light.sample([x, y]), lit.light.solid()[cell]));
        if args.json {
            let points: Vec<_> = answers
                .map(|(x, y, light, solid)| {
                    json!({ "x": x, "y": y, "light": light, "luminance": luminance(light),
                            "solid": solid })
                })
                .collect();
            return output::print(json!({
                "width": cells.width(), "height": cells.height(), "method": lit.answer.name(),
                "backend": lit.place.backend(), "points": points,
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
