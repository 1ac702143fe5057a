//! The font: of egui's the one for words, as its others would be a fifth of the web page.

use eframe::egui::{FontData, FontDefinitions, FontFamily};
use epaint_default_fonts::UBUNTU_LIGHT;
use std::sync::Arc;

/// The fonts of the window: one for all. Its digits are of one width, but it has no arrows or blocks.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let name = "Ubuntu Light";
    fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(UBUNTU_LIGHT)));
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec![name.to_owned()]);
    }
    fonts
}
