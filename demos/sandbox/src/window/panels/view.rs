//! The controls of views, of resolution and of the split picture.

use crate::message::message;
use crate::window::halves::Halves;
use crate::window::inspect::{Inspector, PictureView};
use crate::window::resolution::Resolution;
use eframe::egui::{ComboBox, Slider, Ui};
use lamplight::resample::MAX_FACTOR;
use lamplight::{Method, Settings};

/// Selects the view.
pub fn show(ui: &mut Ui, inspector: &mut Inspector) {
    ComboBox::from_id_salt("view").selected_text(inspector.view.name()).show_ui(ui, |ui| {
        for view in PictureView::ALL {
            let label = ui.selectable_value(&mut inspector.view, view, view.name());
            label.on_hover_text(view.words());
        }
    });
    if inspector.view == PictureView::Inside {
        ui.horizontal(|ui| {
            if ui.button("Previous").clicked() {
                inspector.inside = inspector.inside.saturating_sub(1);
            }
            if ui.button("Next").clicked() {
                inspector.inside += 1;
            }
        });
    }
    ui.weak(inspector.message());
}

/// The sizes to choose from.
const SIZES: [[u32; 2]; 7] =
    [[160, 90], [240, 135], [320, 180], [480, 270], [640, 360], [960, 540], [1280, 720]];

/// Selects the size. Returns a new one.
pub fn size(ui: &mut Ui, size: [u32; 2]) -> Option<[u32; 2]> {
    let name = |[w, h]: [u32; 2]| format!("{w}×{h} cells");
    let mut chosen = size;
    let shown = ComboBox::from_id_salt("size").selected_text(name(size)).show_ui(ui, |ui| {
        for size in SIZES {
            ui.selectable_value(&mut chosen, size, name(size));
        }
    });
    shown
        .response
        .on_hover_text("Restarts the scene. Times are proportional to the number of cells");
    (chosen != size).then_some(chosen)
}

/// Selects the size of cells of light.
pub fn resolution(ui: &mut Ui, resolution: &mut Resolution) {
    let mut factor = resolution.factor;
    let slider = Slider::new(&mut factor, 1..=MAX_FACTOR).text("cells per cell of light");
    let slider = ui.add(slider);
    if slider.changed() {
        resolution.choose(factor);
    }
    slider.on_hover_text(
        "1: every cell. 2: light on a quarter of the cells, in about a quarter of the time",
    );
    ui.checkbox(&mut resolution.adapts, "keep 60 frames per second")
        .on_hover_text("Light becomes coarser while frames are late, and finer when there is time");
}

/// Splits the picture. Returns an error message.
pub fn split(ui: &mut Ui, halves: &mut Halves) -> Result<(), String> {
    let mut is_split = halves.right.is_some();
    let label = ui.checkbox(&mut is_split, "two methods, side by side");
    let mut done = Ok(());
    if label.on_hover_text("The divider can be dragged").changed() {
        if is_split {
            done = halves.split(other(&halves.left.settings)).map_err(|why| message(&why));
        } else {
            halves.join();
        }
    }
    if halves.right.is_some() {
        ui.horizontal(|ui| {
            ui.label("The settings below apply to the");
            ui.selectable_value(&mut halves.edits_right, false, "left");
            ui.selectable_value(&mut halves.edits_right, true, "right");
        });
        ui.add(Slider::new(&mut halves.divider, 0.02..=0.98).text("divider").show_value(false));
    }
    done
}

/// Selects how cells are drawn; the relief, if they have normals.
pub fn picture(ui: &mut Ui, smooth: &mut bool, whole: &mut bool, relief: Option<&mut bool>) {
    if let Some(relief) = relief {
        ui.checkbox(relief, "relief").on_hover_text(
            "Lights tilted surfaces by their normals. Light takes about a fifth more time",
        );
    }
    ui.checkbox(smooth, "smooth")
        .on_hover_text("Interpolates light between cells; off suits pixel art");
    ui.checkbox(whole, "whole pixels").on_hover_text(
        "Each cell is a whole number of pixels, so that all cells have the same size",
    );
}

/// The settings with another method.
fn other(settings: &Settings) -> Settings {
    let method = match settings.method() {
        Method::Raymarch => Method::Holographic,
        _ => Method::Raymarch,
    };
    Settings { method: method.into(), ..settings.clone() }
}
