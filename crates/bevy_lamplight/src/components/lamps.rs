//! Lamps, ambient light and the sky.

use bevy::log::warn_once;
use bevy::prelude::*;
use lamplight::{
    ALL_LAYERS, Cone, Cookie, Direct, Falloff, Gradient, Lamp, Panorama, Profile, Sky,
};
use std::f32::consts::{FRAC_PI_3, PI};

/// A lamp at an entity's position.
///
/// For the methods `holographic`, `cascades` and `raymarch` it is a small disc that emits light. Its
/// light falls off as light in a plane does. At a distance `d` in the open, the mean radiance is
///
/// ```text
/// color · intensity · range / (4 d)
/// ```
///
/// This is `intensity` at a quarter of the range and a quarter of it at the range. `polar` and `flood`
/// light lamps by rule: `intensity` at the lamp, nothing beyond the range. Matter around the
/// lamp blocks its light, and a lamp inside a wall gives none. The lamp itself blocks nothing.
///
/// A lamp of negative intensity takes light away where it would add it, down to black. Such lamps, and those with a
/// [`mask`](Self::mask), a [`height`](Self::height) or a [`LightCookie2d`](crate::LightCookie2d), are as bright as others
/// and end at their range. They cost as much time as a spot, and cannot be `solid` or `visible`.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform, Visibility)]
pub struct PointLight2d {
    /// Colour of the light.
    pub color: Color,
    /// Brightness; 0 is off. Below 0 the lamp takes light away.
    pub intensity: f32,
    /// Range, world units.
    pub range: f32,
    /// Radius of the disc, world units. Larger lamps have softer shadows and the same amount of light.
    /// A radius below two cells acts as two cells.
    pub radius: f32,
    /// Falloff with distance, for `polar` and `flood`.
    pub falloff: Falloff2d,
    /// If true, the lamp is a solid disc, which blocks the light of others.
    pub solid: bool,
    /// If true, the lamp itself is drawn, as a glowing disc.
    pub visible: bool,
    /// The light layers that it lights, a bit each: what has one of them in its [`LightMask2d`](crate::LightMask2d).
    /// 0 is off.
    pub mask: u8,
    /// Height above the plane, world units, for surfaces with a [`NormalMap2d`](crate::NormalMap2d): light is steep near the
    /// lamp and grazes far away. `None`: it arrives at the elevation of all light ([`Relief2d`](crate::Relief2d)). A lamp
    /// with a height ends at its range and costs as much time as a spot; its light on flat surfaces and its shadows do not
    /// depend on the height.
    pub height: Option<f32>,
}

impl Default for PointLight2d {
    fn default() -> Self {
        Self {
            color: Color::WHITE,
            intensity: 1.0,
            range: 128.0,
            radius: 8.0,
            falloff: Falloff2d::default(),
            solid: false,
            visible: false,
            mask: ALL_LAYERS,
            height: None,
        }
    }
}

/// A lamp that shines in one direction: along the entity's own x axis, which points to the right
/// without rotation.
///
/// Every method lights it as `polar` does: `intensity` at the lamp, fading to nothing at the range, with
/// shadows, glass and fog as for any light. In methods with bounces walls and fog send its light on.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform, Visibility)]
pub struct SpotLight2d {
    /// Colour of the light.
    pub color: Color,
    /// Brightness; 0 is off. Below 0 the lamp takes light away, down to black.
    pub intensity: f32,
    /// Range, world units.
    pub range: f32,
    /// Radius of the lamp, world units. Larger lamps have softer shadows.
    pub radius: f32,
    /// Angle of the cone from edge to edge, radians.
    pub angle: f32,
    /// Fraction of the cone, from the edge inwards, over which light fades, 0 to 1.
    pub softness: f32,
    /// Falloff with distance.
    pub falloff: Falloff2d,
    /// The brightness across the cone, as of a shade with holes: 2 to 16 values of 0 to 1 from edge to edge,
    /// counterclockwise, such as `vec![0.2, 1.0, 0.3, 1.0]`. Empty: even light.
    pub profile: Vec<f32>,
    /// The light layers that it lights, as in [`PointLight2d::mask`].
    pub mask: u8,
    /// Height above the plane, as in [`PointLight2d::height`].
    pub height: Option<f32>,
}

impl Default for SpotLight2d {
    fn default() -> Self {
        let PointLight2d { color, intensity, radius, falloff, mask, height, .. } =
            PointLight2d::default();
        let (range, angle, softness) = (256.0, FRAC_PI_3, 0.5);
        let profile = Vec::new();
        Self { color, intensity, range, radius, angle, softness, falloff, profile, mask, height }
    }
}

/// The falloff of a lamp up to its range ([`lamplight::Falloff`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Falloff2d {
    /// Linear.
    #[default]
    Linear,
    /// Smooth at both ends.
    Smooth,
    /// Inversely proportional to the distance, cut off at the range.
    Inverse,
}

impl From<Falloff2d> for Falloff {
    fn from(falloff: Falloff2d) -> Self {
        match falloff {
            Falloff2d::Linear => Self::Linear,
            Falloff2d::Smooth => Self::Smooth,
            Falloff2d::Inverse => Self::Inverse,
        }
    }
}

/// Constant light everywhere, also inside walls, so that nothing is black. Belongs on a camera with
/// [`Lighting2d`](crate::Lighting2d).
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct AmbientLight2d {
    /// Colour of the light.
    pub color: Color,
    /// Multiplies the colour.
    pub brightness: f32,
}

impl Default for AmbientLight2d {
    fn default() -> Self {
        Self { color: Color::WHITE, brightness: 0.1 }
    }
}

impl AmbientLight2d {
    /// Its radiance.
    pub(crate) fn radiance(&self) -> [f32; 3] {
        radiance(self.color, self.brightness)
    }
}

/// The light that enters the lit grid from outside: from above, the sides and below. Matter blocks it as
/// any other light. Belongs on a camera with [`Lighting2d`](crate::Lighting2d).
///
/// It suits outdoor scenes in side view. For views from above, which have no outside, see
/// [`AmbientLight2d`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Sky2d {
    /// Colour straight up.
    pub zenith: Color,
    /// Colour at the sides.
    pub horizon: Color,
    /// Colour straight down.
    pub ground: Color,
    /// Multiplies all three colours.
    pub brightness: f32,
}

impl Default for Sky2d {
    /// A clear day.
    fn default() -> Self {
        Self {
            zenith: Color::linear_rgb(0.3, 0.5, 1.0),
            horizon: Color::linear_rgb(0.7, 0.8, 1.0),
            ground: Color::BLACK,
            brightness: 1.0,
        }
    }
}

impl Sky2d {
    /// Converts to the sky of `lamplight`.
    pub(crate) fn sky(&self) -> Sky {
        let [zenith, horizon, ground] =
            [self.zenith, self.horizon, self.ground].map(|color| radiance(color, self.brightness));
        Sky::Gradient(Gradient { zenith, horizon, ground })
    }
}

/// The light that enters the lit grid from outside, differently all the way round: a warm horizon on one side, night on
/// the other. Belongs on a camera with [`Lighting2d`](crate::Lighting2d), in place of a [`Sky2d`].
///
/// Its colours are those of [`lamplight::Panorama`]: from straight down over the left, up (in the middle) and the right to
/// straight down again, evenly spread, and mixed in between. Without colours, or with more than
/// [`lamplight::Panorama::MAX_COLUMNS`], it is black.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Panorama2d {
    /// The colours, from left to right.
    pub columns: Vec<Color>,
    /// The angle by which the sky is turned, radians, counter-clockwise as all rotations in Bevy.
    pub turn: f32,
    /// Multiplies all colours.
    pub brightness: f32,
}

impl Default for Panorama2d {
    /// A black sky.
    fn default() -> Self {
        Self { columns: Vec::new(), turn: 0.0, brightness: 1.0 }
    }
}

impl Panorama2d {
    /// Converts to the sky of `lamplight`, which turns clockwise.
    pub(crate) fn sky(&self) -> Sky {
        let columns = self.columns.iter().map(|&color| radiance(color, self.brightness));
        let turn = if self.turn.is_finite() { -self.turn } else { 0.0 };
        let panorama = Panorama::new(&columns.collect::<Vec<_>>());
        panorama.map_or(Sky::BLACK, |panorama| panorama.turned(turn).into())
    }
}

/// The largest radiance that is drawn. It is below the largest half float, which leaves room for sums.
pub(crate) const BRIGHTEST: f32 = 60_000.0;

/// The radiance of a colour. Channels that are negative or not finite become 0.
pub(super) fn radiance(color: Color, brightness: f32) -> [f32; 3] {
    let LinearRgba { red, green, blue, .. } = color.to_linear();
    [red, green, blue].map(|v| v * brightness).map(|v| if v.is_finite() { v.max(0.0) } else { 0.0 })
}

/// A lamp of either kind, in world units.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WorldLamp {
    pub position: Vec2,
    pub color: [f32; 3],
    /// True if it takes light away.
    pub takes_light: bool,
    pub range: f32,
    pub radius: f32,
    pub falloff: Falloff2d,
    /// Direction (radians, y up), angle and softness of a spot.
    pub cone: Option<[f32; 3]>,
    /// The profile of a spot, as grids see it.
    pub profile: Option<Profile>,
    /// A cookie, turned as grids see it.
    pub cookie: Option<Cookie>,
    pub mask: u8,
    pub height: Option<f32>,
    pub solid: bool,
    pub visible: bool,
}

impl WorldLamp {
    /// `None` if the lamp is off or any of its values is not finite.
    pub fn point(lamp: &PointLight2d, transform: &GlobalTransform) -> Option<Self> {
        let PointLight2d { color, intensity, range, radius, falloff, solid, visible, mask, height } =
            *lamp;
        let position = transform.translation().truncate();
        let color = radiance(color, intensity.abs());
        let is_on = color != [0.0; 3] && mask != 0;
        let is_a_size = range.is_finite() && range > 0.0 && radius.is_finite() && radius >= 0.0;
        (is_a_size && position.is_finite() && is_on).then_some(Self {
            position,
            color,
            takes_light: intensity < 0.0,
            range,
            radius,
            falloff,
            cone: None,
            profile: None,
            cookie: None,
            mask,
            height: height.filter(|height| height.is_finite()),
            solid,
            visible,
        })
    }

    /// Like [`Self::point`], for a spot.
    pub fn spot(lamp: &SpotLight2d, transform: &GlobalTransform) -> Option<Self> {
        let SpotLight2d { color, intensity, range, radius, falloff, mask, height, .. } = *lamp;
        let point =
            PointLight2d { color, intensity, range, radius, falloff, mask, height, ..default() };
        let [ahead, aside] =
            [Vec3::X, Vec3::Y].map(|axis| transform.affine().transform_vector3(axis).truncate());
        let SpotLight2d { angle, softness, .. } = *lamp;
        let cone = [ahead.to_angle(), angle, softness];
        let profile = profile(&lamp.profile, ahead.perp_dot(aside) < 0.0);
        let lamp = Self::point(&point, transform)?;
        (cone.iter().all(|v| v.is_finite()) && ahead != Vec2::ZERO && angle > 0.0).then_some(Self {
            cone: Some(cone),
            profile,
            ..lamp
        })
    }

    /// Converts to a lamp of `lamplight`, on a grid whose top left corner lies at `corner` of the world. Methods that
    /// draw lamps draw it as a disc unless it is a spot; one that they cannot draw ([`Lamp::is_exact`]) has the light
    /// that its disc would have.
    pub fn on_grid(&self, corner: Vec2, cell: f32, by_rule: bool) -> Lamp {
        if by_rule || self.cone.is_some() {
            self.by_rule(corner, cell)
        } else {
            self.disc(corner, cell)
        }
    }

    /// The lamp with its own range and falloff.
    fn by_rule(&self, corner: Vec2, cell: f32) -> Lamp {
        let place = (self.position - corner) / cell;
        Lamp {
            position: [place.x, -place.y],
            color: self.color,
            intensity: if self.takes_light { -1.0 } else { 1.0 },
            range: (self.range / cell).clamp(1.0, 1e5),
            size: (self.radius / cell).clamp(0.05, 512.0),
            falloff: self.falloff.into(),
            cone: self.cone.map(|[direction, angle, softness]| Cone {
                direction: -direction,
                angle: angle.clamp(0.001, 2.0 * PI),
                softness: softness.clamp(0.0, 1.0),
                profile: self.profile,
            }),
            cookie: self.cookie.as_ref().map(|cookie| Cookie {
                size: (cookie.size / cell).clamp(0.1, 1e5),
                ..cookie.clone()
            }),
            height: self.height.map(|height| (height / cell).clamp(0.05, 1e5)),
            direct: Direct::Glow,
            mask: self.mask,
            solid: self.solid,
            visible: self.visible,
        }
    }

    /// The disc that represents it for methods that do not evaluate lamps. The disc's radiance replaces
    /// the colour. A disc of radius r and radiance L_e fills the fraction `2r / (2π d)` of all directions,
    /// so the mean radiance is `L_e · 2r / (2π d)`.
    fn disc(&self, corner: Vec2, cell: f32) -> Lamp {
        /// Cells. Rays miss smaller discs.
        const MIN_RADIUS: f32 = 2.0;
        let lamp = self.by_rule(corner, cell);
        let size = lamp.size.max(MIN_RADIUS);
        let gain = PI * self.range / (4.0 * size * cell);
        let color = self.color.map(|c| (c * gain).min(BRIGHTEST));
        // The falloff of a disc's light.
        Lamp { size, color, falloff: Falloff::Inverse, ..lamp }
    }
}

/// The profile of a spot on a grid, whose y points down; of one that its transform mirrors, the values are in their
/// order there. `None` without one, and for lists that are too short or too long.
fn profile(values: &[f32], is_mirrored: bool) -> Option<Profile> {
    if values.is_empty() {
        return None;
    }
    // NaN becomes 0, too.
    let mut values: Vec<_> =
        values.iter().map(|&v| if v > 0.0 { v.min(1.0) } else { 0.0 }).collect();
    if !is_mirrored {
        values.reverse();
    }
    let profile = Profile::new(&values);
    if profile.is_err() {
        let count = values.len();
        warn_once!("a `SpotLight2d::profile` of {count} values is ignored; valid are 2 to 16");
    }
    profile.ok()
}
