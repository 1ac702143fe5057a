//! Lamps: small lights that block nothing.
//!
//! `polar` and `flood` light lamps by rule, with range, falloff and cone. The other methods read matter, into
//! which lamps are drawn as glowing discs (`lamp_discs.rs`): light falls off as in the plane, without a range.
//! Matter cannot emit in a cone or a picture, choose whom it lights, take light away, or hang above the plane. So lamps
//! with a cone, a cookie, a mask or a height, those of negative intensity, and others that ask for it ([`Direct::Exact`]),
//! are lit by their shadow map instead, as in `polar`, and what they light reflects and scatters as all light does
//! (`stages/direct.rs`).
//!
//! A cone's profile multiplies light by its angle, a cookie (`cookie.rs`) by its place on the plane.

use crate::mask::ALL_LAYERS;
use crate::{Cookie, Profile, Result, Rgb, check, exact, mask, notation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f32::consts::{PI, TAU};
use std::fmt::Display;

/// The falloff of a lamp with distance, in the methods that light lamps by rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Falloff {
    /// `1 − d/range`.
    Linear,
    /// `(1 − (d/range)²)²`.
    Smooth,
    /// `asin(size/d)/π · (1 − (d/range)⁴)²`: the light of a glowing disc in two dimensions, which
    /// is about `size/(π·d)`, brought to 0 at the range by the window of Karis (2013, "Real Shading
    /// in Unreal Engine 4", equation 9). Far from the range it agrees with the drawn disc.
    #[default]
    Inverse,
}

impl Falloff {
    /// The fraction of `color · intensity` that reaches a point in the open, `distance` px from the
    /// lamp's centre.
    pub fn at(self, distance: f32, lamp: &Lamp) -> f32 {
        let u = distance / lamp.range;
        if u >= 1.0 {
            return 0.0;
        }
        match self {
            Self::Linear => 1.0 - u,
            Self::Smooth => (1.0 - u * u).powi(2),
            Self::Inverse => {
                let seen = (lamp.size / distance.max(lamp.size)).asin() / PI;
                seen * (1.0 - (u * u).powi(2)).powi(2)
            }
        }
    }
}

/// The way in which methods that draw lamps and suns find the direct light of one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Direct {
    /// As a glowing disc, or of a sun as part of the sky: for nothing, and without a range.
    #[default]
    Glow,
    /// By a shadow map, as in `polar`: sharp edges, and of a lamp a range and a falloff.
    Exact,
}

/// The cone of a spotlight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// The direction of the axis, radians from +x towards +y (down), −2π to 2π.
    #[serde(deserialize_with = "notation::angle")]
    #[schemars(with = "notation::Angle")]
    pub direction: f32,
    /// The angle from edge to edge, radians, 0.001 to 2π (twice the outer cone angle of glTF).
    #[serde(deserialize_with = "notation::angle")]
    #[schemars(with = "notation::Angle")]
    pub angle: f32,
    /// The fraction of the half angle, measured from the edge inwards, over which light fades, 0 to 1:
    /// 0 is a hard edge, 1 fades from the axis on.
    #[serde(default)]
    pub softness: f32,
    /// The brightness from edge to edge, in the direction of growing angles, 2 to 16 values of 0 to 1, such as
    /// `[0.2, 1.0, 0.3, 1.0]`; without it the light is even.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
}

impl Cone {
    /// The fraction of the lamp's light at an angle (radians): 1 inside, 0 outside, smoothstep over
    /// the soft edge; times its profile.
    pub fn share(&self, angle: f32) -> f32 {
        let inside = -self.outside(angle);
        if inside < 0.0 {
            return 0.0;
        }
        let profile =
            self.profile.map_or(1.0, |profile| profile.at(self.beside(angle) / self.angle + 0.5));
        let soft = self.softness * 0.5 * self.angle;
        if inside >= soft {
            return profile;
        }
        let t = inside / soft;
        t * t * (3.0 - 2.0 * t) * profile
    }

    /// The distance of an angle from the axis, radians, −π to π.
    fn beside(&self, angle: f32) -> f32 {
        let turned = (angle - self.direction).rem_euclid(TAU);
        if turned > PI { turned - TAU } else { turned }
    }

    /// The distance of an angle from the cone, radians; below 0 inside.
    pub(crate) fn outside(&self, angle: f32) -> f32 {
        self.beside(angle).abs() - 0.5 * self.angle
    }

    fn check(&self, key: &dyn Display) -> Result<()> {
        check::direction(format_args!("{key}.direction"), self.direction)?;
        check::number(format_args!("{key}.angle"), self.angle, 1e-3..=check::TURN)?;
        check::number(format_args!("{key}.softness"), self.softness, 0.0..=1.0)?;
        self.profile.map_or(Ok(()), |profile| profile.check(&format_args!("{key}.profile")))
    }
}

/// A point, spot or disc light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lamp {
    /// The centre, px.
    #[serde(deserialize_with = "exact::one")]
    pub position: [f32; 2],
    /// The colour, linear RGB.
    #[serde(default = "default_color", deserialize_with = "notation::color")]
    #[schemars(with = "notation::Color")]
    pub color: Rgb,
    /// Factor on the colour, −1e6 to 1e6; 0 is off. `color · intensity` is the radiance of the ideal disc,
    /// whose radius R gives about `radiance·R/(π·d)` of light at distance d. Below 0 the lamp takes light away
    /// where it would add it, down to black, and is `exact`.
    #[serde(default = "default_intensity")]
    pub intensity: f32,
    /// The range in px, 1 to 100 000, of lamps that are lit by rule: all of them in `polar` and `flood`,
    /// elsewhere those that are `exact`.
    #[serde(default = "default_range")]
    pub range: f32,
    /// The radius of the disc in px, 0.05 to 512. Higher: more light and softer shadows.
    #[serde(default = "default_size")]
    pub size: f32,
    /// The falloff of lamps that are lit by rule, as for `range`.
    #[serde(default)]
    pub falloff: Falloff,
    /// The cone of a spotlight, such as `{ direction = "90deg", angle = "45deg", softness = 0.3 }`; without
    /// it the lamp shines in all directions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cone: Option<Cone>,
    /// A picture on the plane around it, which multiplies its direct light, such as
    /// `{ picture = "leaves.png", size = 120, turn = "30deg" }`. A lamp with a cookie is `exact`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cookie: Option<Cookie>,
    /// Its height above the plane in px, 0.05 to 100 000, for surfaces with normals: at distance d its light arrives at
    /// the elevation `atan(height/d)`, steep nearby and grazing far away. Without it, at the elevation of all light. A
    /// lamp with a height is `exact`. Light itself and its shadows do not depend on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f32>,
    /// The way in which its direct light is found. Lamps with a cone, a cookie, a mask or a height, and those that
    /// take light away, are always `exact`. `glow` costs nothing; `exact` has sharper edges, and costs as much as a lamp of
    /// `polar`: time in proportion to the square of the range.
    #[serde(default, skip_serializing_if = "is_glow")]
    pub direct: Direct,
    /// The layers whose cells it lights, a bit each, 1 to 255. By default all; a lamp that lights only some is
    /// `exact`.
    #[serde(default = "mask::all_layers", skip_serializing_if = "mask::is_all")]
    #[schemars(range(min = 1, max = 255))]
    pub mask: u8,
    /// If true, the lamp is a solid disc, which blocks the light of others. Only for the methods that
    /// draw lamps, and not for lamps that are `exact`.
    #[serde(default, skip_serializing_if = "is_false")]
    pub solid: bool,
    /// If true, the final picture shows the lamp itself, as a disc of its radiance.
    #[serde(default, skip_serializing_if = "is_false")]
    pub visible: bool,
}

fn is_false(value: &bool) -> bool {
    !value
}

fn is_glow(direct: &Direct) -> bool {
    *direct == Direct::Glow
}

fn default_color() -> Rgb {
    Lamp::default().color
}

fn default_intensity() -> f32 {
    Lamp::default().intensity
}

fn default_range() -> f32 {
    Lamp::default().range
}

fn default_size() -> f32 {
    Lamp::default().size
}

impl Default for Lamp {
    fn default() -> Self {
        Self {
            position: [0.0; 2],
            color: [1.0; 3],
            intensity: 12.0,
            range: 256.0,
            size: 3.0,
            falloff: Falloff::Inverse,
            cone: None,
            cookie: None,
            height: None,
            direct: Direct::Glow,
            mask: ALL_LAYERS,
            solid: false,
            visible: false,
        }
    }
}

impl Lamp {
    /// Validates the lamp; `key` names it in the error.
    pub fn check(&self, key: &dyn Display) -> Result<()> {
        let cookie = self.cookie.as_ref();
        cookie.map_or(Ok(()), |cookie| cookie.check(&format_args!("{key}.cookie")))?;
        self.check_in_scene(key)
    }

    /// Validates the lamp of a scene, whose cookie has not been read yet.
    pub(crate) fn check_in_scene(&self, key: &dyn Display) -> Result<()> {
        check::point(format_args!("{key}.position"), self.position)?;
        check::radiance(format_args!("{key}.color"), self.color)?;
        check::number(format_args!("{key}.intensity"), self.intensity, -1e6..=1e6)?;
        check::number(format_args!("{key}.range"), self.range, 1.0..=1e5)?;
        check::number(format_args!("{key}.size"), self.size, 0.05..=512.0)?;
        if let Some(height) = self.height {
            check::number(format_args!("{key}.height"), height, 0.05..=1e5)?;
        }
        mask::check(format_args!("{key}.mask"), self.mask)?;
        if let Some(cookie) = &self.cookie {
            cookie.check_in_scene(&format_args!("{key}.cookie"))?;
        }
        self.cone.map_or(Ok(()), |cone| cone.check(&format_args!("{key}.cone")))
    }

    /// The radiance of the ideal disc, `color · intensity`.
    pub(crate) fn radiance(&self) -> Rgb {
        self.color.map(|c| c * self.intensity)
    }

    /// Returns whether the lamp is lit by a shadow map in every method, not drawn.
    pub fn is_exact(&self) -> bool {
        self.cone.is_some() || self.direct == Direct::Exact || !self.shines_as_matter()
    }

    /// Returns whether the lamp lights all layers, has no cookie, takes no light away and lies in the plane: as glowing
    /// matter does.
    pub fn shines_as_matter(&self) -> bool {
        let is_plain = self.cookie.is_none() && self.height.is_none();
        is_plain && self.mask == ALL_LAYERS && !self.takes_light()
    }

    /// Returns whether the lamp takes light away.
    pub fn takes_light(&self) -> bool {
        self.intensity < 0.0
    }

    /// Returns whether the lamp emits no light.
    pub fn is_off(&self) -> bool {
        self.intensity == 0.0 || self.color == [0.0; 3]
    }
}
