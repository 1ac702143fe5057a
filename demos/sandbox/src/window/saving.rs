//! Saving of scenes, pictures and light.

use crate::platform::{self, File};
use crate::window::light::{Asked, Lit};
use anyhow::{Context, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat};
use lamplight::{Cells, Display, Light};
use lamplight_sandbox::canvas::plain_name;
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

/// A file that waits for its light.
#[derive(Default)]
pub struct Saving {
    /// The requested light, and the cells that it belongs to.
    waiting: Option<(SaveKind, Option<Asked>, Cells)>,
}

impl Saving {
    /// Requests the light of the last frame, which was of these cells.
    pub fn begin(&mut self, kind: SaveKind, lit: &Lit, cells: &Cells) -> Result<()> {
        self.waiting = Some((kind, Some(lit.ask(cells)?), cells.clone()));
        Ok(())
    }

    /// Saves light that has arrived. Returns a message with the location.
    pub fn go_on(&mut self, lit: &Lit, display: Display, name: &str) -> Result<Option<String>> {
        let Some((kind, asked, cells)) = &mut self.waiting else { return Ok(None) };
        let Some(light) = lit.take(asked)? else {
            if asked.is_none() {
                self.waiting = None;
            }
            return Ok(None);
        };
        let name = &plain_name(name);
        let file = match kind {
            SaveKind::Light => light_file(&light, name),
            SaveKind::Scene | SaveKind::Picture => picture_file(&light, cells, display, name),
        };
        self.waiting = None;
        platform::save(&[file?]).map(Some)
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
