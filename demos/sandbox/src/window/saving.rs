//! Saving of scenes, pictures and light.

use crate::platform::File;
use crate::window::light::{Asked, Lit};
use anyhow::{Context, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat};
use lamplight::{Cells, Display, Light};
use lamplight_sandbox::canvas::plain_name;
use std::collections::VecDeque;
use std::io::Cursor;

/// The kind of a saved file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SaveKind {
    /// A scene file of a canvas, with its layers.
    Scene,
    /// The picture.
    Picture,
    /// Linear light.
    Light,
}

impl SaveKind {
    pub const ALL: [Self; 3] = [Self::Scene, Self::Picture, Self::Light];

    /// The name on its button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "Scene",
            Self::Picture => "Picture",
            Self::Light => "Light",
        }
    }

    /// A description of the files.
    pub fn words(self) -> &'static str {
        match self {
            Self::Scene => "NAME.toml and its layers; canvases only",
            Self::Picture => "NAME.png, a pixel per cell, lit and tone mapped",
            Self::Light => "NAME-light.exr, linear light",
        }
    }
}

/// Files that wait for their light, in the order in which it was requested.
#[derive(Default)]
pub struct Saving {
    waiting: VecDeque<Waiting>,
}

/// The requested light of a file, and the cells that it belongs to.
struct Waiting {
    kind: SaveKind,
    light: Option<Asked>,
    cells: Cells,
}

impl Saving {
    /// Requests the light of the last frame, which was of these cells.
    pub fn begin(&mut self, kind: SaveKind, lit: &Lit, cells: &Cells) -> Result<()> {
        let light = Some(lit.ask(cells)?);
        self.waiting.push_back(Waiting { kind, light, cells: cells.clone() });
        Ok(())
    }

    /// Returns true if files are not saved yet.
    pub fn is_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// The next file whose light has arrived.
    pub fn go_on(&mut self, lit: &Lit, display: Display, name: &str) -> Result<Option<File>> {
        let Some(first) = self.waiting.front_mut() else { return Ok(None) };
        let come = lit.take(&mut first.light);
        // The request is gone if it failed or was answered.
        let Some(Waiting { kind, cells, .. }) = self.waiting.pop_front_if(|w| w.light.is_none())
        else {
            return Ok(None);
        };
        let Some(light) = come? else { return Ok(None) };
        let name = &plain_name(name);
        match kind {
            SaveKind::Light => light_file(&light, name),
            SaveKind::Scene | SaveKind::Picture => picture_file(&light, &cells, display, name),
        }
        .map(Some)
    }
}

fn picture_file(light: &Light, cells: &Cells, display: Display, name: &str) -> Result<File> {
    let picture = DynamicImage::from(light.compose(cells, &display)?);
    Ok((format!("{name}.png"), encode(&picture, ImageFormat::Png)?))
}

fn light_file(light: &Light, name: &str) -> Result<File> {
    let numbers = light.pixels().as_flattened().to_vec();
    let picture = ImageBuffer::from_raw(light.width(), light.height(), numbers);
    let picture = DynamicImage::ImageRgb32F(picture.context("a broken light")?);
    Ok((format!("{name}-light.exr"), encode(&picture, ImageFormat::OpenExr)?))
}

fn encode(picture: &DynamicImage, format: ImageFormat) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format)?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::light::Shown;
    use eframe::egui::Context;
    use lamplight::Settings;

    #[test]
    fn a_file_that_is_asked_for_does_not_replace_one_that_waits() {
        let settings = Settings::default();
        let mut lit = Lit::on_cpu(&Context::default(), &settings).unwrap();
        let cells = Cells::new(8, 8).unwrap();
        lit.find(&cells, &cells, &settings, Shown::default()).unwrap();
        let mut saving = Saving::default();
        saving.begin(SaveKind::Picture, &lit, &cells).unwrap();
        saving.begin(SaveKind::Light, &lit, &cells).unwrap();
        let mut next = || saving.go_on(&lit, Display::default(), "a").unwrap().map(|file| file.0);
        assert_eq!([next(), next()], [Some("a.png".into()), Some("a-light.exr".into())]);
        assert_eq!(next(), None);
        assert!(!saving.is_waiting());
    }
}
