//! Files that come in by being dropped on the window, and go out where the program was started.

use crate::window::subject::Subject;
use anyhow::{Context, Result, bail};
use eframe::egui::DroppedFile;
use image::{ImageBuffer, Rgb as Pixel};
use lamplight::{Cells, Display, Light, Scene};
use lamplight_sandbox::canvas::{As, Canvas};
use lamplight_sandbox::look::Look;

/// Opens a scene as a canvas, or lays an image on the canvas at hand; says what there is to say.
pub fn open(file: &DroppedFile, subject: &mut Subject) -> Result<Option<String>> {
    let (name, bytes) = match (&file.path, &file.bytes) {
        (Some(path), _) => {
            let long = std::fs::metadata(path).map_or(0, |about| about.len());
            if long > Canvas::MAX_BYTES as u64 {
                bail!(
                    "{} has {long} bytes; at most {} are read",
                    path.display(),
                    Canvas::MAX_BYTES
                );
            }
            let bytes =
                std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
            (path.clone(), bytes)
        }
        (None, Some(bytes)) => (file.name.clone().into(), bytes.to_vec()),
        (None, None) => bail!("the file that was dropped came without bytes"),
    };
    let ending = name.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    match ending.as_str() {
        "toml" | "json" => {
            let canvas = match &file.path {
                // With the images beside it.
                Some(path) => {
                    let scene = Scene::load(path)?;
                    let look = Look::of(&scene.settings()?, scene.display);
                    Canvas::of(scene.cells()?, look)?
                }
                None => Canvas::from_scene(&String::from_utf8(bytes)?, &[])?,
            };
            *subject = Subject::Canvas(Box::new(canvas));
            Ok(None)
        }
        "png" => {
            let mut canvas = match subject {
                Subject::Canvas(canvas) => canvas.clone(),
                Subject::World(playing) => Box::new(Canvas::new(playing.world.size())?),
            };
            let said = canvas.place_image(&bytes, As::Wall)?;
            *subject = Subject::Canvas(canvas);
            Ok(said)
        }
        _ => bail!("{} is neither a picture (.png) nor a scene (.toml, .json)", name.display()),
    }
}

/// Saves a scene file and its layers; says where.
pub fn save_scene(canvas: &Canvas, name: &str) -> Result<String> {
    let files = canvas.save(name)?;
    for (name, bytes) in &files {
        write(name, bytes)?;
    }
    let first = files.first().map_or("", |(name, _)| name);
    Ok(format!("saved {first} and {} layers in {}", files.len().saturating_sub(1), here()))
}

/// Saves what the picture shows; says where.
pub fn save_picture(light: &Light, cells: &Cells, display: Display, name: &str) -> Result<String> {
    let name = format!("{name}.png");
    light.compose(cells, &display)?.save(&name).with_context(|| format!("cannot write {name}"))?;
    Ok(format!("saved {name} in {}", here()))
}

/// Saves the bare light; says where.
pub fn save_light(light: &Light, name: &str) -> Result<String> {
    let name = format!("{name}-light.exr");
    let numbers = light.pixels().as_flattened().to_vec();
    let picture: ImageBuffer<Pixel<f32>, _> =
        ImageBuffer::from_raw(light.width(), light.height(), numbers).context("a broken light")?;
    picture.save(&name).with_context(|| format!("cannot write {name}"))?;
    Ok(format!("saved {name} in {}", here()))
}

fn write(name: &str, bytes: &[u8]) -> Result<()> {
    std::fs::write(name, bytes).with_context(|| format!("cannot write {name}"))
}

fn here() -> String {
    std::env::current_dir().map_or_else(|_| "this folder".to_owned(), |at| at.display().to_string())
}
