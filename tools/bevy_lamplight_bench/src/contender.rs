//! The compared plugins, and descriptions of their work.

use clap::ValueEnum;
use serde::Serialize;

/// A plugin with settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Contender {
    /// Bevy and the scene, unlit
    Unlit,
    /// bevy_lamplight as it comes
    Holographic,
    /// bevy_lamplight with the preset `fast`
    HolographicFast,
    /// bevy_lamplight with radiance cascades
    Cascades,
    /// bevy_light_2d
    Light2d,
}

impl Contender {
    /// The crate that lights, if any.
    pub fn package(self) -> Option<&'static str> {
        match self {
            Self::Unlit => None,
            Self::Holographic | Self::HolographicFast | Self::Cascades => Some("bevy_lamplight"),
            Self::Light2d => Some("bevy_light_2d"),
        }
    }

    /// Settings that its row names.
    fn variant(self) -> Option<&'static str> {
        match self {
            Self::Holographic => Some("`holographic`"),
            Self::HolographicFast => Some("`holographic`, `fast`"),
            Self::Cascades => Some("`cascades`"),
            _ => None,
        }
    }

    /// Its row's name.
    pub fn title(self) -> String {
        let Some(package) = self.package() else { return "no light at all".to_owned() };
        let version = locked_version(package);
        match self.variant() {
            Some(variant) => format!("{package} {version}, {variant}"),
            None => format!("{package} {version}"),
        }
    }

    /// A description of its drawing and of its cost, after its sources, in Markdown. `None` if the
    /// description of another contender covers it.
    pub fn draws(self) -> Option<&'static str> {
        match self {
            Self::Unlit => Some(
                "Bevy alone: a camera, one sprite as the ground, and an entity without a picture for each \
                 lamp and occluder. What is above this is what light costs.",
            ),
            Self::Holographic => Some(
                "Global illumination on a grid of half the target's resolution: every lamp has a size and \
                 soft shadows, walls reflect light and fog scatters it (one bounce here), and any sprite, \
                 text, mesh or tile may glow, block, filter or scatter. Lamps and occluders are drawn as \
                 instanced pieces on that grid, and light is found from the grid alone. `fast` takes fewer \
                 rays; `cascades` finds the same light by radiance cascades, softer, and traces nothing \
                 where all around is clear, so that sparse scenes take it less. No cap on lamps or \
                 occluders. Its camera has to be HDR.",
            ),
            Self::HolographicFast | Self::Cascades => None,
            Self::Light2d => Some(
                "Direct light with hard shadows; only lamps give light. Each pixel takes the distance to \
                 every occluder that a lamp reaches (a signed distance field of the target's size, \
                 computed in every frame), then visits every lamp and, where one is in range, marches that \
                 field in at most 32 steps. Occluders are upright rectangles; their insides get ambient light \
                 only. No cap where shaders have storage buffers; 82 point lights, 64 spots and 256 \
                 occluders in WebGL 2.",
            ),
        }
    }
}

/// The version that the workspace builds with.
pub fn locked_version(package: &str) -> &'static str {
    const LOCK: &str = include_str!("../../../Cargo.lock");
    let entry = format!("name = \"{package}\"\nversion = \"");
    LOCK.split_once(&entry)
        .and_then(|(_, rest)| rest.split_once('"'))
        .map(|(version, _)| version)
        .expect("what is measured is in the lock file")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_contender_has_a_version() {
        for contender in Contender::value_variants() {
            let digits = contender.title().chars().any(|c| c.is_ascii_digit());
            assert_eq!(digits, contender.package().is_some(), "{}", contender.title());
        }
    }
}
