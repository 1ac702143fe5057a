//! What is seen of the light: views, and two lights side by side.

use crate::window::halves::Halves;
use crate::window::inspect::{Inspector, View};
use eframe::egui::{ComboBox, Slider, Ui};
use lamplight::{Method, Settings};

/// Which view.
pub fn show(ui: &mut Ui, inspector: &mut Inspector) {
    ComboBox::from_id_salt("view").selected_text(inspector.view.name()).show_ui(ui, |ui| {
        for view in View::ALL {
            let label = ui.selectable_value(&mut inspector.view, view, view.name());
            label.on_hover_text(view.words());
        }
    });
    if inspector.view == View::Inside {
        ui.horizontal(|ui| {
            if ui.button("◀").clicked() {
                inspector.inside = inspector.inside.saturating_sub(1);
            }
            if ui.button("▶").clicked() {
                inspector.inside += 1;
            }
        });
    }
    ui.weak(inspector.said());
}

/// Whether the picture is split; says what went wrong.
pub fn split(ui: &mut Ui, halves: &mut Halves) -> Result<(), String> {
    let mut is_split = halves.right.is_some();
    let label = ui.checkbox(&mut is_split, "two methods, side by side");
    let mut done = Ok(());
    if label.on_hover_text("The divider can be dragged").changed() {
        if is_split {
            done = halves.split(other(&halves.left.settings)).map_err(|why| format!("{why:#}"));
        } else {
            halves.join();
        }
    }
    if halves.right.is_some() {
        ui.horizontal(|ui| {
            ui.label("Settings below are of the");
            ui.selectable_value(&mut halves.edits_right, false, "left");
            ui.selectable_value(&mut halves.edits_right, true, "right");
        });
        ui.add(Slider::new(&mut halves.divider, 0.02..=0.98).text("divider").show_value(false));
    }
    done
}

/// The same settings with another method.
fn other(settings: &Settings) -> Settings {
    let method = match settings.method {
        Method::Raymarch => Method::Holographic,
        _ => Method::Raymarch,
    };
    Settings { method, ..settings.clone() }
}
