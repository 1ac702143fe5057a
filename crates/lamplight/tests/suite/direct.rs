//! Exact direct light below the light of other methods.

use crate::common::{grid, solve};
use lamplight::{Cells, Direct, Lamp, Light, Matter, Method, Settings};

fn direct(cells: &Cells) -> Light {
    solve(&Settings::direct(Method::Cascades), cells)
}

fn exact(position: [f32; 2]) -> Lamp {
    Lamp { position, direct: Direct::Exact, ..Lamp::default() }
}

#[test]
fn a_lamp_right_before_a_wall_in_fog_gives_finite_light() {
    // The lamp is in the middle of the cell before the wall, half in the fog.
    let mut cells = grid(40, 30, |x, y| match (x, y) {
        (20, _) => Matter { opacity: 1.0, albedo: [0.5; 3], ..Matter::EMPTY },
        (_, 0..15) => Matter { opacity: 0.05, albedo: [0.5; 3], ..Matter::EMPTY },
        _ => Matter::EMPTY,
    });
    cells.lamps_mut().push(exact([19.5, 14.5]));
    let light = direct(&cells);
    assert!(light.pixels().as_flattened().iter().all(|v| v.is_finite()));
    assert!(light.at(10, 20)[0] > 0.1);
}

#[test]
fn light_of_a_lamp_over_the_border_has_no_steps_before_a_shadow() {
    let mut cells = grid(60, 60, |x, y| {
        let opacity = f32::from(u8::from(y == 20 && x >= 35));
        Matter { opacity, ..Matter::EMPTY }
    });
    cells.lamps_mut().push(exact([59.0, 3.0]));
    let light = direct(&cells);
    let row: Vec<f32> = (10..35).map(|x| light.at(x, 28)[0]).collect();
    let (open, shadow) = row.split_at(11);
    assert!(open.windows(2).all(|pair| pair[1] > pair[0]), "{row:?}");
    assert!(shadow.windows(2).all(|pair| pair[1] <= pair[0]), "{row:?}");
    assert!(open[0] > 0.1 && shadow[13] == 0.0, "{row:?}");
}
