//! The geometries of shapes, as checked data.

use super::coverage::Point;
use crate::{Error, Result};
use crate::{check, exact};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The largest number of points of a polygon: rasterising costs rows × points.
const MAX_POINTS: usize = 10_000;

/// The area that a shape covers. All lengths are in px.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Geometry {
    /// A disc.
    Circle(Circle),
    /// A rectangle.
    Rect(Rect),
    /// A polygon.
    Polygon(Polygon),
    /// A thick line.
    Line(Line),
    /// An image.
    Sprite(Sprite),
}

/// A disc.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Its centre.
    #[serde(deserialize_with = "exact::one")]
    pub center: [f32; 2],
    /// Its radius, more than 0.
    pub radius: f32,
}

/// A rectangle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "RectFile", into = "RectFile")]
pub enum Rect {
    /// Between two corners.
    Corners {
        /// The corner of the least x and y.
        min: [f32; 2],
        /// The corner of the greatest x and y.
        max: [f32; 2],
    },
    /// About a centre.
    Sized {
        /// The centre.
        center: [f32; 2],
        /// Width and height, more than 0.
        size: [f32; 2],
    },
}

/// A polygon, filled where its outline winds round; it closes by itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Polygon {
    /// Its corners in order, 3 to 10 000, not all on one line.
    #[serde(deserialize_with = "exact::list")]
    pub points: Vec<[f32; 2]>,
}

/// A thick line with straight ends. It is a wall without holes from a width of 1 on; a slanted one without
/// antialiasing from 1.5 on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// The middle of its start.
    #[serde(deserialize_with = "exact::one")]
    pub from: [f32; 2],
    /// The middle of its end.
    #[serde(deserialize_with = "exact::one")]
    pub to: [f32; 2],
    /// Its width, more than 0.
    pub width: f32,
}

/// An image whose alpha is the shape. Its mean over a cell, of 16 points, is the coverage; without antialiasing, an
/// alpha of ½ or more at the cell's centre covers it fully.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sprite {
    /// A PNG or EXR; a relative path starts at the scene file's folder.
    pub image: PathBuf,
    /// The position of the middle of the image.
    #[serde(deserialize_with = "exact::one")]
    pub center: [f32; 2],
    /// Cells per px of the image, 0.001 to 1000.
    #[serde(default = "full_scale")]
    pub scale: f32,
}

fn full_scale() -> f32 {
    1.0
}

impl Geometry {
    /// Rejects shapes without extent and values that are not numbers.
    pub(crate) fn check(&self, key: &str) -> Result<()> {
        match self {
            Self::Circle(c) => {
                check::point(format_args!("{key}.circle.center"), c.center)?;
                check::length(format_args!("{key}.circle.radius"), c.radius)
            }
            Self::Rect(Rect::Corners { min, max }) => {
                check::point(format_args!("{key}.rect.min"), *min)?;
                check::point(format_args!("{key}.rect.max"), *max)?;
                if max[0] > min[0] && max[1] > min[1] {
                    return Ok(());
                }
                let expected = format!("greater than `min` [{}, {}] in x and y", min[0], min[1]);
                let found = format!("[{}, {}]", max[0], max[1]);
                Err(Error::value(format!("{key}.rect.max"), found, expected))
            }
            Self::Rect(Rect::Sized { center, size }) => {
                check::point(format_args!("{key}.rect.center"), *center)?;
                check::length(format_args!("{key}.rect.size[0]"), size[0])?;
                check::length(format_args!("{key}.rect.size[1]"), size[1])
            }
            Self::Polygon(polygon) => polygon.check(&format!("{key}.polygon.points")),
            Self::Line(line) => {
                check::point(format_args!("{key}.line.from"), line.from)?;
                check::point(format_args!("{key}.line.to"), line.to)?;
                check::length(format_args!("{key}.line.width"), line.width)?;
                if line.from != line.to {
                    return Ok(());
                }
                let found = format!("[{}, {}]", line.to[0], line.to[1]);
                Err(Error::value(format!("{key}.line.to"), found, "another point than `from`"))
            }
            Self::Sprite(sprite) => {
                check::image(format_args!("{key}.sprite.image"), &sprite.image)?;
                check::point(format_args!("{key}.sprite.center"), sprite.center)?;
                check::number(format_args!("{key}.sprite.scale"), sprite.scale, 0.001..=1000.0)
            }
        }
    }

    /// The corners of what is bounded by straight lines, turned about its centre.
    pub(crate) fn outline(&self, rotation: f32) -> Option<Vec<Point>> {
        let wide = |p: [f32; 2]| p.map(f64::from);
        let boxed = |[x0, y0]: Point, [x1, y1]: Point| vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        let (points, center) = match self {
            Self::Circle(_) | Self::Sprite(_) => return None,
            Self::Rect(rect) => {
                let (min, max) = match *rect {
                    Rect::Corners { min, max } => (wide(min), wide(max)),
                    Rect::Sized { center, size } => {
                        let (c, s) = (wide(center), wide(size));
                        ([0, 1].map(|i| c[i] - s[i] / 2.0), [0, 1].map(|i| c[i] + s[i] / 2.0))
                    }
                };
                (boxed(min, max), [0, 1].map(|i| (min[i] + max[i]) / 2.0))
            }
            Self::Polygon(polygon) => {
                let points: Vec<Point> = polygon.points.iter().map(|&p| wide(p)).collect();
                let n = points.len() as f64;
                let center = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
                (points, center)
            }
            Self::Line(line) => {
                let (a, b) = (wide(line.from), wide(line.to));
                let along = [b[0] - a[0], b[1] - a[1]];
                let half = f64::from(line.width) / 2.0 / along[0].hypot(along[1]);
                let [nx, ny] = [-along[1] * half, along[0] * half];
                let points = vec![
                    [a[0] + nx, a[1] + ny],
                    [b[0] + nx, b[1] + ny],
                    [b[0] - nx, b[1] - ny],
                    [a[0] - nx, a[1] - ny],
                ];
                (points, [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0])
            }
        };
        let (sin, cos) = f64::from(rotation).sin_cos();
        let turn = |[x, y]: Point| {
            let (dx, dy) = (x - center[0], y - center[1]);
            [center[0] + cos * dx - sin * dy, center[1] + sin * dx + cos * dy]
        };
        Some(if rotation == 0.0 { points } else { points.into_iter().map(turn).collect() })
    }
}

impl Polygon {
    fn check(&self, key: &str) -> Result<()> {
        let n = self.points.len();
        if !(3..=MAX_POINTS).contains(&n) {
            let found = format!("a list of {n} points");
            return Err(Error::value(key, found, format!("a list of 3 to {MAX_POINTS} points")));
        }
        for (i, &point) in self.points.iter().enumerate() {
            check::point(format_args!("{key}[{i}]"), point)?;
        }
        let [ox, oy] = self.points[0];
        let far = self.points.iter().map(|p| [p[0] - ox, p[1] - oy]).max_by(|a, b| {
            let length = |p: &[f32; 2]| p[0].hypot(p[1]);
            length(a).total_cmp(&length(b))
        });
        let [fx, fy] = far.unwrap_or_default();
        if self.points.iter().all(|p| (p[0] - ox) * fy == (p[1] - oy) * fx) {
            return Err(Error::value(key, "all on one line", "corners that enclose an area"));
        }
        Ok(())
    }
}

/// A rectangle as a file has it.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Rect", extend("oneOf" = [
    { "required": ["min", "max"] }, { "required": ["center", "size"] }
]))]
struct RectFile {
    /// The corner of the least x and y; with `max`.
    #[serde(default, deserialize_with = "exact::option", skip_serializing_if = "Option::is_none")]
    min: Option<[f32; 2]>,
    /// The corner of the greatest x and y; with `min`.
    #[serde(default, deserialize_with = "exact::option", skip_serializing_if = "Option::is_none")]
    max: Option<[f32; 2]>,
    /// The centre; with `size`.
    #[serde(default, deserialize_with = "exact::option", skip_serializing_if = "Option::is_none")]
    center: Option<[f32; 2]>,
    /// Width and height; with `center`.
    #[serde(default, deserialize_with = "exact::option", skip_serializing_if = "Option::is_none")]
    size: Option<[f32; 2]>,
}

impl TryFrom<RectFile> for Rect {
    type Error = String;

    fn try_from(file: RectFile) -> Result<Self, String> {
        match file {
            RectFile { min: Some(min), max: Some(max), center: None, size: None } => {
                Ok(Self::Corners { min, max })
            }
            RectFile { min: None, max: None, center: Some(center), size: Some(size) } => {
                Ok(Self::Sized { center, size })
            }
            RectFile { min, max, center, size } => {
                let given = [
                    ("min", min.is_some()),
                    ("max", max.is_some()),
                    ("center", center.is_some()),
                    ("size", size.is_some()),
                ];
                let names: Vec<&str> = given.iter().filter(|g| g.1).map(|g| g.0).collect();
                let found = if names.is_empty() { "empty".into() } else { names.join(" and ") };
                Err(format!(
                    "invalid value: {found}, expected either min and max, or center and size"
                ))
            }
        }
    }
}

impl From<Rect> for RectFile {
    fn from(rect: Rect) -> Self {
        let empty = Self { min: None, max: None, center: None, size: None };
        match rect {
            Rect::Corners { min, max } => Self { min: Some(min), max: Some(max), ..empty },
            Rect::Sized { center, size } => {
                Self { center: Some(center), size: Some(size), ..empty }
            }
        }
    }
}
