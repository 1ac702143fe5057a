//! Images, from disk or from bytes. Their size is checked before any pixel is read.

use super::source::Source;
use crate::{Error, Result, Rgb, srgb};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes that decoding may take in addition to the pixels.
const DECODER_BYTES: u64 = 64 << 20;
/// Bytes of the largest pixel (four 32-bit channels), twice: as decoded and as kept.
const PIXEL_BYTES: u64 = 32;

/// The remedy for a file of another kind.
const NEEDED: &str = "a PNG, EXR, WebP or JPEG image is needed";
/// The problem of a file that ends before its pixels do.
const CUT_SHORT: &str = "the image is cut short";

/// The pixels of an image, as precise as in its file.
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
    /// Reads an image whose size `accept` does not reject; `path` is resolved already. Errors are about the scene's
    /// `key`, under which `accept` reports its own.
    pub fn open(
        source: Source,
        path: &Path,
        key: &str,
        accept: impl FnMut(u32, u32) -> Result<()>,
    ) -> Result<Self> {
        Self::read(source, path, accept).map_err(|e| match e {
            e @ Error::Value { .. } => e,
            e => e.under(key),
        })
    }

    fn read(
        source: Source,
        path: &Path,
        accept: impl FnMut(u32, u32) -> Result<()>,
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
                problem: format!("it is not a file; {NEEDED}"),
            });
        }
        // Its format follows from what it holds: a text stays one under any name.
        let file = BufReader::new(File::open(path).map_err(unread)?);
        Self::decode(ImageReader::new(file), path, accept)
    }

    fn decode(
        reader: ImageReader<impl BufRead + Seek>,
        path: &Path,
        mut accept: impl FnMut(u32, u32) -> Result<()>,
    ) -> Result<Self> {
        let unread = |source| Error::Read { path: path.to_owned(), source };
        let wrong = |problem: String| Error::Format { path: path.to_owned(), problem };
        let reader = reader.with_guessed_format().map_err(unread)?;
        let format =
            reader.format().ok_or_else(|| wrong(format!("it is not an image; {NEEDED}")))?;
        let mut file = reader.into_inner();
        let start = file.stream_position().map_err(unread)?;
        if format == ImageFormat::OpenExr
            && let Some(image) = one_channel_exr(&mut file, path, &mut accept)?
        {
            return Ok(Self::Float(image));
        }
        // Its decoder fills what is missing with grey.
        if format == ImageFormat::Jpeg && !has_end_of_jpeg(&mut file).map_err(unread)? {
            return Err(wrong(CUT_SHORT.into()));
        }
        file.seek(SeekFrom::Start(start)).map_err(unread)?;
        Self::pixels(ImageReader::with_format(file, format), path, accept)
    }

    fn pixels(
        reader: ImageReader<impl BufRead + Seek>,
        path: &Path,
        mut accept: impl FnMut(u32, u32) -> Result<()>,
    ) -> Result<Self> {
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

    /// Bytes that its pixels take.
    pub fn bytes(&self) -> u64 {
        let bytes = match self {
            Self::Byte(image) => size_of_val(image.as_raw().as_slice()),
            Self::Word(image) => size_of_val(image.as_raw().as_slice()),
            Self::Float(image) => size_of_val(image.as_raw().as_slice()),
        };
        bytes as u64
    }

    /// The linear colour of a pixel and its alpha.
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

    /// The values of a pixel as they are, 0 to 1 (in an EXR any), and its alpha.
    pub fn value(&self, x: u32, y: u32) -> (Rgb, f32) {
        let [r, g, b, a] = match self {
            Self::Byte(image) => image.get_pixel(x, y).0.map(|v| f32::from(v) / 255.0),
            Self::Word(image) => image.get_pixel(x, y).0.map(|v| f32::from(v) / 65535.0),
            Self::Float(image) => image.get_pixel(x, y).0,
        };
        ([r, g, b], a)
    }
}

/// The pixels of an EXR that has one channel and no colour, as grey; none if it has colour.
///
/// `image` reads only EXR files with the channels R, G and B. Painting programs write an opacity or a
/// mask as one channel, called Y by convention.
fn one_channel_exr(
    file: &mut (impl BufRead + Seek),
    path: &Path,
    accept: &mut impl FnMut(u32, u32) -> Result<()>,
) -> Result<Option<image::Rgba32FImage>> {
    use exr::prelude::traits::{ReadChannels, ReadLayers, ReadSpecificChannel};
    let problem = |e: exr::error::Error| Error::Format {
        path: path.to_owned(),
        problem: format!("it is not an EXR that can be read: {e}"),
    };
    let start = file.stream_position().unwrap_or(0);
    let meta = exr::meta::MetaData::read_from_buffered(&mut *file, false).map_err(problem)?;
    let name = match meta.headers.as_slice() {
        [header] if !header.deep => match header.channels.list.as_slice() {
            [channel] => {
                let size = header.layer_size;
                accept(size.width() as u32, size.height() as u32)?;
                channel.name.clone()
            }
            _ => return Ok(None),
        },
        _ => return Ok(None),
    };
    file.seek(SeekFrom::Start(start))
        .map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(name)
        .collect_pixels(
            |size, _| image::Rgba32FImage::new(size.width() as u32, size.height() as u32),
            |image, at, (value,): (f32,)| {
                image.put_pixel(
                    at.x() as u32,
                    at.y() as u32,
                    image::Rgba([value, value, value, 1.0]),
                );
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(file)
        .map_err(problem)?;
    Ok(Some(image.layer_data.channel_data.pixels))
}

/// Returns whether a JPEG has its end-of-image marker (ITU-T T.81, B.1.1): 0xFF, then 0xD9.
///
/// Pixels have a 0 after each 0xFF. Other segments, such as a thumbnail, may hold any bytes and are skipped.
fn has_end_of_jpeg(file: &mut (impl BufRead + Seek)) -> io::Result<bool> {
    loop {
        file.skip_until(0xFF)?;
        let mut next = || file.by_ref().bytes().find(|byte| !matches!(byte, Ok(0xFF))).transpose();
        match next()? {
            None => return Ok(false),
            Some(0xD9) => return Ok(true),
            // Pixels, and the markers without a segment.
            Some(0x00 | 0x01 | 0xD0..=0xD8) => {}
            Some(_) => {
                let mut length = [0; 2];
                match file.read_exact(&mut length) {
                    Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => return Ok(false),
                    read => read?,
                }
                // It counts itself.
                file.seek_relative(i64::from(u16::from_be_bytes(length)) - 2)?;
            }
        }
    }
}

fn broken(path: &Path, error: ImageError) -> Error {
    let problem = match error {
        ImageError::IoError(e) if e.kind() == io::ErrorKind::UnexpectedEof => CUT_SHORT.into(),
        ImageError::Unsupported(e) => format!("{e}; {NEEDED}"),
        // The decoder's own words name the parts of the format.
        ImageError::Decoding(e) if e.format_hint() != ImageFormat::OpenExr.into() => {
            let format = e.format_hint().to_string();
            let format = if format == "WebP" { format } else { format.to_uppercase() };
            format!("it is not a {format} image that can be read")
        }
        e => e.to_string(),
    };
    Error::Format { path: path.to_owned(), problem }
}
