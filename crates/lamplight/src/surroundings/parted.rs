//! Lamps on the border of a grid.

use crate::Lamp;

/// The least radius at which a lamp is seen beyond the border, px. A smaller one would flicker there as it glides: the light
/// that enters is known by border cells and by columns.
pub const LEAST_RADIUS_BEYOND: f32 = 6.0;

/// Parts a lamp that may lie on the border of a grid, px of the grid, between the grid, where it is drawn into cells, and
/// the [inflow](crate::Inflow). The share of a part multiplies its intensity.
///
/// Neither knows a lamp well that the border cuts. So the lamp is drawn a radius inside of the border and seen a radius
/// beyond it, and what each has of its light changes evenly as it glides over: their sum and their centre are those of the
/// lamp, and neither light nor its change jumps. Beyond the border a lamp is at least as large as
/// [`LEAST_RADIUS_BEYOND`], with the same light. One that is farther than two radii from the border, and 14 px, is given
/// whole.
pub fn part_lamp(lamp: &Lamp, grid: [u32; 2]) -> impl Iterator<Item = (Lamp, LampPart)> + use<> {
    // No part touches the border.
    let size_beyond = lamp.size.max(LEAST_RADIUS_BEYOND);
    let radius = size_beyond + 1.0;
    let axes = [0, 1].map(|a| part_axis(lamp.position[a], grid[a] as f32, radius));
    let lamp = lamp.clone();
    let of_rows = axes[1].into_iter().flatten();
    let parts = of_rows.flat_map(move |y| axes[0].into_iter().flatten().map(move |x| (x, y)));
    parts.map(move |(x, y)| {
        let position = [x.at, y.at];
        let intensity = lamp.intensity * x.share * y.share;
        if !x.beyond && !y.beyond {
            return (Lamp { position, intensity, ..lamp.clone() }, LampPart::Inside);
        }
        // The light of a disc is that of its radiance times its radius.
        let intensity = intensity * lamp.size / size_beyond;
        (Lamp { position, intensity, size: size_beyond, ..lamp.clone() }, LampPart::Beyond)
    })
}

/// The side of the border that a part of a lamp is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LampPart {
    /// Drawn into the cells of the grid.
    Inside,
    /// Seen in the inflow.
    Beyond,
}

/// A part along one axis.
#[derive(Clone, Copy, Debug)]
struct AxisPart {
    at: f32,
    share: f32,
    beyond: bool,
}

/// Returns one or two parts along an axis, of a grid that is this long.
fn part_axis(at: f32, size: f32, radius: f32) -> [Option<AxisPart>; 2] {
    // The nearer end, and the distance beyond it.
    let (edge, way) = if at < 0.5 * size { (0.0, -1.0) } else { (size, 1.0) };
    let past = (at - edge) * way;
    // At least a radius beyond, and that far inside: they slow down instead of stopping there.
    let slow = |past: f32| {
        radius * (1.0 + 0.25 * (past / radius).clamp(0.0, 2.0).powi(2))
            + (past - 2.0 * radius).max(0.0)
    };
    let [beyond, inside] = [slow(past), -slow(-past)];
    let share = ((past - inside) / (beyond - inside)).clamp(0.0, 1.0);
    let part = |past: f32, share: f32, beyond: bool| {
        let at = if beyond { edge + way * past } else { (edge + way * past).clamp(0.0, size) };
        (share > 0.0).then_some(AxisPart { at, share, beyond })
    };
    [part(inside, 1.0 - share, false), part(beyond, share, true)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [60, 40];

    #[test]
    fn parts_have_the_light_and_the_centre_of_the_lamp() {
        for x in -40..100 {
            for y in [-12.3f32, -3.0, 0.4, 5.0, 20.0, 38.7, 46.0] {
                let x = x as f32 + 0.3;
                let lamp = Lamp { position: [x, y], size: 3.0, intensity: 2.0, ..Lamp::default() };
                let parts: Vec<_> = part_lamp(&lamp, SIZE).collect();
                let sum = |of: fn(&Lamp) -> f32| {
                    parts
                        .iter()
                        .map(|(part, _)| part.intensity * part.size / 3.0 * of(part))
                        .sum::<f32>()
                };
                assert!((sum(|_| 1.0) - 2.0).abs() < 1e-4, "{parts:?}");
                let [mx, my] = [sum(|lamp| lamp.position[0]), sum(|lamp| lamp.position[1])];
                assert!((mx - 2.0 * x).abs() < 1e-3 && (my - 2.0 * y).abs() < 1e-3, "{parts:?}");
                for (part, side) in &parts {
                    let [x, y] = part.position;
                    let beyond =
                        [-x, x - 60.0, -y, y - 40.0].into_iter().fold(f32::NEG_INFINITY, f32::max);
                    let is_clear = match side {
                        LampPart::Inside => beyond < -part.size,
                        LampPart::Beyond => beyond > part.size,
                    };
                    assert!(is_clear, "{part:?} of {lamp:?}");
                }
            }
        }
    }

    #[test]
    fn parts_change_evenly() {
        let at = |x: f32| {
            let lamp = Lamp { position: [x, 100.0], size: 3.0, ..Lamp::default() };
            let inside = part_lamp(&lamp, [200, 200]).find(|(_, part)| *part == LampPart::Inside);
            inside.map_or(0.0, |(part, _)| part.intensity / lamp.intensity)
        };
        let shares: Vec<f32> = (-150..=150).map(|i| at(i as f32 * 0.1)).collect();
        assert_eq!((shares[0], shares[300]), (0.0, 1.0));
        for three in shares.windows(3) {
            let [one, two, other] = [three[0], three[1], three[2]];
            assert!(one <= two && (one + other - 2.0 * two).abs() < 1e-3, "{three:?}");
        }
    }
}
