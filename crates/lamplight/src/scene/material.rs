//! Materials: matter with a name.

use crate::{Matter, Rgb};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Matter with a name, which a shape starts from: `material = "glass"` in a file,
/// [`Shape::material`](crate::Shape::material) in code.
///
/// All values are for cells of 1 px, so what a thickness of n px does follows from them: of red light,
/// 20 px of water transmit `((1 − opacity)·tint)^20` = 45 %. A medium twice as dense has twice the
/// optical depth per px: for small values, twice the opacity and the square of the tint.
///
/// ```
/// use lamplight::scene::Material;
/// use lamplight::{Cells, Shape};
/// let mut cells = Cells::new(64, 48)?;
/// // A pane of red glass: a value set afterwards replaces the material's.
/// Shape::rect([30.0, 8.0], [32.0, 40.0]).material(Material::Glass).tint([0.9, 0.2, 0.1]).draw(&mut cells)?;
/// // A single cell of lava.
/// cells.set(10, 40, Material::Lava.matter());
/// # Ok::<(), lamplight::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Material {
    /// Grey rock and masonry.
    Stone,
    /// Red brick, which reddens the light that it reflects.
    Brick,
    /// Brown timber.
    Wood,
    /// A white wall: it brightens a room most.
    Plaster,
    /// Dull iron and steel. There are no mirrors here: it is a grey that reflects much.
    Metal,
    /// Dark, moist soil.
    Earth,
    /// Dry sand.
    Sand,
    /// A lawn or meadow, seen from the side.
    Grass,
    /// Fresh snow, the brightest ground.
    Snow,
    /// Clear glass with a trace of green. It scatters nothing; `tint` stains it.
    Glass,
    /// Clouded, bluish ice.
    Ice,
    /// Water, which absorbs red first and scatters a little, so that the depths are not black.
    Water,
    /// Foliage: light that passes turns green, and so does light that is scattered.
    Leaves,
    /// Pale fog: it scatters nearly all that it takes. Half of the light is left after 70 px.
    Fog,
    /// Dark smoke: it absorbs most of what it takes. Half of the light is left after 14 px.
    Smoke,
    /// A flame: it glows and blocks next to nothing. A thicker flame is a brighter light.
    Fire,
    /// Molten rock: solid, and glowing on its surface.
    Lava,
}

impl Material {
    /// All materials, in the order of lists and tables: solids, media, lights.
    pub const ALL: &'static [Self] = &[
        Self::Stone,
        Self::Brick,
        Self::Wood,
        Self::Plaster,
        Self::Metal,
        Self::Earth,
        Self::Sand,
        Self::Grass,
        Self::Snow,
        Self::Glass,
        Self::Ice,
        Self::Water,
        Self::Leaves,
        Self::Fog,
        Self::Smoke,
        Self::Fire,
        Self::Lava,
    ];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stone => "stone",
            Self::Brick => "brick",
            Self::Wood => "wood",
            Self::Plaster => "plaster",
            Self::Metal => "metal",
            Self::Earth => "earth",
            Self::Sand => "sand",
            Self::Grass => "grass",
            Self::Snow => "snow",
            Self::Glass => "glass",
            Self::Ice => "ice",
            Self::Water => "water",
            Self::Leaves => "leaves",
            Self::Fog => "fog",
            Self::Smoke => "smoke",
            Self::Fire => "fire",
            Self::Lava => "lava",
        }
    }

    /// Returns what a cell of the material holds.
    pub fn matter(self) -> Matter {
        match self {
            Self::Stone => solid([0.42, 0.4, 0.37]),
            Self::Brick => solid([0.45, 0.17, 0.11]),
            Self::Wood => solid([0.42, 0.24, 0.12]),
            Self::Plaster => solid([0.8, 0.78, 0.73]),
            Self::Metal => solid([0.55, 0.56, 0.58]),
            Self::Earth => solid([0.27, 0.18, 0.11]),
            Self::Sand => solid([0.62, 0.5, 0.32]),
            Self::Grass => solid([0.2, 0.38, 0.1]),
            Self::Snow => solid([0.88, 0.91, 0.95]),
            Self::Glass => medium(0.0, [0.96, 0.985, 0.97], [0.0; 3]),
            Self::Ice => medium(0.03, [0.97, 0.99, 0.997], [0.85, 0.93, 0.97]),
            Self::Water => medium(0.004, [0.965, 0.986, 0.993], [0.5, 0.7, 0.8]),
            Self::Leaves => medium(0.05, [0.96, 0.99, 0.9], [0.35, 0.7, 0.15]),
            Self::Fog => medium(0.01, CLEAR, [0.9, 0.92, 0.95]),
            Self::Smoke => medium(0.05, CLEAR, [0.25, 0.24, 0.23]),
            Self::Fire => Matter { glow: [1.5, 0.65, 0.16], ..medium(0.01, CLEAR, [0.0; 3]) },
            Self::Lava => Matter { emission: [1.8, 0.36, 0.02], ..solid([0.12, 0.06, 0.04]) },
        }
    }

    /// Returns the colour under the light in the final picture, as [`Shape::color`](crate::Shape): `None`
    /// is the albedo, painted on as far as the material is opaque.
    ///
    /// Media that hide the backdrop have one. Fog, smoke and glass leave what is behind them as it is.
    pub fn color(self) -> Option<Rgb> {
        match self {
            Self::Ice => Some([0.72, 0.87, 0.95]),
            Self::Water => Some([0.7, 0.85, 0.9]),
            Self::Leaves => Some([0.55, 0.75, 0.35]),
            _ => None,
        }
    }
}

/// The tint of what colours no light that passes.
const CLEAR: Rgb = [1.0; 3];

fn solid(albedo: Rgb) -> Matter {
    Matter { opacity: 1.0, albedo, ..Matter::EMPTY }
}

fn medium(opacity: f32, tint: Rgb, albedo: Rgb) -> Matter {
    Matter { opacity, tint, albedo, ..Matter::EMPTY }
}
