//! Decoded images, which the windows of a world share.

use super::picture::Picture;
use super::source::Source;
use crate::Result;
use crate::recent::{Bytes, RecentlyUsed};
use std::path::Path;
use std::sync::Arc;

/// The most bytes of pixels that a world keeps decoded. A larger image is kept alone.
pub const PICTURE_BYTES: u64 = 256 << 20;

/// Decoded images, each read when it is first needed.
#[derive(Debug)]
pub(crate) struct Pictures(RecentlyUsed<Picture>);

impl Bytes for Picture {
    fn bytes(&self) -> u64 {
        self.bytes()
    }
}

impl Default for Pictures {
    fn default() -> Self {
        Self(RecentlyUsed::new(PICTURE_BYTES))
    }
}

impl Pictures {
    /// Returns an image whose size `accept` does not reject, as [`Picture::open`].
    pub fn get(
        &self,
        source: Source,
        path: &Path,
        key: &str,
        mut accept: impl FnMut(u32, u32) -> Result<()>,
    ) -> Result<Arc<Picture>> {
        let picture = self.0.find_or(path, || Picture::open(source, path, key, &mut accept))?;
        // What was kept may have been read for another use.
        let [width, height] = picture.size();
        accept(width, height)?;
        Ok(picture)
    }
}
