//! Errors, one type per phase: creation, preparation, recording, reading back.

use std::fmt::Debug;

/// The result of planning a frame.
pub(crate) type Result<T, E = PrepareError> = std::result::Result<T, E>;

/// An error of any phase, for hosts that do not distinguish them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The library rejects something before it reaches the GPU.
    #[error(transparent)]
    Library(#[from] lamplight::Error),
    /// The device refuses something of the host's.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// Something could not be created.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A frame could not be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// A frame could not be recorded.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A result could not be read back.
    #[error(transparent)]
    ReadBack(#[from] ReadBackError),
}

/// Returns the error of a setting whose variant no shader has, because the library added it in a later
/// release.
pub(crate) fn unsupported(key: &str, variant: impl Debug) -> lamplight::Error {
    let expected = "a variant that this release of `lamplight-wgpu` has shaders for";
    lamplight::Error::value(key, format!("{variant:?}"), expected)
}

/// The device's reason to reject something.
#[derive(Debug, thiserror::Error)]
#[error("the device refuses: {0}")]
pub struct DeviceError(pub String);

/// The reason why something cannot be created or compiled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CreateError {
    /// The library rejects the settings.
    #[error(transparent)]
    Settings(#[from] lamplight::Error),
    /// An option is out of its range.
    #[error("the option `{name}` is {value}, not {range}")]
    Option {
        /// The option's name.
        name: &'static str,
        /// The value found.
        value: u32,
        /// The range of valid values.
        range: &'static str,
    },
    /// The device refuses, for a reason that only it knows.
    #[error(transparent)]
    Device(#[from] DeviceError),
}

/// The reason why a frame cannot be prepared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The library rejects the settings, the cells, the lamps, the sky or the display.
    #[error(transparent)]
    Input(#[from] lamplight::Error),
    /// The grid is larger than the device's limits allow.
    #[error(
        "a grid of {width}×{height} needs {needed} {what}, but this device allows {allowed}: request \
         higher limits of the adapter, or light a smaller grid"
    )]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The limit that is exceeded.
        what: &'static str,
        /// The amount that the grid needs.
        needed: u64,
        /// The amount that the device allows.
        allowed: u64,
    },
    /// A texture of the host's cannot be used.
    #[error("the texture `{name}` {problem}")]
    Texture {
        /// The texture's name.
        name: &'static str,
        /// The problem.
        problem: String,
    },
    /// The CPU lights the host's textures, and they could not be read.
    #[error("the matter is lit by the CPU: {0}")]
    ReadBack(#[from] ReadBackError),
    /// The device has no compute shaders or storage buffers, as under WebGL 2.
    #[error("this device has no compute shaders, which {what} needs")]
    NoCompute {
        /// The part of the frame that needs them.
        what: &'static str,
    },
    /// There is nothing to show: no frame has been prepared ([`crate::Lighting::prepare`]).
    #[error("there is no light to show: no frame has been prepared")]
    NothingLit,
    /// The device refuses, for a reason that only it knows.
    #[error(transparent)]
    Device(#[from] DeviceError),
}

/// The reason why a frame cannot be recorded.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// No frame has been prepared.
    #[error("nothing can be recorded before the first frame has been prepared")]
    NotPrepared,
}

/// The reason why a result cannot be read back.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadBackError {
    /// No frame has been prepared.
    #[error("cannot read from the GPU: nothing has been lit")]
    NothingLit,
    /// The light is that of a grid of another size than the one that it is asked for.
    #[error(
        "cannot read from the GPU: {}×{} cells were lit, but the light of {}×{} is asked for",
        lit[0], lit[1], asked[0], asked[1]
    )]
    OtherCells {
        /// Columns and rows of the cells that were lit.
        lit: [u32; 2],
        /// Columns and rows of the cells asked for.
        asked: [u32; 2],
    },
    /// The transfer failed.
    #[error("cannot read from the GPU: {0}")]
    Failed(String),
    /// The device refuses, for a reason that only it knows.
    #[error(transparent)]
    Device(#[from] DeviceError),
}
