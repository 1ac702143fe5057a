//! Files that are dropped on the window.

use crate::window::subject::Subject;
use anyhow::{Context, Result, bail};
use eframe::egui::DroppedFile;
use lamplight::Scene;
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
