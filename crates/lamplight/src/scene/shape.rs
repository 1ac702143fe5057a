//! Shapes: a geometry and its matter.

use super::Material;
use super::geometry::{Circle, Geometry, Line, Polygon, Rect, Sprite};
use crate::mask::ALL_LAYERS;
use crate::{Cells, Matter, Result, Rgb};
use crate::{check, mask, notation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A shape of a scene, drawn over what came before it.
///
/// A shape that lets light through, as glow, fog and glass do, covers each cell by the fraction of its area, which
/// scales the opacity: its light moves by parts of a px when it does. A solid shape covers the cells whose centre is
/// inside. [`Self::antialias`] chooses. A sprite covers by its image's alpha, and its image's colour multiplies
/// `emission`, `albedo` and `color`.
///
/// ```
/// use lamplight::{Scene, Shape};
/// let scene = Scene::new(64, 64)
///     .shape(Shape::circle([20.0, 20.0], 5.0).emission([4.0, 3.0, 2.0]))
///     .shape(Shape::rect([40.0, 10.0], [44.0, 54.0]).albedo([0.8, 0.2, 0.2]));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "ShapeFile", into = "ShapeFile")]
pub struct Shape {
    /// The area that it covers.
    pub geometry: Geometry,
    /// Radians, from +x towards +y, about the geometry's centre (of a line its middle, of a
    /// polygon the mean of its points).
    pub rotation: f32,
    /// Which cells to draw on.
    pub only: Only,
    /// Cover cells by the fraction of their area, or by their centres alone; `None`: by area what lets light through, by
    /// centres what is solid. The edge of a solid shape by area is fog in front of a wall: it looks smoother, and
    /// reflects down to half as much. Rectangles and lines of at least 1 px stay shut either way, wherever they lie.
    pub antialias: Option<bool>,
    /// Emitted radiance, linear RGB.
    pub emission: Rgb,
    /// Emission coefficient: radiance added per px, linear RGB. It needs no opacity, and solid matter has
    /// none.
    pub glow: Rgb,
    /// Fraction of light absorbed per px, 0 to 1; 1 is a solid wall.
    pub opacity: f32,
    /// Albedo: the fraction of arriving light that is reflected or scattered; `None` is 0.
    pub albedo: Option<Rgb>,
    /// Colour filter for each px crossed.
    pub tint: Rgb,
    /// The colour under the light in the final picture. `None`: the albedo if given, else white (of a
    /// sprite its image), painted on as far as the shape is opaque.
    pub color: Option<Rgb>,
    /// The layers of the cells that it covers by half or more, a bit each, 1 to 255: lamps and suns whose mask has none
    /// of them do not light these cells.
    pub mask: u8,
}

/// The cells that a shape is drawn on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Only {
    /// All that it covers.
    #[default]
    All,
    /// Those that are not solid, for fog among trees.
    Open,
}

impl Only {
    /// Returns whether a shape is drawn on a cell.
    pub(super) fn takes(self, cells: &Cells, index: usize) -> bool {
        match self {
            Self::All => true,
            Self::Open => !cells.is_solid(index),
        }
    }
}

impl Shape {
    /// A solid, black shape without reflection.
    pub fn new(geometry: Geometry) -> Self {
        Self {
            geometry,
            rotation: 0.0,
            only: Only::All,
            antialias: None,
            emission: [0.0; 3],
            glow: [0.0; 3],
            opacity: 1.0,
            albedo: None,
            tint: [1.0; 3],
            color: None,
            mask: ALL_LAYERS,
        }
    }

    /// A disc.
    pub fn circle(center: [f32; 2], radius: f32) -> Self {
        Self::new(Geometry::Circle(Circle { center, radius }))
    }

    /// A rectangle between two corners.
    pub fn rect(min: [f32; 2], max: [f32; 2]) -> Self {
        Self::new(Geometry::Rect(Rect::Corners { min, max }))
    }

    /// A polygon.
    pub fn polygon(points: impl Into<Vec<[f32; 2]>>) -> Self {
        Self::new(Geometry::Polygon(Polygon { points: points.into() }))
    }

    /// A thick line with straight ends.
    pub fn line(from: [f32; 2], to: [f32; 2], width: f32) -> Self {
        Self::new(Geometry::Line(Line { from, to, width }))
    }

    /// An image about a centre, one cell a px.
    pub fn sprite(image: impl Into<PathBuf>, center: [f32; 2]) -> Self {
        Self::new(Geometry::Sprite(Sprite { image: image.into(), center, scale: 1.0 }))
    }

    /// Sets the rotation in radians.
    #[must_use]
    pub fn rotation(self, rotation: f32) -> Self {
        Self { rotation, ..self }
    }

    /// Draws on open cells only, so that walls and solid lights keep what they are: fog, water, glow.
    #[must_use]
    pub fn only_open(self) -> Self {
        Self { only: Only::Open, ..self }
    }

    /// Covers cells by the fraction of their area, or by their centres alone.
    #[must_use]
    pub fn antialias(self, antialias: bool) -> Self {
        Self { antialias: Some(antialias), ..self }
    }

    /// Returns whether cells are covered by the fraction of their area.
    pub fn covers_by_area(&self) -> bool {
        self.antialias.unwrap_or(self.opacity < 1.0)
    }

    /// Sets all values of matter and the colour to a material's. Later calls replace single values.
    ///
    /// ```
    /// use lamplight::{Shape, scene::Material};
    /// let stained = Shape::rect([8.0, 0.0], [10.0, 32.0]).material(Material::Glass).tint([0.9, 0.2, 0.1]);
    /// assert_eq!(stained.opacity, Material::Glass.matter().opacity);
    /// ```
    #[must_use]
    pub fn material(self, material: Material) -> Self {
        let Matter { emission, glow, opacity, tint, albedo } = material.matter();
        let (albedo, color) = (Some(albedo), material.color());
        Self { emission, glow, opacity, tint, albedo, color, ..self }
    }

    /// Sets the emission, linear RGB.
    #[must_use]
    pub fn emission(self, emission: Rgb) -> Self {
        Self { emission, ..self }
    }

    /// Sets the emission coefficient, linear RGB per px, and the opacity to 0, because solid matter does
    /// not glow. Smoke that glows gets its opacity afterwards.
    #[must_use]
    pub fn glow(self, glow: Rgb) -> Self {
        Self { glow, opacity: 0.0, ..self }
    }

    /// Sets the opacity, 0 to 1.
    #[must_use]
    pub fn opacity(self, opacity: f32) -> Self {
        Self { opacity, ..self }
    }

    /// Sets the albedo, 0 to 1 a channel.
    #[must_use]
    pub fn albedo(self, albedo: Rgb) -> Self {
        Self { albedo: Some(albedo), ..self }
    }

    /// Sets the tint, 0 to 1 a channel.
    #[must_use]
    pub fn tint(self, tint: Rgb) -> Self {
        Self { tint, ..self }
    }

    /// Sets what the final picture shows, linear RGB 0 to 1.
    #[must_use]
    pub fn color(self, color: Rgb) -> Self {
        Self { color: Some(color), ..self }
    }

    /// Sets the layers, a bit each, of which lamps and suns light only those in their mask.
    #[must_use]
    pub fn mask(self, mask: u8) -> Self {
        Self { mask, ..self }
    }

    /// Returns the matter of the shape.
    pub fn matter(&self) -> Matter {
        Matter {
            emission: self.emission,
            glow: self.glow,
            opacity: self.opacity,
            tint: self.tint,
            albedo: self.albedo.unwrap_or_default(),
        }
    }

    /// Refuses values that no shape has; `key` names the shape in the message.
    pub(crate) fn check(&self, key: &str) -> Result<()> {
        self.geometry.check(key)?;
        check::number(format_args!("{key}.rotation"), self.rotation, -1e3..=1e3)?;
        check::radiance(format_args!("{key}.emission"), self.emission)?;
        check::radiance(format_args!("{key}.glow"), self.glow)?;
        check::number(format_args!("{key}.opacity"), self.opacity, 0.0..=1.0)?;
        check::unit(format_args!("{key}.albedo"), self.albedo.unwrap_or_default())?;
        check::unit(format_args!("{key}.tint"), self.tint)?;
        check::unit(format_args!("{key}.color"), self.color.unwrap_or_default())?;
        mask::check(format_args!("{key}.mask"), self.mask)
    }
}

/// A shape as a file has it: one key a geometry.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Shape", extend("oneOf" = one_of_the_geometries()))]
struct ShapeFile {
    /// A disc.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    circle: Option<Circle>,
    /// A rectangle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rect: Option<Rect>,
    /// A polygon.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    polygon: Option<Polygon>,
    /// A thick line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    line: Option<Line>,
    /// An image that gives shape by its alpha.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sprite: Option<Sprite>,
    /// Radians or `"30deg"`, from +x towards +y, about the shape's centre.
    #[serde(default, deserialize_with = "notation::angle", skip_serializing_if = "is_default")]
    #[schemars(with = "notation::Angle")]
    rotation: f32,
    /// Which cells to draw on.
    #[serde(default, skip_serializing_if = "is_default")]
    only: Only,
    /// Cover cells by the fraction of their area, or by their centres alone. Default: by area what lets light through,
    /// by centres what is solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    antialias: Option<bool>,
    /// A material, for the values below that the shape does not give itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    material: Option<Material>,
    /// Emitted radiance, linear RGB of 0 or more. Default: 0.
    #[serde(
        default,
        deserialize_with = "notation::optional_color",
        skip_serializing_if = "Option::is_none"
    )]
    #[schemars(with = "Option<notation::Color>")]
    emission: Option<Rgb>,
    /// Emission coefficient, linear RGB of 0 or more: radiance added per px, as by fire, with or without
    /// opacity. Default: 0.
    #[serde(
        default,
        deserialize_with = "notation::optional_color",
        skip_serializing_if = "Option::is_none"
    )]
    #[schemars(with = "Option<notation::Color>")]
    glow: Option<Rgb>,
    /// Fraction of light absorbed per px, 0 to 1; 1 is a solid wall. Default: 1, or 0 for a shape with
    /// `glow`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    opacity: Option<f32>,
    /// Albedo: the fraction of arriving light that is reflected or scattered, 0 to 1 per channel.
    /// Default: 0.
    #[serde(
        default,
        deserialize_with = "notation::optional_color",
        skip_serializing_if = "Option::is_none"
    )]
    #[schemars(with = "Option<notation::Color>")]
    albedo: Option<Rgb>,
    /// Colour filter for each px crossed, 0 to 1 per channel. Default: 1.
    #[serde(
        default,
        deserialize_with = "notation::optional_color",
        skip_serializing_if = "Option::is_none"
    )]
    #[schemars(with = "Option<notation::Color>")]
    tint: Option<Rgb>,
    /// The colour under the light in the final picture, linear RGB 0 to 1. Default: the albedo if
    /// given, else white (of a sprite its image), painted on as far as the shape is opaque.
    #[serde(
        default,
        deserialize_with = "notation::optional_color",
        skip_serializing_if = "Option::is_none"
    )]
    #[schemars(with = "Option<notation::Color>")]
    color: Option<Rgb>,
    /// The layers of the cells that it covers by half or more, a bit each, 1 to 255: lamps and suns whose mask
    /// has none of them do not light these cells. By default all.
    #[serde(default = "mask::all_layers", skip_serializing_if = "mask::is_all")]
    #[schemars(range(min = 1, max = 255))]
    mask: u8,
}

const GEOMETRIES: [&str; 5] = ["circle", "rect", "polygon", "line", "sprite"];

fn one_of_the_geometries() -> Vec<serde_json::Value> {
    GEOMETRIES.iter().map(|name| serde_json::json!({ "required": [name] })).collect()
}

/// A value as a file needs it: not where it is the default.
fn given(value: Rgb, default: Rgb) -> Option<Rgb> {
    Some(value).filter(|value| *value != default)
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl TryFrom<ShapeFile> for Shape {
    type Error = String;

    fn try_from(file: ShapeFile) -> Result<Self, String> {
        let given = [
            file.circle.map(Geometry::Circle),
            file.rect.map(Geometry::Rect),
            file.polygon.map(Geometry::Polygon),
            file.line.map(Geometry::Line),
            file.sprite.map(Geometry::Sprite),
        ];
        let names: Vec<&str> =
            given.iter().zip(GEOMETRIES).filter_map(|(g, name)| g.as_ref().map(|_| name)).collect();
        let mut given = given.into_iter().flatten();
        let (Some(geometry), None) = (given.next(), given.next()) else {
            let found =
                if names.is_empty() { "without a geometry".into() } else { names.join(" and ") };
            return Err(format!(
                "invalid value: {found}, expected exactly one of {}",
                GEOMETRIES.join(", ")
            ));
        };
        let base = Self::new(geometry);
        let base = match (file.material, file.glow) {
            (Some(material), _) => base.material(material),
            (None, Some(glow)) if glow != [0.0; 3] => base.glow(glow),
            (None, _) => base,
        };
        Ok(Self {
            rotation: file.rotation,
            only: file.only,
            antialias: file.antialias,
            emission: file.emission.unwrap_or(base.emission),
            glow: file.glow.unwrap_or(base.glow),
            opacity: file.opacity.unwrap_or(base.opacity),
            albedo: file.albedo.or(base.albedo),
            tint: file.tint.unwrap_or(base.tint),
            // The colour of a material follows the albedo: red leaves look red.
            color: file.color.or(base.color.map(|color| file.albedo.unwrap_or(color))),
            mask: file.mask,
            ..base
        })
    }
}

impl From<Shape> for ShapeFile {
    fn from(shape: Shape) -> Self {
        let mut file = Self {
            circle: None,
            rect: None,
            polygon: None,
            line: None,
            sprite: None,
            rotation: shape.rotation,
            only: shape.only,
            antialias: shape.antialias,
            material: None,
            emission: given(shape.emission, [0.0; 3]),
            glow: given(shape.glow, [0.0; 3]),
            opacity: Some(shape.opacity),
            albedo: shape.albedo,
            tint: given(shape.tint, [1.0; 3]),
            color: shape.color,
            mask: shape.mask,
        };
        match shape.geometry {
            Geometry::Circle(circle) => file.circle = Some(circle),
            Geometry::Rect(rect) => file.rect = Some(rect),
            Geometry::Polygon(polygon) => file.polygon = Some(polygon),
            Geometry::Line(line) => file.line = Some(line),
            Geometry::Sprite(sprite) => file.sprite = Some(sprite),
        }
        file
    }
}
