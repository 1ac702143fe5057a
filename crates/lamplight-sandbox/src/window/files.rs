//! Files that are dropped on the window.

use crate::window::subject::Subject;
use anyhow::{Context, Result, bail};
use eframe::egui::DroppedFile;
use lamplight::Scene;
use lamplight_sandbox::canvas::{As, Canvas};
use lamplight_sandbox::look::Look;
use std::path::Path;

/// Seconds from file to file within which they belong to one drop: a browser reads them one by one.
const TOGETHER: f64 = 1.0;

/// What was dropped last.
#[derive(Default)]
pub struct Inbox {
    /// Files that came as bytes, by name.
    files: Vec<(String, Vec<u8>)>,
    /// When the last one came, s.
    at: f64,
}

impl Inbox {
    /// Opens a scene as a canvas, or lays an image on the canvas at hand, as walls, glass or what else is
    /// wanted; says what there is to say.
    pub fn take(
        &mut self,
        file: DroppedFile,
        now: f64,
        kind: As,
        subject: &mut Subject,
    ) -> Result<Option<String>> {
        match (file.path, file.bytes) {
            (Some(path), _) => open(&path, kind, subject),
            (None, Some(bytes)) => self.take_bytes(file.name, &bytes, now, kind, subject),
            (None, None) => bail!("the file that was dropped came without bytes"),
        }
    }

    fn take_bytes(
        &mut self,
        name: String,
        bytes: &[u8],
        now: f64,
        kind: As,
        subject: &mut Subject,
    ) -> Result<Option<String>> {
        if now - self.at > TOGETHER {
            self.files.clear();
        }
        self.at = now;
        check_length(&name, bytes.len() as u64)?;
        self.files.push((name.clone(), bytes.to_vec()));
        // The images of a scene come before it or after it, in any order.
        let is_scene = |name: &str| Kind::of(Path::new(name)) == Kind::Scene;
        if let Some((scene, text)) = self.files.iter().find(|(name, _)| is_scene(name)) {
            let text = std::str::from_utf8(text).with_context(|| format!("cannot read {scene}"))?;
            let canvas = Canvas::from_scene(text, &self.files).with_context(|| {
                format!("{scene} (a scene is dropped together with its images)")
            })?;
            *subject = Subject::Canvas(Box::new(canvas));
            return Ok(None);
        }
        match Kind::of(Path::new(&name)) {
            Kind::Picture => lay(bytes, kind, subject),
            _ => bail!("{name} {NEITHER}"),
        }
    }
}

const NEITHER: &str = "is neither a picture (.png) nor a scene (.toml, .json)";

/// What a file is, by its ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Scene,
    Picture,
    Neither,
}

impl Kind {
    fn of(name: &Path) -> Self {
        let ending = name.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match ending.as_str() {
            "toml" | "json" => Self::Scene,
            "png" => Self::Picture,
            _ => Self::Neither,
        }
    }
}

/// Opens a file from disk, a scene with the images beside it.
fn open(path: &Path, kind: As, subject: &mut Subject) -> Result<Option<String>> {
    check_length(path.display(), std::fs::metadata(path).map_or(0, |about| about.len()))?;
    match Kind::of(path) {
        Kind::Scene => {
            let scene = Scene::load(path)?;
            let look = Look::of(&scene.settings()?, scene.display);
            *subject = Subject::Canvas(Box::new(Canvas::of(scene.cells()?, look)?));
            Ok(None)
        }
        Kind::Picture => {
            let png = std::fs::read(path);
            lay(&png.with_context(|| format!("cannot read {}", path.display()))?, kind, subject)
        }
        Kind::Neither => bail!("{} {NEITHER}", path.display()),
    }
}

fn check_length(name: impl std::fmt::Display, bytes: u64) -> Result<()> {
    if bytes > Canvas::MAX_BYTES as u64 {
        bail!("{name} has {bytes} bytes; at most {} are read", Canvas::MAX_BYTES);
    }
    Ok(())
}

/// Lays a picture on the canvas at hand, or on a new one.
fn lay(png: &[u8], kind: As, subject: &mut Subject) -> Result<Option<String>> {
    let mut canvas = match subject {
        Subject::Canvas(canvas) => canvas.clone(),
        Subject::World(playing) => Box::new(Canvas::new(playing.world.size())?),
    };
    let said = canvas.place_image(png, kind)?;
    *subject = Subject::Canvas(canvas);
    Ok(said)
}
