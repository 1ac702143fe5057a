//! Everything that can go wrong, as one typed enum.

/// Shorthand for results of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why light cannot be found on this GPU.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The library refuses the settings or the cells.
    #[error(transparent)]
    Refused(#[from] lamplight::Error),
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
        /// Which limit.
        what: &'static str,
        /// What the grid needs.
        needed: u64,
        /// What the device allows.
        allowed: u64,
    },
    /// A texture of the host's cannot be used.
    #[error("the texture `{name}` {problem}")]
    Texture {
        /// Which one.
        name: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// An option is out of its range.
    #[error("the option `{name}` is {value}, not {range}")]
    Option {
        /// Which one.
        name: &'static str,
        /// What it is.
        value: u32,
        /// What it may be.
        range: &'static str,
    },
    /// The device refuses what was to be made on it, for a reason that only it knows.
    #[error("the device refuses: {0}")]
    Device(String),
    /// What the GPU computed could not be fetched.
    #[error("cannot read from the GPU: {0}")]
    ReadBack(String),
}
