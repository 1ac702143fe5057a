//! What is saved: a scene, the picture, the light.

use crate::platform::{self, File};
use crate::window::light::{Asked, Lit};
use anyhow::{Context, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat};
use lamplight::{Cells, Display, Light};
use lamplight_sandbox::canvas::plain_name;
use std::io::Cursor;

/// What there is to save.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// A scene file and its layers, of a canvas.
    Scene,
    /// The picture.
    Picture,
    /// The bare light.
    Light,
}

impl Kind {
    pub const ALL: [Self; 3] = [Self::Scene, Self::Picture, Self::Light];

    /// The name on its button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "Scene",
            Self::Picture => "Picture",
            Self::Light => "Light",
        }
    }

    /// What comes of it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Scene => "NAME.toml and its layers, to load again; of a canvas",
            Self::Picture => "NAME.png, a pixel a cell, lit and tone mapped",
            Self::Light => "NAME-light.exr, linear light",
        }
    }
}

/// What is being saved.
#[derive(Default)]
pub struct Saving {
    /// Light that has yet to come, of these cells.
    waiting: Option<(Kind, Option<Asked>, Cells)>,
}

impl Saving {
    /// Asks for the light of the last frame, which was of these cells, to be saved.
    pub fn begin(&mut self, kind: Kind, lit: &Lit, cells: &Cells) -> Result<()> {
        self.waiting = Some((kind, Some(lit.ask(cells)?), cells.clone()));
        Ok(())
    }

    /// Saves what has come; says where it is.
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
            Kind::Light => light_file(&light, name),
            Kind::Scene | Kind::Picture => picture_file(&light, cells, display, name),
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
