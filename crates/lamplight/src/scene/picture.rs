//! Images, from disk or from bytes: their size is known and judged before a pixel is read.

use super::source::Source;
use crate::{Error, Result, Rgb, srgb};
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, Limits};
use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

/// Bytes that decoding may take beside the pixels themselves.
const DECODER_BYTES: u64 = 64 << 20;
/// Bytes of the largest px (four 32-bit channels), twice: as decoded and as kept.
const PIXEL_BYTES: u64 = 32;

/// The pixels of an image as its file has them.
#[derive(Debug)]
pub(crate) enum Picture {
    /// 8 bits a channel, sRGB.
    Byte(image::RgbaImage),
    /// 16 bits a channel, sRGB.
    Word(image::ImageBuffer<image::Rgba<u16>, Vec<u16>>),
    /// 32-bit floats, linear (EXR).
    Float(image::Rgba32FImage),
}

impl Picture {
    /// Reads a PNG or EXR whose size `accept` does not refuse; `path` is placed already.
    pub fn open(
        source: Source,
        path: &Path,
        accept: impl FnOnce(u32, u32) -> Result<()>,
    ) -> Result<Self> {
        if let Source::Given(files) = source {
            let bytes = files(path).ok_or_else(|| Error::Format {
                path: path.to_owned(),
                problem: "it is not among the files that came with the scene".into(),
            })?;
            return Self::decode(ImageReader::new(Cursor::new(bytes)), path, accept);
        }
        let unread = |source| Error::Read { path: path.to_owned(), source };
        let metadata = std::fs::metadata(path).map_err(unread)?;
        if !metadata.is_file() {
            return Err(Error::Format {
                path: path.to_owned(),
                problem: "it is not a file; a PNG or EXR image is needed".into(),
            });
        }
        Self::decode(ImageReader::open(path).map_err(unread)?, path, accept)
    }

    fn decode(
        reader: ImageReader<impl BufRead + Seek>,
        path: &Path,
        accept: impl FnOnce(u32, u32) -> Result<()>,
    ) -> Result<Self> {
        let unread = |source| Error::Read { path: path.to_owned(), source };
        let reader = reader.with_guessed_format().map_err(unread)?;
        let mut decoder = reader.into_decoder().map_err(|e| broken(path, e))?;
        let (width, height) = decoder.dimensions();
        accept(width, height)?;
        let mut limits = Limits::default();
        let pixels = u64::from(width) * u64::from(height);
        limits.max_alloc = Some(pixels * PIXEL_BYTES + DECODER_BYTES);
        decoder.set_limits(limits).map_err(|e| broken(path, e))?;
        let image = DynamicImage::from_decoder(decoder).map_err(|e| broken(path, e))?;
        Ok(match image {
            DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
                Self::Float(image.into_rgba32f())
            }
            DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_) => Self::Word(image.into_rgba16()),
            _ => Self::Byte(image.into_rgba8()),
        })
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        let (width, height) = match self {
            Self::Byte(image) => image.dimensions(),
            Self::Word(image) => image.dimensions(),
            Self::Float(image) => image.dimensions(),
        };
        [width, height]
    }

    /// Linear colour of a px and its alpha.
    pub fn color(&self, x: u32, y: u32) -> (Rgb, f32) {
        match self {
            Self::Byte(image) => {
                let [r, g, b, a] = image.get_pixel(x, y).0;
                ([r, g, b].map(srgb::decode_u8), f32::from(a) / 255.0)
            }
            _ => {
                let (rgb, alpha) = self.value(x, y);
                let linear = matches!(self, Self::Float(_));
                (if linear { rgb } else { rgb.map(srgb::decode) }, alpha)
            }
        }
    }

    /// Values of a px as they are, 0 to 1 (in an EXR any), and its alpha.
    pub fn value(&self, x: u32, y: u32) -> (Rgb, f32) {
        let [r, g, b, a] = match self {
            Self::Byte(image) => image.get_pixel(x, y).0.map(|v| f32::from(v) / 255.0),
            Self::Word(image) => image.get_pixel(x, y).0.map(|v| f32::from(v) / 65535.0),
            Self::Float(image) => image.get_pixel(x, y).0,
        };
        ([r, g, b], a)
    }
}

fn broken(path: &Path, error: ImageError) -> Error {
    let problem = match error {
        ImageError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
            "the image is cut short".into()
        }
        ImageError::Unsupported(e) => format!("{e}; a PNG or EXR image is needed"),
        e => e.to_string(),
    };
    Error::Format { path: path.to_owned(), problem }
}
