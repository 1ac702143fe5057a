//! `lamplight sight`: what viewers see of a scene, as a picture.

use crate::args::{Backend, DisplayArgs, MachineArgs, ON_THE_CPU, Position, Renderer};
use crate::device_info::DeviceInfo;
use crate::error::{CliError, Result, warn};
use crate::input::Input;
use crate::job::read_cells;
use crate::lit::ms;
use crate::memory;
use crate::output::{self, Format};
use crate::stage::{check_scale, enlarge};
use crate::warnings::blind_viewers;
use lamplight::{Cone, Method, Settings, Sight, SightSolver, debug_views};
use std::path::PathBuf;
use std::time::Instant;

/// Write a picture of what viewers see of a scene: white is seen
#[derive(clap::Args, Debug)]
#[command(mut_arg("backend", |arg| arg.help(ON_THE_CPU)))]
pub struct SightArgs {
    /// The scene file (TOML or JSON), or a map (.tmx, .world, .ldtk)
    scene: PathBuf,
    /// The eye of a viewer in px from the top left, such as 160,90. Repeat it for more viewers, of whom the
    /// picture shows what any sees
    #[arg(long, value_name = "X,Y", required = true, allow_hyphen_values = true)]
    from: Vec<Position>,
    /// The file to write: .png (plain values, white is 1) or .exr (floats)
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// The radius of each eye in px: larger is softer
    #[arg(long, value_name = "PX", default_value_t = Sight::default().size)]
    size: f32,
    /// The distance in px from which on nothing is seen
    #[arg(long, value_name = "PX", default_value_t = Sight::default().range)]
    range: f32,
    /// The fraction of the range, from its end inwards, over which sight fades
    #[arg(long, value_name = "FRACTION", default_value_t = Sight::default().fade)]
    fade: f32,
    /// The direction in which viewers look, in degrees from the right downwards [default: all round]
    #[arg(long, value_name = "DEGREES", requires = "angle", value_parser = degrees(-360.0, 360.0))]
    direction: Option<f32>,
    /// The angle of their field of view, in degrees
    #[arg(long, value_name = "DEGREES", requires = "direction", value_parser = degrees(0.06, 360.0))]
    angle: Option<f32>,
    /// Show each cell as K×K pixels
    #[arg(long, value_name = "K", default_value_t = DisplayArgs::default().scale,
          value_parser = clap::value_parser!(u32).range(1..=64))]
    scale: u32,
    #[command(flatten)]
    machine: MachineArgs,
}

/// A parser for angles in a range.
fn degrees(least: f32, most: f32) -> impl Fn(&str) -> Result<f32, String> + Clone {
    move |text| {
        let value = text.parse().ok().filter(|value| (least..=most).contains(value));
        value.ok_or_else(|| format!("an angle is {least} to {most} degrees"))
    }
}

impl SightArgs {
    fn sights(&self) -> Vec<Sight> {
        let cone = self.direction.zip(self.angle).map(|(direction, angle)| Cone {
            direction: direction.to_radians(),
            angle: angle.to_radians(),
            softness: 0.0,
            profile: None,
        });
        let Self { size, range, fade, .. } = *self;
        let sight = |&Position(position): &Position| Sight { position, size, range, fade, cone };
        self.from.iter().map(sight).collect()
    }
}

pub fn run(args: SightArgs) -> Result {
    let format = Format::of(&args.output)?;
    if format == Format::Exr && args.scale != 1 {
        return Err(CliError::bad_input("--scale is for pictures (.png), not for .exr"));
    }
    let MachineArgs { backend, quiet, .. } = args.machine;
    if backend == Backend::Gpu {
        return Err(CliError::bad_input("this command finds sight on the CPU only")
            .hint("leave --backend out, or say --backend cpu"));
    }
    args.machine.run(|_| {
        let scene = Input::load(&args.scene)?;
        check_scale(scene.size(), args.scale)?;
        let (cells, outputs) = read_cells(&scene, &args.scene, quiet, |size| {
            // Sight takes no more than the light of `polar`.
            let settings = Settings::direct(Method::Polar);
            memory::estimate(size, Renderer::Method(Method::Polar), &settings, Backend::Cpu)
                + memory::estimate_picture(size.cells, args.scale)
        })?;
        outputs.check(&args.output)?;
        let drawn = cells.drawn();
        let sights = args.sights();
        let start = Instant::now();
        let mut solver = SightSolver::default();
        solver.read(&drawn)?;
        let seen = solver.field(&sights)?;
        let took = ms(start.elapsed()).round();
        if !quiet {
            blind_viewers(&sights, &drawn).iter().for_each(|text| warn(text));
        }
        let (width, height) = (cells.width(), cells.height());
        let bytes = match format {
            Format::Png => {
                output::png(&enlarge(&debug_views::visibility(width, seen), args.scale)?)?
            }
            Format::Exr => {
                let grey = seen.iter().map(|&v| [v; 3]).collect();
                output::exr(width, height, &[("", grey)])?
            }
        };
        outputs.write(&args.output, &bytes)?;
        if quiet {
            return Ok(());
        }
        let viewers = match args.from.len() {
            1 => "one viewer sees".to_owned(),
            count => format!("{count} viewers see"),
        };
        let (shown, device) = (args.output.display(), DeviceInfo::cpu());
        output::print(format_args!(
            "wrote {shown}: what {viewers} of {width}×{height} cells, found in {took} ms {device}"
        ))
    })
}
