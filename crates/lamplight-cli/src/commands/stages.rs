//! `lamplight stages`: every intermediate of a frame as a picture, and all on one sheet.

use crate::args::{Lighting, Show};
use crate::failure::Outcome;
use crate::lighting::{self, ms};
use crate::output;
use crate::sheet::{Labelled, sheet};
use crate::stage::{Stage, View};
use std::path::PathBuf;

/// Pictures in a row of the contact sheet.
const COLUMNS: u32 = 4;
/// The file name of the contact sheet.
const SHEET: &str = "contact-sheet.png";

/// Write every step of a frame as a picture, and one contact sheet
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The scene file (TOML or JSON)
    scene: PathBuf,
    /// The directory to write into; made where it is missing
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    lighting: Lighting,
    #[command(flatten)]
    show: Show,
}

pub fn run(args: Args) -> Outcome {
    args.lighting.machine.run(|_| {
        let (scene, cells) = lighting::open(&args.scene, args.lighting.machine.quiet)?;
        let settings = args.lighting.resolve(&scene.light)?;
        let display = args.show.display(scene.display)?;
        let gpu = lighting::gpu(&args.lighting, &settings)?;
        let drawn = cells.drawn();
        let fields = lighting::fields(&drawn, gpu.as_ref(), &settings)?;
        let lit = lighting::light(&cells, &args.lighting, gpu.as_ref(), settings)?;
        let view = View::new(&drawn, display).with_fields(&fields).lit(&lit.light);
        // Everything is made before anything is written.
        let mut pictures = Vec::new();
        for stage in Stage::ALL {
            let picture = view.picture(stage, 1)?;
            pictures.push(Labelled { picture, name: stage.name(), words: stage.words() });
        }
        let mut files = Vec::new();
        for labelled in &pictures {
            let picture = crate::stage::enlarge(&labelled.picture, args.show.scale)?;
            files.push((format!("{}.png", labelled.name), output::png(&picture)?));
        }
        let name = args.scene.file_name().unwrap_or_default().to_string_lossy();
        let subtitle = format!(
            "{}×{} cells, lit by {} in {:.0} ms {}",
            cells.width(),
            cells.height(),
            lit.answer.name(),
            ms(lit.total),
            lit.place,
        );
        files.push((SHEET.to_owned(), output::png(&sheet(&name, &subtitle, COLUMNS, &pictures))?));

        output::make_directory(&args.output)?;
        for (name, bytes) in &files {
            output::write(&args.output.join(name), bytes)?;
        }
        if args.lighting.machine.quiet {
            return Ok(());
        }
        output::print(format_args!(
            "wrote {} pictures of {name}, computed {}, all of them on {}",
            pictures.len(),
            fields.place,
            args.output.join(SHEET).display()
        ))
    })
}
