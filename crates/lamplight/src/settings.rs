//! Every knob, with its default, its range and what higher and lower values cost.
//!
//! Settings come in layers: the defaults, what a scene file says under `[light]`, what flags say.
//! A layer is a [`SettingsTable`]; [`SettingsTable::resolve`] expands presets, refuses what is
//! unknown or out of range, and gives typed [`Settings`].

use crate::explain::explain;
use crate::{Error, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};
use std::borrow::Cow;
use std::fmt::{self, Display};
use std::ops::RangeInclusive;

/// How light is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Jump flood, distance field, rays from every pixel (Bigos 2020).
    #[default]
    Raymarch,
}

impl Method {
    /// Every method, in the order in which lists show them.
    pub const ALL: &'static [Self] = &[Self::Raymarch];

    /// The name in files, flags and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Raymarch => "raymarch",
        }
    }
}

/// How often light is sent on: a number, or `"converged"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Bounces {
    /// At most this many times; 0 is direct light only.
    Count(u32),
    /// Until the largest change is under 0.1 % of the mean.
    #[serde(serialize_with = "converged::serialize")]
    #[schemars(with = "converged::Word")]
    Converged,
}

impl Bounces {
    /// Most bounces that are ever made, so that even mirrors-for-walls scenes end.
    pub const MAX: u32 = 256;

    /// The most bounces to make.
    pub fn limit(self) -> u32 {
        match self {
            Self::Count(k) => k,
            Self::Converged => Self::MAX,
        }
    }
}

impl std::str::FromStr for Bounces {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text.parse() {
            Ok(k) if k <= Self::MAX => Ok(Self::Count(k)),
            _ if text == "converged" => Ok(Self::Converged),
            _ => Err(Error::value("bounces", text, "a whole number from 0 to 256, or `converged`")),
        }
    }
}

impl Default for Bounces {
    fn default() -> Self {
        Self::Count(0)
    }
}

mod converged {
    use super::*;

    #[derive(Serialize, JsonSchema)]
    #[serde(rename_all = "lowercase")]
    pub enum Word {
        Converged,
    }

    pub fn serialize<S: Serializer>(to: S) -> Result<S::Ok, S::Error> {
        Word::Converged.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Bounces {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Either;

        impl Visitor<'_> for Either {
            type Value = Bounces;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a whole number from 0 to 256, or \"converged\"")
            }

            fn visit_u64<E: serde::de::Error>(self, k: u64) -> Result<Bounces, E> {
                match u32::try_from(k) {
                    Ok(k) if k <= Bounces::MAX => Ok(Bounces::Count(k)),
                    _ => Err(E::invalid_value(Unexpected::Unsigned(k), &self)),
                }
            }

            fn visit_i64<E: serde::de::Error>(self, k: i64) -> Result<Bounces, E> {
                match u64::try_from(k) {
                    Ok(k) => self.visit_u64(k),
                    Err(_) => Err(E::invalid_value(Unexpected::Signed(k), &self)),
                }
            }

            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<Bounces, E> {
                match word {
                    "converged" => Ok(Bounces::Converged),
                    _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
                }
            }
        }

        from.deserialize_any(Either)
    }
}

/// Everything a solver can be told.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How light is found.
    pub method: Method,
    /// How often light is sent on by walls and fog, 0 to 256 or `"converged"`. Each bounce costs
    /// one more gather over the surfaces that reflect.
    pub bounces: Bounces,
    /// px that light sinks into solid walls, 0 to 64, so that they are seen and not black; 0
    /// lights only the cells that touch open space. Costs next to nothing.
    pub wall_depth: f32,
    /// Seed of everything random. The same seed gives the same bytes.
    pub seed: u64,
    /// Accumulation over frames.
    pub temporal: Temporal,
    /// The edge-aware blur after the rays.
    pub denoise: Denoise,
    /// The settings of `raymarch`.
    pub raymarch: Raymarch,
}

/// Mean over frames, with history dropped where what a pixel sees has changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Temporal {
    /// Most frames that the mean looks back, 0 to 4096; 0 or 1 is off. Higher: less noise on a
    /// still picture (about 1/√frames). Costs two copies of the light, no time to speak of.
    pub frames: u32,
    /// Drop history where emission, opacity, tint or albedo changed in what a pixel sees. Off: old
    /// light fades over `frames` frames and leaves trails.
    pub reject: bool,
}

impl Default for Temporal {
    fn default() -> Self {
        Self { frames: 0, reject: true }
    }
}

/// À-trous wavelet blur guided by opacity and distance; never crosses a wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Denoise {
    /// Passes, 0 to 6; each doubles the reach (3 reach 14 px, 5 reach 62). 0 is off. Higher:
    /// smoother with very few rays, blurrier shadows, a few ms a pass at 320×180. 3 suit 32 rays.
    pub passes: u32,
    /// How large a difference in light, against the noise, still counts as noise, 0 to 16. Higher:
    /// smoother; lower: keeps fine shadows and more noise. 1 has about the least error.
    pub strength: f32,
}

impl Default for Denoise {
    fn default() -> Self {
        Self { passes: 0, strength: 1.0 }
    }
}

/// Where rays start round the circle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Noise {
    /// An integer hash of pixel and frame: independent, blotchy.
    White,
    /// The project's spatio-temporal blue-noise texture: the same error, pushed to high
    /// frequencies in space and time, where eyes and blurs remove it.
    #[default]
    Blue,
    /// A low-discrepancy lattice over pixel and frame (the golden ratio and its sister in two
    /// dimensions, Roberts 2018).
    Golden,
}

/// From one ray to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Spacing {
    /// `2π/rays` apart: the least error for a given number.
    #[default]
    Even,
    /// The golden angle apart (seed 1): any prefix is spread well.
    Golden,
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hit {
    /// Exactly at the edge of a solid cell, with fog and glass on the way: converges to the truth.
    #[default]
    Edge,
    /// Where the distance field falls under `hit_distance`, as the seeds do: any occupied cell ends
    /// the ray, corners come out round.
    Distance,
}

/// How a raymarched bounce is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BounceBy {
    /// All bounces inside one frame.
    #[default]
    Frame,
    /// One more bounce each frame, from the light of the frame before (the seeds' way): `bounces`
    /// is then only on or off.
    Feedback,
}

/// The settings of `raymarch`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend("properties" = raymarch_preset_property()))]
pub struct Raymarch {
    /// Rays a pixel, 1 to 65536. Time grows with it; noise falls between 1/√rays and 1/rays.
    pub rays: u32,
    /// Most steps a ray makes, 1 to 65536 (a leap by the distance field or one cell is a step). Low
    /// values are faster and darken what lies far or behind fog.
    pub steps: u32,
    /// Where a ray ends.
    pub hit: Hit,
    /// With `hit = "distance"`: px from a surface at which a ray has arrived, 0.01 to 4. Higher:
    /// rounder and fatter shapes.
    pub hit_distance: f32,
    /// With `hit = "distance"`: the least px that a ray advances, 0.1 to 8. Higher is faster and
    /// misses corners (never whole cells).
    pub least_step: f32,
    /// Where rays start round the circle.
    pub noise: Noise,
    /// From one ray to the next.
    pub spacing: Spacing,
    /// Multiplies all emission, 0 to 1000 (seed 1: 1, its demo 1.5).
    pub emission_multiplier: f32,
    /// Fade emission with distance d by `max(1 − (d/range)², 0)^dropoff` (seed 1). Not physical,
    /// so off by default; adds nothing to the cost.
    pub attenuation: bool,
    /// Range of the attenuation in heights of the grid, 0.001 to 1000.
    pub emission_range: f32,
    /// Exponent of the attenuation, 0 to 16.
    pub emission_dropoff: f32,
    /// Opacity above which a cell is occupied in the seed map, 0 to 0.999. With `hit = "edge"`
    /// cells at or under it are passed as if empty.
    pub threshold: f32,
    /// How a bounce is made.
    pub bounce: BounceBy,
}

impl Default for Raymarch {
    fn default() -> Self {
        Self {
            rays: 32,
            steps: 4096,
            hit: Hit::Edge,
            hit_distance: 0.5,
            least_step: 1.0,
            noise: Noise::Blue,
            spacing: Spacing::Even,
            emission_multiplier: 1.0,
            attenuation: false,
            emission_range: 2.0,
            emission_dropoff: 2.0,
            threshold: 0.0,
            bounce: BounceBy::Frame,
        }
    }
}

impl Raymarch {
    /// Names of the presets.
    pub const PRESETS: [&'static str; 3] = ["default", "godot", "unity"];

    /// A preset by name: `default`; `godot`, seed 1's demo settings (Bigos 2020: 32 rays a golden
    /// angle apart, 128 steps, white noise, feedback bounce); `unity`, seed 2's (16 rays evenly
    /// apart, 16 steps, hit at 0.8 px).
    pub fn preset(name: &str) -> Option<Self> {
        let seed1 = Self {
            steps: 128,
            hit: Hit::Distance,
            noise: Noise::White,
            spacing: Spacing::Golden,
            bounce: BounceBy::Feedback,
            ..Self::default()
        };
        match name {
            "default" => Some(Self::default()),
            "godot" => Some(seed1),
            "unity" => Some(Self {
                rays: 16,
                steps: 16,
                hit_distance: 0.8,
                spacing: Spacing::Even,
                ..seed1
            }),
            _ => None,
        }
    }
}

fn raymarch_preset_property() -> Value {
    serde_json::json!({ "preset": {
        "description": "Starting point that the other keys change.",
        "enum": Raymarch::PRESETS,
    } })
}

impl Settings {
    /// Refuses values out of their range.
    pub fn check(&self) -> Result<()> {
        within("bounces", self.bounces.limit(), 0..=Bounces::MAX)?;
        within("wall_depth", self.wall_depth, 0.0..=64.0)?;
        within("temporal.frames", self.temporal.frames, 0..=4096)?;
        within("denoise.passes", self.denoise.passes, 0..=6)?;
        within("denoise.strength", self.denoise.strength, 0.0..=16.0)?;
        let r = &self.raymarch;
        within("raymarch.rays", r.rays, 1..=65_536)?;
        within("raymarch.steps", r.steps, 1..=65_536)?;
        within("raymarch.hit_distance", r.hit_distance, 0.01..=4.0)?;
        within("raymarch.least_step", r.least_step, 0.1..=8.0)?;
        within("raymarch.emission_multiplier", r.emission_multiplier, 0.0..=1000.0)?;
        within("raymarch.emission_range", r.emission_range, 0.001..=1000.0)?;
        within("raymarch.emission_dropoff", r.emission_dropoff, 0.0..=16.0)?;
        within("raymarch.threshold", r.threshold, 0.0..=0.999)
    }
}

fn within<T: PartialOrd + Display>(key: &str, value: T, range: RangeInclusive<T>) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(Error::value(key, value, format!("from {} to {}", range.start(), range.end())))
}

/// Settings as a file or a command line writes them: only the keys that were named.
///
/// Tables are laid over one another with [`Self::merge`]; [`Self::resolve`] makes [`Settings`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SettingsTable(Map<String, Value>);

impl JsonSchema for SettingsTable {
    fn schema_name() -> Cow<'static, str> {
        Settings::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Settings::json_schema(generator)
    }
}

impl SettingsTable {
    /// Whether nothing was named.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Sets one key, such as `raymarch.rays`, to a value.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) {
        let value = key.rsplit('.').fold(value.into(), |inner, name| {
            Value::Object(Map::from_iter([(name.to_owned(), inner)]))
        });
        if let Value::Object(table) = value {
            merge(&mut self.0, table);
        }
    }

    /// Sets what `key=value` says, as in `--set raymarch.rays=64`; the value is TOML, and a word
    /// without quotes is a string.
    pub fn set_from_text(&mut self, text: &str) -> Result<()> {
        let (key, value) = text
            .split_once('=')
            .filter(|(key, _)| key.split('.').all(|name| !name.trim().is_empty()))
            .ok_or_else(|| Error::value("--set", text, "of the form method.key=value"))?;
        let value = value.trim();
        let parsed = toml::from_str::<Map<String, Value>>(&format!("v = {value}"))
            .ok()
            .and_then(|mut table| table.remove("v"));
        self.set(key.trim(), parsed.unwrap_or_else(|| Value::String(value.to_owned())));
        Ok(())
    }

    /// Lays another table over this one: its keys win. A preset there comes after, and so undoes,
    /// the keys of its method here.
    pub fn merge(&mut self, over: Self) {
        merge(&mut self.0, over.0);
    }

    /// Expands presets, refuses unknown keys and values out of range.
    pub fn resolve(&self) -> Result<Settings> {
        let mut table = self.0.clone();
        if let Some(Value::Object(raymarch)) = table.get_mut("raymarch") {
            expand_preset(raymarch, "raymarch", &Raymarch::PRESETS, Raymarch::preset)?;
        }
        let value = Value::Object(table);
        let settings: Settings = serde_path_to_error::deserialize(&value).map_err(|e| {
            let path = e.path().to_string();
            explain(&path, &e.into_inner().to_string())
        })?;
        settings.check()?;
        Ok(settings)
    }
}

fn merge(under: &mut Map<String, Value>, over: Map<String, Value>) {
    if over.contains_key("preset") {
        under.clear();
    }
    for (key, value) in over {
        match (under.get_mut(&key), value) {
            (Some(Value::Object(old)), Value::Object(new)) => merge(old, new),
            (_, value) => {
                under.insert(key, value);
            }
        }
    }
}

/// Replaces the key `preset` by the keys it stands for; keys written beside it win.
fn expand_preset<T: Serialize>(
    table: &mut Map<String, Value>,
    method: &str,
    names: &[&str],
    preset: impl Fn(&str) -> Option<T>,
) -> Result<()> {
    let Some(name) = table.remove("preset") else { return Ok(()) };
    let base = name.as_str().and_then(preset).and_then(|p| serde_json::to_value(p).ok());
    let Some(Value::Object(base)) = base else {
        let expected = format!("one of {}", names.join(", "));
        return Err(Error::value(format!("{method}.preset"), name, expected));
    };
    for (key, value) in base {
        table.entry(key).or_insert(value);
    }
    Ok(())
}
