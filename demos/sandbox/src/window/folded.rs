//! Panels in narrow windows, as on a phone: folded, with at most one open.

use eframe::egui::{Context, Panel, Ui};

/// The window width in points below which panels are folded.
const MIN_WIDTH: f32 = 900.0;
/// The fraction of a tall window that an open panel takes.
const HEIGHT_FRACTION: f32 = 0.45;

/// A panel that can be folded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Tools,
    Settings,
}

impl Side {
    const ALL: [Self; 2] = [Self::Tools, Self::Settings];

    fn name(self) -> &'static str {
        match self {
            Self::Tools => "Tools",
            Self::Settings => "Settings",
        }
    }

    /// Its width beside the picture, points.
    fn width(self) -> f32 {
        match self {
            Self::Tools => 170.0,
            Self::Settings => 330.0,
        }
    }
}

/// The open panel of a narrow window.
#[derive(Debug, Default)]
pub struct Folded {
    open: Option<Side>,
}

impl Folded {
    /// Shows buttons that open and fold panels, in a narrow window.
    pub fn buttons(&mut self, ui: &mut Ui) {
        if !is_narrow(ui.ctx()) {
            return;
        }
        for side in Side::ALL {
            if ui.selectable_label(self.open == Some(side), side.name()).clicked() {
                self.open = (self.open != Some(side)).then_some(side);
            }
        }
        ui.separator();
    }

    /// The panel; `None` if it is folded.
    pub fn panel(&self, context: &Context, side: Side) -> Option<Panel> {
        let room = context.content_rect();
        let narrow = is_narrow(context);
        if narrow && self.open != Some(side) {
            return None;
        }
        let panel = match side {
            _ if narrow && room.height() > room.width() => {
                return Some(
                    Panel::bottom(side.name()).exact_size(HEIGHT_FRACTION * room.height()),
                );
            }
            Side::Tools => Panel::left(side.name()),
            Side::Settings => Panel::right(side.name()),
        };
        Some(panel.exact_size(side.width()))
    }
}

fn is_narrow(context: &Context) -> bool {
    context.content_rect().width() < MIN_WIDTH
}
