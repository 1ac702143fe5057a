//! `lamplight bake`: light a scene of any size, tile by tile.

use crate::args::{Backend, DisplayArgs, MachineArgs, ON_THE_CPU, Renderer, SettingArgs, by_name};
use crate::error::{CliError, Result, warn};
use crate::input::Input;
use crate::lit::ms;
use crate::memory;
use crate::output::{self, OutputFiles};
use crate::progress::Progress;
use lamplight::world::{MAX_SIDE, Tiling, World, WorldSettings};
use lamplight::{Cells, Display, GridWindow, Light, Method};
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The file that says what the tiles of a directory are.
const MANIFEST: &str = "bake.json";
/// The remedy for tiles that a run cannot go on with.
const ANEW: &str = "leave --resume out to light all tiles anew, or name another directory";
/// Methods that know light from beyond a tile.
const METHODS: &[Method] = &[Method::Raymarch, Method::Cascades, Method::Holographic];
/// The smallest and the largest side of a tile, px.
const TILES: [u32; 2] = [64, 2048];

/// Light a scene or a map of any size, tile by tile, into a directory of pictures
///
/// Each tile has the light of the whole scene. The scene may be larger than a grid (up to 65536 a side); it is then
/// drawn with shapes, sprites, and layers in tiles, which are read as they are needed. Tiles are named by column and row: 0-0.png is the one at the top left. bake.json says
/// what they show. Tiles that an earlier bake.json there lists are removed.
#[derive(clap::Args, Debug)]
#[command(mut_arg("scale", |arg| arg.hide(true)), mut_arg("backend", |arg| arg.help(ON_THE_CPU)))]
pub struct BakeArgs {
    /// The scene file (TOML or JSON), or a map (.tmx, .world, .ldtk)
    scene: PathBuf,
    /// The directory to write tiles into
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// The format of tiles
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t)]
    format: TileFormat,
    /// The side of a tile in px: larger is faster and takes more memory
    #[arg(long, value_name = "PX", default_value_t = 1024,
          value_parser = clap::value_parser!(u32).range(i64::from(TILES[0])..=i64::from(TILES[1])))]
    tile: u32,
    /// The margin of a tile in px that is lit with it: wider is closer to one solve of the whole, and slower. In half of
    /// it, up to 32 px, tiles pass into each other
    #[arg(long, value_name = "PX", default_value_t = WorldSettings::HALO,
          value_parser = clap::value_parser!(u32).range(0..=512))]
    halo: u32,
    /// Keep the tiles that an earlier run has written with the same scene, the same images and the same flags
    #[arg(long)]
    resume: bool,
    /// Print a summary as one JSON object
    #[arg(long)]
    json: bool,
    /// The method that computes the light [default: the scene's method, else holographic]
    #[arg(long, value_name = "METHOD", value_parser = by_name(METHODS, Method::name))]
    method: Option<Method>,
    #[command(flatten)]
    settings: SettingArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    display: DisplayArgs,
}

/// The formats of tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum TileFormat {
    /// The picture: 8 bits, sRGB, tone-mapped
    #[default]
    Png,
    /// The light: 32-bit floats, linear
    Exr,
}

impl TileFormat {
    fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
        }
    }

    /// A tile as the bytes of a file.
    fn encode(self, light: &Light, cells: &Cells, display: &Display) -> Result<Vec<u8>> {
        match self {
            Self::Png => output::png(&light.compose(cells, display)?),
            Self::Exr => {
                let layers = [("", light.pixels().to_vec())];
                output::exr(light.width(), light.height(), &layers)
            }
        }
    }
}

pub fn run(args: BakeArgs) -> Result {
    if args.machine.backend == Backend::Gpu {
        return Err(CliError::bad_input("tiles are lit by the CPU so far")
            .hint("leave --backend out, or say --backend cpu"));
    }
    if args.display.scale != 1 {
        return Err(CliError::bad_input("--scale is not for tiles, which have a px for each cell"));
    }
    args.machine.run(|_| bake(&args))
}

fn bake(args: &BakeArgs) -> Result {
    let start = Instant::now();
    let quiet = args.machine.quiet;
    let scene = Input::load_world(&args.scene)?;
    let table = args.settings.over(&scene.settings(), args.method.map(Renderer::Method))?;
    let settings = WorldSettings { halo: args.halo, ..WorldSettings::new(table.resolve()?) };
    let display = args.display.resolve(scene.display())?;
    let size @ [width, height] = scene.size();
    let needed = memory::estimate_world(size, args.tile, &settings);
    memory::check(needed, format_args!("lighting {width}×{height} cells in tiles"))?;

    let source = scene.source()?;
    let outputs = OutputFiles::protecting(scene.files()?);
    let (columns, rows) = (width.div_ceil(args.tile), height.div_ceil(args.tile));
    let names = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    let names = names.map(|tile| tile_name(tile, args.format));
    outputs.check_directory(&args.output, names.chain([MANIFEST.to_owned()]))?;
    let rim = Tiling::new(size, args.tile, args.halo)?.rim();
    let mut manifest = json!({
        "scene": scene.identity()?, "size": size, "tile": args.tile, "halo": args.halo, "rim": rim,
        "columns": columns, "rows": rows,
        "format": args.format.extension(), "settings": table, "display": display,
    });
    if let Some(origin) = scene.origin() {
        manifest["origin"] = json!(origin);
    }
    if args.resume {
        check_manifest(&args.output, &manifest)?;
    }

    let progress = Progress::new("reading", 1, quiet);
    let world =
        World::new(&*source, settings, |part, parts| progress.of(part as u64, parts as u64))
            .map_err(|error| not_in_tiles(error, args, size))?;
    let mut tiles = world.light_tiles(args.tile)?;
    let windows = tiles.windows();
    let path = |window: &GridWindow| {
        args.output.join(tile_name(window.first.map(|v| v / args.tile), args.format))
    };
    output::make_directory(&args.output)?;
    if !args.resume {
        // Those of another scene would pass for finished ones, and those of a larger one for more of this.
        for path in windows.iter().map(path).chain(listed_tiles(&args.output)) {
            outputs.remove(&path)?;
        }
    }
    let text = serde_json::to_string_pretty(&manifest).unwrap_or_default() + "\n";
    outputs.write(&args.output.join(MANIFEST), text.as_bytes())?;
    progress.label("lighting");
    let mut lit = 0;
    for (number, window) in windows.iter().enumerate() {
        progress.of(number as u64, windows.len() as u64);
        let path = path(window);
        if args.resume && is_finished(&path, window.size) {
            continue;
        }
        let light = tiles.light(*window)?;
        let bytes = args.format.encode(&light, &source.cells(*window)?, &display)?;
        outputs.write(&path, &bytes)?;
        lit += 1;
    }
    drop(progress);

    let (count, kept) = (windows.len(), windows.len() - lit);
    let took = ms(start.elapsed());
    if args.json {
        let [scene, output] = [&args.scene, &args.output].map(|path| path.display().to_string());
        return output::print(json!({
            "scene": scene, "output": output, "size": size, "tiles": count,
            "kept": kept, "total_ms": took,
        }));
    }
    if quiet {
        return Ok(());
    }
    if args.resume && kept == 0 {
        warn("--resume found no finished tile");
    }
    let folder = args.output.display();
    let of_those = if kept > 0 { format!(", {kept} of them from before") } else { String::new() };
    let seconds = took / 1000.0;
    let tiles = if count == 1 { "tile" } else { "tiles" };
    output::print(format_args!(
        "wrote {count} {tiles} of {width}×{height} cells into {folder}{of_those}, in {seconds:.1} s"
    ))
}

/// The error for what cannot be lit in tiles.
fn not_in_tiles(error: lamplight::Error, args: &BakeArgs, [width, height]: [u32; 2]) -> CliError {
    use lamplight::Error::{Unsuited, Value};
    // The others are about files, which they name.
    if !matches!(error, Unsuited { .. } | Value { .. }) {
        return error.into();
    }
    let scene = &args.scene;
    let error = CliError::from(error.in_file(scene));
    match Cells::check_size(width.into(), height.into()) {
        Ok(()) => {
            let scene = scene.display();
            error.hint(format_args!("`lamplight render {scene}` lights it in one piece"))
        }
        Err(_) => error,
    }
}

/// The file name of a tile.
fn tile_name([column, row]: [u32; 2], format: TileFormat) -> String {
    format!("{column}-{row}.{}", format.extension())
}

/// The column and the row in the file name of a tile.
fn tile_of(name: &OsStr, format: TileFormat) -> Option<[u32; 2]> {
    let (column, rest) = name.to_str()?.split_once('-')?;
    let (row, _) = rest.split_once('.')?;
    let tile = [column.parse().ok()?, row.parse().ok()?];
    // `01-+2.png` is none.
    (*tile_name(tile, format) == *name).then_some(tile)
}

/// Returns whether a file is a whole picture of a tile's size. A machine that went down may have left an empty one.
fn is_finished(path: &Path, size: [u32; 2]) -> bool {
    image::open(path).is_ok_and(|picture| [picture.width(), picture.height()] == size)
}

/// The files of the tiles that the manifest of a directory lists: none, if it cannot be read, or is none of this command.
fn listed_tiles(directory: &Path) -> Vec<PathBuf> {
    let text = fs::read_to_string(directory.join(MANIFEST)).unwrap_or_default();
    let manifest: Value = serde_json::from_str(&text).unwrap_or_default();
    let formats = [TileFormat::Png, TileFormat::Exr];
    let format = formats.into_iter().find(|format| manifest["format"] == format.extension());
    let most = u64::from(MAX_SIDE / TILES[0]);
    let count = |key: &str| manifest[key].as_u64().filter(|count| *count <= most);
    let (Some(format), Some(columns), Some(rows)) = (format, count("columns"), count("rows"))
    else {
        return Vec::new();
    };
    let is_listed = |path: &PathBuf| {
        let tile = path.file_name().and_then(|name| tile_of(name, format));
        tile.is_some_and(|[column, row]| u64::from(column) < columns && u64::from(row) < rows)
    };
    // Of a large world most may be missing: only those that are there cost time.
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).filter(is_listed).collect()
}

/// Refuses to go on with the tiles of another scene, or of other flags.
fn check_manifest(directory: &Path, manifest: &Value) -> Result {
    let path = directory.join(MANIFEST);
    let shown = path.display();
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(CliError::failed(format_args!("cannot read {shown}: {error}"))),
    };
    let before: Value = serde_json::from_str(&text).map_err(|error| {
        CliError::bad_input(format_args!("--resume: cannot read {shown}: {error}")).hint(ANEW)
    })?;
    // Through text, as the other came.
    let now: Value = serde_json::from_str(&manifest.to_string()).unwrap_or_default();
    let keys = now.as_object().into_iter().flat_map(|all| all.keys());
    match keys.into_iter().find(|key| before.get(key) != now.get(key)) {
        None => Ok(()),
        Some(key) => Err(CliError::bad_input(format_args!(
            "--resume: `{key}` is not what it was for the tiles in {}",
            directory.display()
        ))
        .hint(ANEW)),
    }
}
