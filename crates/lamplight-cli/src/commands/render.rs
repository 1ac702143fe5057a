//! `lamplight render`: light a scene and write what it looks like.

use crate::args::{Lighting, Show};
use crate::failure::{Failure, Outcome};
use crate::lighting::{self, ms};
use crate::output::{self, Format};
use crate::place::Place;
use crate::stage::{Stage, View};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Light a scene and write the picture
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The scene file (TOML or JSON)
    scene: PathBuf,
    /// Where to write: .png (sRGB picture) or .exr (linear floats) [default: the scene's name with
    /// .png, here]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// What to show
    #[arg(long, value_name = "STAGE", value_enum, default_value_t)]
    stage: Stage,
    /// Say what was done as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    lighting: Lighting,
    #[command(flatten)]
    show: Show,
}

pub fn run(args: Args) -> Outcome {
    let output = match &args.output {
        Some(path) => path.clone(),
        None => default_output(&args.scene)?,
    };
    let format = Format::of(&output)?;
    output::check_file(&output)?;
    args.lighting.machine.run(|threads| {
        let start = Instant::now();
        let (scene, cells) = lighting::open(&args.scene, args.lighting.machine.quiet)?;
        let settings = args.lighting.resolve(&scene.light)?;
        let display = args.show.display(scene.display)?;
        let drawn = cells.drawn();

        let stage = args.stage;
        let computed = stage.needs_fields() || stage.needs_light();
        let gpu = if computed { lighting::gpu(&args.lighting, &settings)? } else { None };
        let gpu = gpu.as_ref();
        let fields = stage.needs_fields().then(|| lighting::fields(&drawn, gpu, &settings));
        let fields = fields.transpose()?;
        let lit = stage.needs_light().then(|| lighting::light(&cells, &args.lighting, gpu, settings));
        let lit = lit.transpose()?;
        let mut view = View::new(&drawn, display);
        if let Some(fields) = &fields {
            view = view.with_fields(fields);
        }
        if let Some(lit) = &lit {
            view = view.lit(&lit.light);
        }
        let bytes = match format {
            Format::Png => output::png(&view.picture(stage, args.show.scale)?)?,
            Format::Exr if args.show.scale == 1 => {
                output::exr(cells.width(), cells.height(), &view.floats(stage)?)?
            }
            Format::Exr => {
                return Err(Failure::bad_input("--scale is for pictures (.png), not for .exr"));
            }
        };
        output::write(&output, &bytes)?;

        let shown = output.display();
        let (w, h) = (cells.width(), cells.height());
        let place = lit.as_ref().map(|lit| &lit.place).or(fields.as_ref().map(|f| &f.place));
        if args.json {
            let mut done = json!({
                "scene": args.scene, "output": output, "stage": stage.name(), "width": w, "height": h,
                "backend": place.map_or("cpu", Place::backend), "threads": threads,
                "total_ms": ms(start.elapsed()),
            });
            if let Some(lit) = &lit {
                done["method"] = lit.answer.name().into();
                done["frames"] = lit.frames.into();
                done["stages_ms"] = lit.stages_json().into();
                done["settings"] = lit.settings.clone();
            }
            return output::print(done);
        }
        if args.lighting.machine.quiet {
            return Ok(());
        }
        let done = match &lit {
            Some(lit) => {
                let (name, took) = (lit.answer.name(), ms(lit.total).round());
                format!("{w}×{h} cells lit by {name} in {took} ms")
            }
            None => format!("{} of {w}×{h} cells", stage.name()),
        };
        match place {
            Some(place) => output::print(format_args!("wrote {shown}: {done} {place}")),
            None => output::print(format_args!("wrote {shown}: {done}")),
        }
    })
}

/// The scene's name with `.png`, in the directory that the command was called in.
fn default_output(scene: &Path) -> Outcome<PathBuf> {
    match scene.file_name() {
        Some(name) => Ok(Path::new(name).with_extension("png")),
        None => Err(Failure::bad_input(format_args!("{} names no file", scene.display()))),
    }
}
