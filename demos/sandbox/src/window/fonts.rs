//! Fonts: those of egui without emoji, which would be a sixth of the web page.

use eframe::egui::{FontData, FontDefinitions, FontFamily};
use epaint_default_fonts::{HACK_REGULAR, UBUNTU_LIGHT};
use std::sync::Arc;

/// The fonts of the window.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let named = [("words", UBUNTU_LIGHT), ("numbers", HACK_REGULAR)];
    for (name, data) in named {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(data)));
    }
    let [words, numbers] = named.map(|(name, _)| name.to_owned());
    // Each font lacks some characters of the other.
    fonts.families.insert(FontFamily::Proportional, vec![words.clone(), numbers.clone()]);
    fonts.families.insert(FontFamily::Monospace, vec![numbers, words]);
    fonts
}
