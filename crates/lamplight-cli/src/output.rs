//! Results on stdout, and output files: whole or not written at all, and never over an input.

use crate::error::{CliError, Result};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
};
use image::{ExtendedColorType, ImageEncoder, RgbImage};
use lamplight::Rgb;
use std::fmt::Display;
use std::fs::{self, OpenOptions};
use std::io::{self, Cursor, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Most links that are followed from one path, as on Linux.
const MAX_LINKS: usize = 40;

/// Prints a line of results.
pub fn print(text: impl Display) -> Result {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Err(CliError::reader_left()),
        Err(e) => Err(CliError::failed(format_args!("cannot write to stdout: {e}"))),
    }
}

/// The format of a picture file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits per channel, sRGB.
    Png,
    /// 32-bit floats, linear.
    Exr,
}

impl Format {
    /// The format that a file's extension names.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(CliError::bad_input(format_args!(
                "cannot tell what to write from the name {}: it must end in .png (sRGB picture) \
                 or .exr (linear floats)",
                path.display()
            ))),
        }
    }
}

/// A writer of output files that refuses to write over the files a command reads.
#[derive(Debug, Default)]
pub struct OutputFiles {
    /// Canonical paths.
    inputs: Vec<PathBuf>,
}

impl OutputFiles {
    /// A writer that protects `inputs`. Links to them are protected too.
    pub fn protecting(inputs: impl IntoIterator<Item = PathBuf>) -> Self {
        // An input that cannot be found is reported when it is read.
        Self { inputs: inputs.into_iter().filter_map(|path| path.canonicalize().ok()).collect() }
    }

    /// Refuses a file that cannot be written, before any work is done for it.
    pub fn check(&self, path: &Path) -> Result {
        if path.is_dir() {
            let inside = path.join("light.png");
            let hint = format!("name a file in it, such as {}", inside.display());
            return Err(is_a_directory(path).hint(hint));
        }
        let target = self.target(path)?;
        try_writing_into(folder_of(&target)).map_err(|reason| cannot_write(path, reason))
    }

    /// Refuses a directory that cannot be made, or in which one of some files cannot be written, before any work is
    /// done for it. Nothing is made.
    pub fn check_directory(
        &self,
        path: &Path,
        files: impl IntoIterator<Item = impl AsRef<Path>>,
    ) -> Result {
        let shown = path.display();
        // A link that leads nowhere is in the way of a directory.
        let is_there = |path: &&Path| fs::symlink_metadata(or_here(path)).is_ok();
        let nearest = path.ancestors().find(is_there).map_or(Path::new("."), or_here);
        if !nearest.is_dir() {
            let it = if nearest == path { "it".into() } else { nearest.display().to_string() };
            return Err(CliError::bad_input(format_args!(
                "cannot write into {shown}: {it} is a file, not a directory"
            )));
        }
        if nearest != or_here(path) {
            return try_writing_into(nearest).map_err(|reason| cannot_make(path, reason));
        }
        try_writing_into(path).map_err(|reason| {
            CliError::failed(format_args!("cannot write into {shown}: {reason}"))
        })?;
        files.into_iter().try_for_each(|file| self.target(&path.join(file)).map(drop))
    }

    /// Writes a whole file: beside its place first, then moved over it. If `path` is a link, its
    /// target is written and the link stays.
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Result {
        let target = self.target(path)?;
        write_beside(&target, bytes).map_err(|e| cannot_write(path, reason(&e)))
    }

    /// Removes a file that an earlier run has written, unless it is an input by now.
    pub fn remove(&self, path: &Path) -> Result {
        if path.canonicalize().is_ok_and(|path| self.inputs.contains(&path)) {
            return Ok(());
        }
        match fs::remove_file(path) {
            Err(e) if e.kind() != ErrorKind::NotFound => {
                let shown = path.display();
                Err(CliError::failed(format_args!("cannot remove {shown}: {}", reason(&e))))
            }
            _ => Ok(()),
        }
    }

    /// The file that `path` leads to, which need not exist yet.
    fn target(&self, path: &Path) -> Result<PathBuf> {
        let shown = path.display();
        if path.is_dir() {
            return Err(is_a_directory(path).hint("remove it, or name another directory"));
        }
        let target = follow_links(path)
            .ok_or_else(|| cannot_write(path, "its links form a circle".into()))?;
        match folder_of(&target) {
            folder if folder.is_dir() => {}
            folder if folder.exists() => {
                return Err(CliError::bad_input(format_args!(
                    "cannot write {shown}: {} is not a directory",
                    folder.display()
                )));
            }
            folder => {
                return Err(CliError::bad_input(format_args!(
                    "cannot write {shown}: there is no directory {}",
                    folder.display()
                )));
            }
        }
        let Ok(metadata) = fs::metadata(&target) else { return Ok(target) };
        if target.canonicalize().is_ok_and(|path| self.inputs.contains(&path)) {
            return Err(CliError::bad_input(format_args!(
                "cannot write {shown}: the scene reads this file"
            ))
            .hint("name another file"));
        }
        if !metadata.is_file() {
            return Err(cannot_write(path, "it is not a regular file".into()));
        }
        // A superuser may open any file; the owner's wish counts all the same.
        if metadata.permissions().readonly() {
            return Err(cannot_write(path, "it is read-only".into()));
        }
        OpenOptions::new().write(true).open(&target).map_err(|e| cannot_write(path, reason(&e)))?;
        Ok(target)
    }
}

/// Creates a directory for output files, with its parents.
pub fn make_directory(path: &Path) -> Result {
    fs::create_dir_all(path).map_err(|e| cannot_make(path, e.to_string()))
}

/// Makes a file in a directory that exists, and removes it; returns the reason if that fails.
fn try_writing_into(folder: &Path) -> Result<(), String> {
    tempfile::tempfile_in(folder).map(drop).map_err(|error| match error.kind() {
        // As in /proc.
        ErrorKind::NotFound => "no file can be made there".to_owned(),
        _ => reason(&error),
    })
}

/// The path behind all links, even if the last one leads to a file that does not exist.
fn follow_links(path: &Path) -> Option<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(link) => path = folder_of(&path).join(link),
            // Not a link, or not there.
            Err(_) => return Some(path),
        }
    }
    None
}

/// The temporary file that is being written now.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Removes the temporary file that is being written, if there is one.
pub fn remove_unfinished() {
    if let Some(path) = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).take() {
        let _ = fs::remove_file(path);
    }
}

fn write_beside(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lamplight-").suffix(".tmp");
    #[cfg(unix)]
    {
        // Like any new file, not only for its owner; the umask applies.
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
    // A file that is replaced passes its permissions on. Not every file system has them.
    if let Ok(metadata) = fs::metadata(target) {
        let _ = file.as_file().set_permissions(metadata.permissions());
    }
    let written = file.as_file_mut().write_all(bytes);
    let mut unfinished = lock();
    let done = written.and_then(|()| Ok(file.persist(target).map(drop)?));
    *unfinished = None;
    done
}

fn cannot_write(path: &Path, reason: String) -> CliError {
    CliError::failed(format_args!("cannot write {}: {reason}", path.display()))
}

fn cannot_make(directory: &Path, reason: String) -> CliError {
    let shown = directory.display();
    CliError::failed(format_args!("cannot make the directory {shown}: {reason}"))
}

fn is_a_directory(path: &Path) -> CliError {
    CliError::bad_input(format_args!("cannot write {}: it is a directory", path.display()))
}

/// The reason of an error, without the name of the temporary file.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        ErrorKind::NotFound => "there is no such directory".to_owned(),
        ErrorKind::StorageFull => "the disk is full".to_owned(),
        ErrorKind::ReadOnlyFilesystem => "the file system is read-only".to_owned(),
        // An error of the system as it is; others may hold the path of the temporary file.
        _ if error.raw_os_error().is_some() => error.to_string(),
        kind => kind.to_string(),
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().map_or(Path::new("."), or_here)
}

/// The current directory in place of an empty path.
fn or_here(path: &Path) -> &Path {
    if path.as_os_str().is_empty() { Path::new(".") } else { path }
}

/// A picture as the bytes of a PNG file.
pub fn png(picture: &RgbImage) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(picture, picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .map_err(|e| CliError::failed(format_args!("cannot encode a PNG: {e}")))?;
    Ok(bytes)
}

/// Linear pixels of some layers, in row order, as the bytes of an EXR file of 32-bit floats. The channels of the layer
/// `moment.x` are `moment.x.R`, `moment.x.G` and `moment.x.B`; those of a layer without a name, `R`, `G` and `B`.
pub fn exr(width: u32, height: u32, layers: &[(&str, Vec<Rgb>)]) -> Result<Vec<u8>> {
    let channel = |(layer, pixels): &(&str, Vec<Rgb>), c: usize| {
        let samples = pixels.iter().map(|rgb| rgb[c]).collect();
        let dot = if layer.is_empty() { "" } else { "." };
        let name = format!("{layer}{dot}{}", ["R", "G", "B"][c]);
        AnyChannel::new(name.as_str(), FlatSamples::F32(samples))
    };
    let channels = layers.iter().flat_map(|layer| (0..3).map(move |c| channel(layer, c)));
    let layer = Layer::new(
        (width as usize, height as usize),
        LayerAttributes::default(),
        Encoding::SMALL_FAST_LOSSLESS,
        AnyChannels::sort(channels.collect()),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| CliError::failed(format_args!("cannot encode an EXR: {e}")))?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_do_not_name_the_temporary_file() {
        // ENOSPC
        let full = io::Error::from_raw_os_error(28);
        #[cfg(unix)]
        assert_eq!(reason(&full), "the disk is full");
        // As the crate tempfile wraps it.
        let wrapped = io::Error::new(full.kind(), "at path \".lamplight-x.tmp\"");
        assert!(!reason(&wrapped).contains(".tmp"), "{}", reason(&wrapped));
        let wrapped = io::Error::new(ErrorKind::FileTooLarge, "at path \".lamplight-x.tmp\"");
        assert!(!reason(&wrapped).contains(".tmp"), "{}", reason(&wrapped));
    }
}
