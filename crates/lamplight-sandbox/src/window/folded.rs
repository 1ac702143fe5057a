//! Panels where there is little room, as on a phone: folded away, and one at a time beside the picture.

use eframe::egui::{Context, Panel, Ui};

/// Points across below which panels are folded away.
const ROOM: f32 = 900.0;
/// The share of a tall window that an open panel takes.
const SHARE: f32 = 0.45;

/// A panel that can be folded away.
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

    /// Points across, where it stands beside the picture.
    fn width(self) -> f32 {
        match self {
            Self::Tools => 170.0,
            Self::Settings => 330.0,
        }
    }
}

/// The panel that is open where there is room for one.
#[derive(Debug, Default)]
pub struct Folded {
    open: Option<Side>,
}

impl Folded {
    /// Buttons that open and fold panels, where there is little room.
    pub fn buttons(&mut self, ui: &mut Ui) {
        if !is_narrow(ui.ctx()) {
            return;
        }
        for side in Side::ALL {
            if ui.selectable_label(self.open == Some(side), side.name()).clicked() {
                self.open = Some(side).filter(|_| self.open != Some(side));
            }
        }
        ui.separator();
    }

    /// The panel's place; none where it is folded away.
    pub fn panel(&self, context: &Context, side: Side) -> Option<Panel> {
        let room = context.content_rect();
        let narrow = is_narrow(context);
        if narrow && self.open != Some(side) {
            return None;
        }
        let panel = match side {
            _ if narrow && room.height() > room.width() => {
                return Some(Panel::bottom(side.name()).exact_size(SHARE * room.height()));
            }
            Side::Tools => Panel::left(side.name()),
            Side::Settings => Panel::right(side.name()),
        };
        Some(panel.exact_size(side.width()))
    }
}

fn is_narrow(context: &Context) -> bool {
    context.content_rect().width() < ROOM
}
