//! Where the picture lies in the window, and where in it the pointer is.

use eframe::egui::{PointerButton, Pos2, Rect, Response, Sense, Ui, Vec2};

/// The place of the picture.
pub struct View {
    pub place: Rect,
    pub response: Response,
    size: [u32; 2],
}

/// What the pointer does to the picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pointer {
    /// In cells, from the left and top edge; none outside.
    pub at: Option<[f32; 2]>,
    pub held: bool,
    pub pressed: bool,
    pub released: bool,
    /// Whether it is the other button that is held.
    pub other: bool,
}

impl View {
    /// As large as there is room; with `whole`, each cell as many whole pixels as fit.
    pub fn new(ui: &mut Ui, size: [u32; 2], whole: bool) -> Self {
        let room = ui.available_rect_before_wrap();
        let cells = Vec2::new(size[0] as f32, size[1] as f32);
        let pixels = ui.ctx().pixels_per_point();
        let fits = (room.width() / cells.x).min(room.height() / cells.y) * pixels;
        let scale = if whole && fits >= 1.0 { fits.floor() } else { fits };
        // On whole pixels, so that no column of cells is wider than its neighbours.
        let on_pixel = |v: f32| (v * pixels).round() / pixels;
        let extent = cells * scale / pixels;
        let corner = room.center() - 0.5 * extent;
        let corner = Pos2::new(on_pixel(corner.x), on_pixel(corner.y));
        let place = Rect::from_min_size(corner, extent);
        let response = ui.allocate_rect(room, Sense::click_and_drag());
        Self { place, response, size }
    }

    /// The place in the window of a place in the picture.
    pub fn to_window(&self, [x, y]: [f32; 2]) -> Pos2 {
        let across = Vec2::new(x / self.size[0] as f32, y / self.size[1] as f32);
        self.place.min + across * self.place.size()
    }

    fn to_cells(&self, at: Pos2) -> [f32; 2] {
        let across = (at - self.place.min) / self.place.size();
        [across.x * self.size[0] as f32, across.y * self.size[1] as f32]
    }

    pub fn pointer(&self, ui: &Ui) -> Pointer {
        let buttons = [PointerButton::Primary, PointerButton::Secondary];
        let (held, pressed, released, other) = ui.input(|input| {
            let pointer = &input.pointer;
            (
                buttons.iter().any(|&b| pointer.button_down(b)),
                buttons.iter().any(|&b| pointer.button_pressed(b)),
                buttons.iter().any(|&b| pointer.button_released(b)),
                pointer.button_down(PointerButton::Secondary),
            )
        });
        let over = self.response.contains_pointer();
        // Who pressed inside goes on outside, until it is let go.
        let at = self.response.interact_pointer_pos().or(self.response.hover_pos());
        Pointer {
            at: at
                .filter(|_| over || self.response.is_pointer_button_down_on())
                .map(|at| self.to_cells(at)),
            held: held && self.response.is_pointer_button_down_on(),
            pressed: pressed && over,
            released,
            other,
        }
    }
}
