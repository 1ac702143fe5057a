//! Downsampled cells, and light upsampled again.

use crate::common::*;
use lamplight::resample::{downsample, upsample};
use lamplight::{Cells, Inflow, Light, Matter};

#[test]
fn a_target_that_is_used_again_keeps_nothing() {
    let cells = grid(8, 8, |x, _| if x < 4 { WALL } else { Matter::EMPTY });
    let (mut fresh, mut used) = (Cells::new(1, 1).unwrap(), jumble(4, 4, 1));
    used.color_mut()[3] = [0.0; 3];
    used.normals_mut()[3] = [1.0, 0.0, 0.0];
    used.set_inflow(Some(Inflow::new([4, 4], 4, |_, _| [1.0; 3]).unwrap())).unwrap();
    for target in [&mut fresh, &mut used] {
        downsample(&cells, 2, target).unwrap();
    }
    assert!(used == fresh);
}

#[test]
fn narrow_light_is_upsampled_to_its_place() {
    // Of 9 columns at factor 4 three are left, as at factor 3.
    let cells = Cells::new(9, 2000).unwrap();
    let mut larger = Cells::new(1, 1).unwrap();
    downsample(&cells, 4, &mut larger).unwrap();
    let rows = (0..larger.len()).map(|i| [(i / 3) as f32; 3]).collect();
    let light = upsample(&Light::from_pixels(&larger, rows).unwrap(), &larger, &cells).unwrap();
    for y in [100, 1000, 1990] {
        near(light.at(4, y)[0], (f64::from(y) + 0.5) / 4.0 - 0.5, 1e-6);
    }
}
