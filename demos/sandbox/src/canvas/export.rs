//! Export of a canvas as a scene file with images, from which the same cells can be loaded bit by bit; normals up to
//! rounding.
//!
//! Each field of the cells is a layer. It is a PNG if 8 bits represent it exactly, so that any program can
//! edit it, and otherwise an EXR.

use super::{Canvas, Error, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat};
use lamplight::{Normal, Rgb, Scene, srgb};
use std::io::Cursor;

/// The encoding of the bytes of a PNG in a layer.
#[derive(Clone, Copy)]
enum Bytes {
    /// sRGB.
    Color,
    /// ÷ 255.
    Value,
    /// A component of a normal, −1 to 1: from 128 on, ÷ 127.
    Normal,
}

/// Reduces a name to letters, digits, `-` and `_`, so that it is a valid file name on every system and cannot
/// refer to another folder.
pub fn plain_name(given: &str) -> String {
    let plain = |c: &char| c.is_ascii_alphanumeric() || *c == '-' || *c == '_';
    let name: String = given.chars().filter(plain).take(64).collect();
    match name.as_str() {
        "" => "canvas".to_owned(),
        device if is_device(device) => name + "_",
        _ => name,
    }
}

/// Returns true if Windows takes files of this name for a device, whatever their extension.
fn is_device(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let port = name.strip_prefix("com").or(name.strip_prefix("lpt"));
    let is_port = port.is_some_and(|port| port.len() == 1 && port.as_bytes()[0].is_ascii_digit());
    is_port || matches!(name.as_str(), "con" | "prn" | "aux" | "nul")
}

impl Canvas {
    /// The files of a scene: `NAME.toml` first, then its images.
    ///
    /// The name is reduced by [`plain_name`]. The cells are those of the last finished edit. The history is
    /// not saved.
    pub fn save(&self, name: &str) -> Result<Vec<(String, Vec<u8>)>> {
        let name = plain_name(name);
        let cells = self.cells();
        let mut scene = Scene::new(cells.width(), cells.height()).sky(cells.sky().clone());
        scene.lamps = cells.lamps().to_vec();
        scene.suns = cells.suns().to_vec();
        scene.display = self.look().display;
        scene.settings = self.look().table();

        let mut files = Vec::new();
        let mut layer = |field: &str, values: &[Rgb], bytes| {
            let (ending, data) = self.encode(values, bytes)?;
            let file = format!("{name}-{field}.{ending}");
            files.push((file.clone(), data));
            Ok::<_, Error>(Some(file.into()))
        };
        let opacity: Vec<Rgb> = cells.opacity().iter().map(|&v| [v; 3]).collect();
        // Opacity is always written, because emission alone would make cells solid.
        scene.layers.opacity = layer("opacity", &opacity, Bytes::Value)?;
        if cells.emission().iter().any(|&e| e != [0.0; 3]) {
            scene.layers.emission = layer("emission", cells.emission(), Bytes::Color)?;
        }
        if let Some(glow) = cells.glow() {
            scene.layers.glow = layer("glow", glow, Bytes::Color)?;
        }
        if cells.albedo().iter().any(|&a| a != [0.0; 3]) {
            scene.layers.albedo = layer("albedo", cells.albedo(), Bytes::Color)?;
        }
        if cells.tint().iter().any(|&t| t != [1.0; 3]) {
            scene.layers.tint = layer("tint", cells.tint(), Bytes::Value)?;
        }
        if let Some(color) = cells.color() {
            scene.layers.color = layer("color", color, Bytes::Color)?;
        }
        if let Some(normals) = cells.normals() {
            let green_up: Vec<Rgb> = normals.iter().map(|&[x, y, z]: &Normal| [x, -y, z]).collect();
            scene.layers.normal = layer("normal", &green_up, Bytes::Normal)?;
        }
        if let Some(masks) = cells.masks() {
            let masks: Vec<Rgb> = masks.iter().map(|&mask| [f32::from(mask) / 255.0; 3]).collect();
            scene.layers.mask = layer("mask", &masks, Bytes::Value)?;
        }
        files.insert(0, (format!("{name}.toml"), scene.to_toml()?.into_bytes()));
        Ok(files)
    }

    fn encode(&self, values: &[Rgb], bytes: Bytes) -> Result<(&'static str, Vec<u8>)> {
        let [w, h] = self.size();
        let exact = |v: f32| {
            let (byte, back) = match bytes {
                Bytes::Color => {
                    let byte = srgb::encode_u8(v);
                    (byte, srgb::decode_u8(byte))
                }
                Bytes::Value => {
                    let byte = (v * 255.0).round() as u8;
                    (byte, f32::from(byte) / 255.0)
                }
                Bytes::Normal => {
                    let byte = (127.0 * v + 128.0).round() as u8;
                    (byte, (f32::from(byte) - 128.0) / 127.0)
                }
            };
            (back == v).then_some(byte)
        };
        let flat = values.as_flattened();
        let small: Option<Vec<u8>> = flat.iter().map(|&v| exact(v)).collect();
        let (ending, format, image) = match small {
            Some(small) => {
                let image = ImageBuffer::from_raw(w, h, small).map(DynamicImage::ImageRgb8);
                ("png", ImageFormat::Png, image)
            }
            None => {
                let image = ImageBuffer::from_raw(w, h, flat.to_vec());
                ("exr", ImageFormat::OpenExr, image.map(DynamicImage::ImageRgb32F))
            }
        };
        let image = image.ok_or_else(|| Error::Image("its size does not match".into()))?;
        let mut data = Cursor::new(Vec::new());
        image.write_to(&mut data, format).map_err(|e| Error::Image(e.to_string()))?;
        Ok((ending, data.into_inner()))
    }
}
