//! The edge-aware blur.

use crate::common::{cells, device, raymarch_of};
use crate::compare::{SIZES, agree};
use lamplight::settings::{Denoise, Hit, Raymarch};
use lamplight::{Bounces, Settings};

fn denoising(passes: u32, strength: f32) -> Settings {
    let denoise = Denoise { passes, strength };
    let raymarch = Raymarch { denoise, ..Raymarch::default() };
    Settings { bounces: Bounces::Count(0), wall_depth: 2.0, ..Settings::new(raymarch) }
}

#[test]
fn every_pass_and_strength_agrees() {
    let gpu = device();
    for hit in [Hit::Edge, Hit::Distance] {
        let passes = (1..=6).map(|passes| (passes, 1.0));
        for (passes, strength) in passes.chain([0.0, 0.3, 4.0, 16.0].map(|s| (4, s))) {
            let mut settings = denoising(passes, strength);
            raymarch_of(&mut settings).hit = hit;
            let name = format!("{passes} passes of strength {strength}, {hit:?}");
            agree(&gpu, &name, &cells(97, 61, 3), settings);
        }
    }
}

#[test]
fn denoising_agrees_at_every_size() {
    let gpu = device();
    for [w, h] in SIZES {
        agree(&gpu, &format!("{w}×{h}"), &cells(w, h, 5), denoising(3, 1.0));
    }
}
