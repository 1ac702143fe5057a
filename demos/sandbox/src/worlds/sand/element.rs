//! The elements of the falling-sand world: one table of their motion and looks.

use crate::paint::{Paint, hex, mix, scale};
use lamplight::Matter;

/// The element of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Element {
    /// Air.
    #[default]
    Empty,
    /// Rock, which does not move.
    Stone,
    /// Falls and piles up; lava melts it to glass.
    Sand,
    /// Flows; lava turns it to steam, plants drink it.
    Water,
    /// Flows slowly, glows, ignites flammable elements, throws sparks.
    Lava,
    /// Rises and burns out.
    Fire,
    /// Rises and fades.
    Smoke,
    /// Rises and rains.
    Steam,
    /// Transmits coloured light.
    Glass,
    /// Flows, floats on water, burns.
    Oil,
    /// Grows where it finds water, burns.
    Plant,
    /// Solid; burns slowly.
    Wood,
    /// Solid; glows.
    Crystal,
}

/// The motion of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// None.
    Fixed,
    /// Down, and down sideways.
    Powder,
    /// Down, and sideways by up to this many cells per pass.
    Liquid(i32),
    /// Up, and sideways.
    Gas,
}

/// The properties of an element.
#[derive(Clone, Copy, Debug)]
pub struct Nature {
    /// Its motion.
    pub flow: Flow,
    /// Denser elements sink through lighter ones that flow.
    pub density: u8,
    /// Mean number of passes until it ignites beside fire; 0 if it is not flammable.
    pub burns: u32,
    /// Largest lifetime, or burning time of flammable elements; 0 is unlimited. On average every second pass
    /// counts, for flammable elements every fourth.
    pub life: u8,
}

/// The number of looks of an element, such as shades of rock or ages of fire.
pub(super) const LOOKS: usize = 8;
/// The look of burning oil and wood.
pub(super) const BURNING: usize = LOOKS - 1;

impl Element {
    /// All elements, in the order of their discriminants.
    pub const ALL: [Self; 13] = [
        Self::Empty,
        Self::Stone,
        Self::Sand,
        Self::Water,
        Self::Lava,
        Self::Fire,
        Self::Smoke,
        Self::Steam,
        Self::Glass,
        Self::Oil,
        Self::Plant,
        Self::Wood,
        Self::Crystal,
    ];

    /// Their names, which are the brushes of the world, in the same order.
    pub const NAMES: [&'static str; 13] = [
        "empty", "stone", "sand", "water", "lava", "fire", "smoke", "steam", "glass", "oil",
        "plant", "wood", "crystal",
    ];

    /// Its properties.
    #[inline]
    pub const fn nature(self) -> Nature {
        NATURES[self as usize]
    }

    /// Returns true if it flows. Brushes pour flowing elements with gaps.
    pub(super) const fn pours(self) -> bool {
        !matches!(self.nature().flow, Flow::Fixed)
    }

    /// The paint of one of its [`LOOKS`], without the backdrop. For elements that age, look 0 is the oldest.
    pub(super) fn paint(self, look: usize) -> Paint {
        let t = look as f32 / (LOOKS - 1) as f32;
        let solid = |dark, light| Paint::wall(mix(hex(dark), hex(light), t));
        let liquid = |opacity, tint: [f32; 3], dark, light| {
            let paint = Paint::fog(opacity, mix(hex(dark), hex(light), t));
            Paint { matter: Matter { tint, ..paint.matter }, ..paint }
        };
        match self {
            Self::Empty => Paint::open([1.0; 3]),
            Self::Stone => solid(0x7d7480, 0xbcb0ac),
            Self::Sand => solid(0xc79a55, 0xf0d08a),
            Self::Water => liquid(0.012, [0.955, 0.985, 0.995], 0x3f8fb8, 0x58aacb),
            Self::Lava => {
                let glow = mix([1.0, 0.14, 0.015], [2.3, 0.66, 0.09], t);
                Paint::wall(hex(0x5a1a0a)).glowing(glow)
            }
            Self::Fire => {
                let glow = mix([1.4, 0.22, 0.03], [3.0, 1.5, 0.4], t);
                Paint::fog(0.35, hex(0x402010)).glowing(glow).colored(hex(0xffc890))
            }
            Self::Smoke => Paint::fog(0.01 + 0.05 * t, hex(0x8d8796)),
            Self::Steam => Paint::fog(0.006 + 0.03 * t, hex(0xe8f2f6)),
            Self::Glass => {
                let hues = [0x9fe8d8, 0xffc27a, 0xff8fa8, 0xa9b4ff];
                Paint::glass(mix([1.0; 3], hex(hues[look % 4]), 0.22)).colored(hex(hues[look % 4]))
            }
            Self::Oil => {
                let paint = liquid(0.05, [0.97, 0.9, 0.78], 0x6a4a20, 0x86602c);
                if look == BURNING { paint.glowing([3.0, 1.2, 0.25]) } else { paint }
            }
            Self::Plant => {
                let color = mix(hex(0x2f7d3a), hex(0x9ad25a), t);
                Paint::fog(0.4, color)
            }
            Self::Wood => {
                let paint = solid(0x7e5230, 0xb07c48);
                if look == BURNING { paint.glowing([2.2, 0.6, 0.08]) } else { paint }
            }
            Self::Crystal => {
                let hues = [0x66e0f2, 0xbf8cf4];
                let color = hex(hues[look / 4]);
                Paint::wall(color).glowing(scale(color, 0.5 + 0.35 * (look % 4) as f32))
            }
        }
    }
}

const FIXED: Nature = Nature { flow: Flow::Fixed, density: 255, burns: 0, life: 0 };
const AIR: u8 = 10;

/// In the order of [`Element::ALL`].
const NATURES: [Nature; 13] = [
    Nature { density: AIR, ..FIXED },
    FIXED,
    Nature { flow: Flow::Powder, density: 90, ..FIXED },
    Nature { flow: Flow::Liquid(5), density: 50, ..FIXED },
    Nature { flow: Flow::Liquid(1), density: 80, ..FIXED },
    Nature { flow: Flow::Gas, density: 4, life: 60, ..FIXED },
    Nature { flow: Flow::Gas, density: 6, life: 250, ..FIXED },
    Nature { flow: Flow::Gas, density: 5, life: 255, ..FIXED },
    FIXED,
    Nature { flow: Flow::Liquid(4), density: 40, burns: 24, life: 255 },
    Nature { burns: 10, ..FIXED },
    Nature { burns: 90, life: 255, ..FIXED },
    FIXED,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_in_the_order_of_elements() {
        for (i, element) in Element::ALL.into_iter().enumerate() {
            assert_eq!(element as usize, i);
            assert_eq!(format!("{element:?}").to_lowercase(), Element::NAMES[i]);
        }
        assert_eq!(Element::Water.nature().flow, Flow::Liquid(5));
        assert_eq!(Element::Wood.nature().burns, 90);
    }

    #[test]
    fn every_look_is_valid_matter() {
        let mut cells = lamplight::Cells::new(1, 1).unwrap();
        for element in Element::ALL {
            for look in 0..LOOKS {
                let paint = element.paint(look);
                paint.put(&mut cells, 0);
                cells.check().unwrap_or_else(|e| panic!("{element:?} {look}: {e}"));
                assert!(paint.color.iter().all(|v| (0.0..=1.0).contains(v)), "{element:?} {look}");
            }
        }
    }
}
