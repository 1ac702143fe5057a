//! Screenshots of the window.

use anyhow::{Context as _, Result, anyhow};
use eframe::egui::{ColorImage, Context};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// A requested picture of the window.
pub struct Shot {
    path: PathBuf,
    image: Receiver<Arc<ColorImage>>,
}

impl Shot {
    /// Requests a picture of the next frame, to be written to a file.
    pub fn request(context: &Context, path: PathBuf) -> Self {
        let (sender, image) = channel();
        // The window may close first: then nobody receives the picture.
        context.request_screenshot(move |image| drop(sender.send(image)));
        Self { path, image }
    }

    /// Saves the picture if it has arrived, and returns whether that worked.
    pub fn save_if_ready(&self) -> Option<Result<()>> {
        match self.image.try_recv() {
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(anyhow!("the window cannot be captured"))),
            Ok(image) => Some(self.save(&image)),
        }
    }

    fn save(&self, image: &ColorImage) -> Result<()> {
        let [w, h] = image.size.map(|side| side as u32);
        let pixels: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
        let picture = image::RgbaImage::from_raw(w, h, pixels).context("a broken picture")?;
        picture.save(&self.path).with_context(|| format!("cannot write {}", self.path.display()))
    }
}
