//! Files that are dropped on the window.

use crate::platform::Dropped;
use crate::window::subject::Subject;
use anyhow::{Context, Result, bail};
use lamplight::Scene;
use lamplight_sandbox::canvas::{As, Canvas};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};

/// Files that arrive within this many seconds of each other belong to one drop, because browsers read them
/// one by one.
const TOGETHER: f64 = 1.0;

/// Dropped files that wait to be opened, and the files of the last drop.
pub struct Inbox {
    sender: Sender<Result<Dropped>>,
    waiting: Receiver<Result<Dropped>>,
    /// Files of the last drop that arrived as bytes, with their names.
    files: Vec<(String, Vec<u8>)>,
    /// Time of the last one, s.
    at: f64,
}

impl Default for Inbox {
    fn default() -> Self {
        let (sender, waiting) = channel();
        Self { sender, waiting, files: Vec::new(), at: 0.0 }
    }
}

impl Inbox {
    /// The channel for files, or errors in reading them.
    pub fn sender(&self) -> Sender<Result<Dropped>> {
        self.sender.clone()
    }

    /// Adds a file.
    pub fn receive(&self, file: Dropped) {
        // The receiver is a field of this struct, so it is there.
        let _ = self.sender.send(Ok(file));
    }

    /// The next file that waits.
    pub fn next(&self) -> Option<Result<Dropped>> {
        self.waiting.try_recv().ok()
    }

    /// Opens a scene as a canvas, or paints an image on a copy of the current canvas. Returns nothing as long as the file
    /// waits for the scene that it belongs to.
    pub fn open(
        &mut self,
        file: Dropped,
        now: f64,
        kind: As,
        subject: &Subject,
    ) -> Result<Option<Opened>> {
        let Some(bytes) = file.bytes else { return open(&file.path, kind, subject).map(Some) };
        let name = file.path.display().to_string();
        if now - self.at > TOGETHER {
            self.files.clear();
        }
        self.at = now;
        check_length(&name, bytes.len() as u64)?;
        self.files.push((name.clone(), bytes));
        // A scene and its images may arrive in any order.
        let is_scene = |name: &str| FileKind::of(Path::new(name)) == FileKind::Scene;
        if let Some((scene, text)) = self.files.iter().find(|(name, _)| is_scene(name)) {
            let text = std::str::from_utf8(text).with_context(|| format!("cannot read {scene}"))?;
            let canvas = Canvas::from_scene(text, &self.files).with_context(|| {
                format!("{scene} (a scene is dropped together with its images)")
            })?;
            return Ok(Some(Opened::scene(canvas)));
        }
        if file.is_layer {
            return Ok(None);
        }
        match self.files.last() {
            Some((_, png)) if FileKind::of(&file.path) == FileKind::Picture => {
                lay(png, kind, subject).map(Some)
            }
            _ => bail!("{name} {NEITHER}"),
        }
    }
}

/// The canvas of a file.
pub struct Opened {
    pub canvas: Box<Canvas>,
    /// False if it is the current canvas, with an image.
    pub is_scene: bool,
    /// A message.
    pub said: Option<String>,
}

impl Opened {
    fn scene(canvas: Canvas) -> Self {
        Self { canvas: Box::new(canvas), is_scene: true, said: None }
    }
}

const NEITHER: &str = "is neither a picture (.png) nor a scene (.toml, .json)";

/// The kind of a file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FileKind {
    Scene,
    Picture,
    Neither,
}

impl FileKind {
    fn of(name: &Path) -> Self {
        let ending = name.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match ending.as_str() {
            "toml" | "json" => Self::Scene,
            "png" => Self::Picture,
            _ => Self::Neither,
        }
    }
}

/// Returns which files of a drop belong to a scene in it.
pub fn layers<T>(dropped: &[T], path: impl Fn(&T) -> &Path) -> Vec<bool> {
    let is_scene = |file: &T| FileKind::of(path(file)) == FileKind::Scene;
    let has_scene = dropped.iter().any(is_scene);
    dropped.iter().map(|file| has_scene && !is_scene(file)).collect()
}

/// Opens a file on disk. A scene is opened with its images.
fn open(path: &Path, kind: As, subject: &Subject) -> Result<Opened> {
    check_length(path.display(), std::fs::metadata(path).map_or(0, |about| about.len()))?;
    match FileKind::of(path) {
        FileKind::Scene => {
            let scene = Scene::load(path)?;
            Ok(Opened::scene(Canvas::of_scene(&scene, Scene::cells)?))
        }
        FileKind::Picture => {
            let png = std::fs::read(path);
            lay(&png.with_context(|| format!("cannot read {}", path.display()))?, kind, subject)
        }
        FileKind::Neither => bail!("{} {NEITHER}", path.display()),
    }
}

fn check_length(name: impl std::fmt::Display, bytes: u64) -> Result<()> {
    if bytes > Canvas::MAX_BYTES as u64 {
        bail!("{name} has {bytes} bytes; at most {} are read", Canvas::MAX_BYTES);
    }
    Ok(())
}

/// Paints an image on the current canvas or on a new one.
fn lay(png: &[u8], kind: As, subject: &Subject) -> Result<Opened> {
    let mut canvas = match subject {
        Subject::Canvas(canvas) => canvas.clone(),
        Subject::World(playing) => Box::new(Canvas::new(playing.world.size())?),
    };
    let said = canvas.place_image(png, kind)?;
    Ok(Opened { canvas, is_scene: false, said })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lamplight_sandbox::canvas::{Brush, Stuff};

    const SIZE: [u32; 2] = [96, 54];

    fn are_layers(names: &[&str]) -> Vec<bool> {
        layers(names, |name| Path::new(name))
    }

    #[test]
    fn images_dropped_with_a_scene_are_its_layers() {
        assert_eq!(are_layers(&["a-color.png", "a.toml", "a-tint.exr"]), [true, false, true]);
        assert_eq!(are_layers(&["a.png", "b.PNG"]), [false, false]);
    }

    #[test]
    fn a_scene_and_its_images_may_arrive_in_any_order() {
        let mut painted = Canvas::welcome(SIZE).unwrap();
        painted.stroke(Brush { stuff: Stuff::Wall([0.3; 3]), radius: 3.0 }, &[[9.0, 9.0]]);
        let mut files = painted.save("a").unwrap();
        let subject = Subject::Canvas(Box::new(Canvas::welcome(SIZE).unwrap()));
        assert!(files.len() > 1, "there are images to wait for");
        for _ in 0..files.len() {
            files.rotate_left(1);
            let names: Vec<&str> = files.iter().map(|(name, _)| &name[..]).collect();
            let mut inbox = Inbox::default();
            let mut opened = None;
            for ((name, bytes), is_layer) in files.iter().zip(are_layers(&names)) {
                let file = Dropped { path: name.into(), bytes: Some(bytes.clone()), is_layer };
                // A scene lacks the images that come after it.
                let found = inbox.open(file, 0.0, As::Wall, &subject).unwrap_or_default();
                assert!(found.as_ref().is_none_or(|found| found.is_scene), "{name} was painted");
                opened = found;
            }
            let canvas = opened.expect("all files are there").canvas;
            assert!(canvas.cells() == painted.cells(), "{names:?}");
        }
    }
}
