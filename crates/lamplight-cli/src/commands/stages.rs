//! `lamplight stages`: every intermediate of a frame as a picture, and all on one contact sheet.

use crate::args::{DisplayArgs, LightingArgs};
use crate::contact_sheet::{LabelledPicture, contact_sheet};
use crate::error::Result;
use crate::job::RenderJob;
use crate::lit::ms;
use crate::output;
use crate::stage::{FrameView, Stage, enlarge};
use std::path::PathBuf;

/// Pictures in a row of the contact sheet.
const COLUMNS: u32 = 4;
/// The file name of the contact sheet.
const SHEET: &str = "contact-sheet.png";

/// Write every stage of a frame as a picture, and one contact sheet
#[derive(clap::Args, Debug)]
pub struct StagesArgs {
    /// The scene file (TOML or JSON), or a map (.tmx, .world, .ldtk)
    scene: PathBuf,
    /// The directory to write into; it is created if it does not exist
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    lighting: LightingArgs,
    #[command(flatten)]
    display: DisplayArgs,
}

pub fn run(args: StagesArgs) -> Result {
    args.lighting.machine.run(|_| {
        let job = RenderJob::resolve(&args.scene, &args.lighting, &args.display, true)?;
        let names = Stage::ALL.into_iter().map(file_name).chain([SHEET.to_owned()]);
        job.outputs.check_directory(&args.output, names)?;
        let drawn = job.drawn();
        let fields = job.fields(&drawn)?;
        let lit = job.light()?;
        let view =
            FrameView::new(&job.cells, &drawn, job.display).with_fields(&fields).lit(&lit.light);
        // Everything is made before anything is written.
        let mut pictures = Vec::new();
        for stage in Stage::ALL {
            let picture = view.picture(stage, 1)?;
            pictures.push(LabelledPicture {
                picture,
                name: stage.name(),
                caption: stage.caption(),
            });
        }
        let mut files = Vec::new();
        for (stage, labelled) in Stage::ALL.into_iter().zip(&pictures) {
            let picture = enlarge(&labelled.picture, args.display.scale)?;
            files.push((file_name(stage), output::png(&picture)?));
        }
        let name = args.scene.file_name().unwrap_or_default().to_string_lossy();
        let subtitle = format!(
            "{}×{} cells, lit by {} in {:.0} ms {}",
            drawn.width(),
            drawn.height(),
            lit.renderer.name(),
            ms(lit.total),
            lit.device,
        );
        let sheet = contact_sheet(&name, &subtitle, COLUMNS, &pictures);
        files.push((SHEET.to_owned(), output::png(&sheet)?));

        output::make_directory(&args.output)?;
        for (name, bytes) in &files {
            job.outputs.write(&args.output.join(name), bytes)?;
        }
        if args.lighting.machine.quiet {
            return Ok(());
        }
        output::print(format_args!(
            "wrote {} pictures of {name}, computed {}, all of them on {}",
            pictures.len(),
            fields.device,
            args.output.join(SHEET).display()
        ))
    })
}

fn file_name(stage: Stage) -> String {
    format!("{}.png", stage.name())
}
