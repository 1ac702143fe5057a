//! What leaves the program: text on stdout, and files that are whole or not there at all.

use crate::failure::{Failure, Outcome};
use image::{ExtendedColorType, ImageEncoder, Rgb32FImage, RgbImage};
use lamplight::Rgb;
use std::fmt::Display;
use std::fs;
use std::io::{self, Cursor, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Prints a line of results.
pub fn print(text: impl Display) -> Outcome {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Err(Failure::reader_left()),
        Err(e) => Err(Failure::failed(format_args!("cannot write to stdout: {e}"))),
    }
}

/// A kind of picture file, by its ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits a channel, sRGB.
    Png,
    /// 32-bit floats, linear.
    Exr,
}

impl Format {
    /// The format that a file's ending names.
    pub fn of(path: &Path) -> Outcome<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match ending.as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(Failure::bad_input(format_args!(
                "cannot tell what to write from the name {}: it must end in .png (sRGB picture) \
                 or .exr (linear floats)",
                path.display()
            ))),
        }
    }
}

/// Refuses an output file that cannot be written, before any work is done for it.
pub fn check_file(path: &Path) -> Outcome {
    let shown = path.display();
    if path.is_dir() {
        return Err(Failure::bad_input(format_args!("cannot write {shown}: it is a directory"))
            .hint(format_args!(
                "name a file in it, such as {}",
                path.join("light.png").display()
            )));
    }
    match folder_of(path) {
        folder if folder.is_dir() => Ok(()),
        folder if folder.exists() => Err(Failure::bad_input(format_args!(
            "cannot write {shown}: {} is not a directory",
            folder.display()
        ))),
        folder => Err(Failure::bad_input(format_args!(
            "cannot write {shown}: there is no directory {}",
            folder.display()
        ))),
    }
}

/// Makes a directory for output files, with its parents.
pub fn make_directory(path: &Path) -> Outcome {
    let shown = path.display();
    if path.exists() && !path.is_dir() {
        return Err(Failure::bad_input(format_args!(
            "cannot write into {shown}: it is a file, not a directory"
        )));
    }
    fs::create_dir_all(path)
        .map_err(|e| Failure::failed(format_args!("cannot make the directory {shown}: {e}")))
}

/// The temporary file that is being written now; Ctrl-C removes it.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// From here on Ctrl-C (and SIGTERM) removes an unfinished file before it ends the program.
pub fn clean_up_when_stopped() {
    // Without a handler Ctrl-C still ends the program; it may leave a temporary file then.
    let _ = ctrlc::set_handler(|| {
        if let Some(path) = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).take() {
            let _ = fs::remove_file(path);
        }
        std::process::exit(130);
    });
}

/// Writes a file whole: beside its place first, then moved over it.
pub fn write(path: &Path, bytes: &[u8]) -> Outcome {
    // Where a link leads, the file behind it changes and the link stays.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    // Errors would name the temporary file, which means nothing to a user.
    write_beside(&target, bytes).map_err(|e| {
        let reason = match e.kind() {
            ErrorKind::PermissionDenied => "permission denied".to_owned(),
            ErrorKind::NotFound => "there is no such directory".to_owned(),
            _ => e.to_string(),
        };
        Failure::failed(format_args!("cannot write {}: {reason}", path.display()))
    })
}

fn write_beside(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lamplight-").suffix(".tmp");
    #[cfg(unix)]
    {
        // As any new file, not only for its owner; the umask takes its share.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let lock = || UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
    let mut file = {
        let mut unfinished = lock();
        let file = builder.tempfile_in(folder_of(target))?;
        *unfinished = Some(file.path().to_owned());
        file
    };
    let written = file.write_all(bytes).and_then(|()| file.flush());
    let mut unfinished = lock();
    let done = written.and_then(|()| Ok(file.persist(target).map(drop)?));
    *unfinished = None;
    done
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A picture as the bytes of a PNG file.
pub fn png(picture: &RgbImage) -> Outcome<Vec<u8>> {
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(picture, picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .map_err(|e| Failure::failed(format_args!("cannot encode a PNG: {e}")))?;
    Ok(bytes)
}

/// Linear pixels in row order as the bytes of an EXR file of 32-bit floats.
pub fn exr(width: u32, height: u32, pixels: &[Rgb]) -> Outcome<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    Rgb32FImage::from_raw(width, height, pixels.as_flattened().to_vec())
        .ok_or_else(|| "a pixel is missing".to_owned())
        .and_then(|image| {
            image.write_to(&mut bytes, image::ImageFormat::OpenExr).map_err(|e| e.to_string())
        })
        .map_err(|e| Failure::failed(format_args!("cannot encode an EXR: {e}")))?;
    Ok(bytes.into_inner())
}
