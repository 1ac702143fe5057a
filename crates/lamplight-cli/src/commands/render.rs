//! `lamplight render`: light a scene and write a picture of it.

use crate::args::{DisplayArgs, LightingArgs};
use crate::device_info::DeviceInfo;
use crate::error::{CliError, Result, warn};
use crate::job::RenderJob;
use crate::lit::ms;
use crate::output::{self, Format};
use crate::stage::{FrameView, Stage};
use crate::warnings::idle_display_flags;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Light a scene and write the picture
#[derive(clap::Args, Debug)]
pub struct RenderArgs {
    /// The scene file (TOML or JSON), or a map (.tmx, .world, .ldtk)
    scene: PathBuf,
    /// The file to write: .png (sRGB picture) or .exr (linear floats) [default: the scene's name
    /// with .png, in the current directory]
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The stage to show
    #[arg(long, value_name = "STAGE", value_enum, default_value_t)]
    stage: Stage,
    /// Print a summary as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    lighting: LightingArgs,
    #[command(flatten)]
    display: DisplayArgs,
}

pub fn run(args: RenderArgs) -> Result {
    let output = match &args.output {
        Some(path) => path.clone(),
        None => default_output(&args.scene)?,
    };
    let format = Format::of(&output)?;
    if format == Format::Exr && args.display.scale != 1 {
        return Err(CliError::bad_input("--scale is for pictures (.png), not for .exr"));
    }
    args.lighting.machine.run(|threads| {
        let start = Instant::now();
        let stage = args.stage;
        let computes = stage.needs_fields() || stage.needs_light();
        let job = RenderJob::resolve(&args.scene, &args.lighting, &args.display, computes)?;
        job.outputs.check(&output)?;
        if !args.lighting.machine.quiet {
            idle_display_flags(&args.display, stage, format).iter().for_each(|text| warn(text));
        }

        let drawn = job.drawn();
        let fields = stage.needs_fields().then(|| job.fields(&drawn)).transpose()?;
        let lit = stage.needs_light().then(|| job.light()).transpose()?;
        let mut view = FrameView::new(&job.cells, &drawn, job.display);
        if let Some(fields) = &fields {
            view = view.with_fields(fields);
        }
        if let Some(lit) = &lit {
            view = view.lit(&lit.light);
        }
        let (width, height) = (drawn.width(), drawn.height());
        let bytes = match format {
            Format::Png => output::png(&view.picture(stage, args.display.scale)?)?,
            Format::Exr => output::exr(width, height, &view.layers(stage)?)?,
        };
        job.outputs.write(&output, &bytes)?;

        let shown = output.display();
        let device = lit.as_ref().map(|lit| &lit.device).or(fields.as_ref().map(|f| &f.device));
        if args.json {
            let mut summary = json!({
                "scene": args.scene.display().to_string(), "output": shown.to_string(),
                "stage": stage.name(),
                "width": width, "height": height,
                "backend": device.map_or("cpu", DeviceInfo::backend), "threads": threads,
                "total_ms": ms(start.elapsed()),
            });
            if let Some(lit) = &lit {
                summary["method"] = lit.renderer.name().into();
                summary["frames"] = lit.frames.into();
                summary["stages_ms"] = lit.stages_json().into();
                summary["settings"] = lit.settings.clone();
            }
            return output::print(summary);
        }
        if args.lighting.machine.quiet {
            return Ok(());
        }
        let summary = match &lit {
            Some(lit) => {
                let (name, took) = (lit.renderer.name(), ms(lit.total).round());
                format!("{width}×{height} cells lit by {name} in {took} ms")
            }
            None => format!("{} of {width}×{height} cells", stage.name()),
        };
        match device {
            Some(device) => output::print(format_args!("wrote {shown}: {summary} {device}")),
            None => output::print(format_args!("wrote {shown}: {summary}")),
        }
    })
}

/// The scene's name with `.png`, in the current directory.
fn default_output(scene: &Path) -> Result<PathBuf> {
    match scene.file_name() {
        Some(name) => Ok(Path::new(name).with_extension("png")),
        None => Err(CliError::bad_input(format_args!("{} names no file", scene.display()))),
    }
}
