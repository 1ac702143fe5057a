//! The place of the picture in the window, and the pointer in it.

use eframe::egui::{PointerButton, Pos2, Rect, Response, Sense, Ui, Vec2};

/// The place of the picture.
pub struct PictureFrame {
    pub place: Rect,
    pub response: Response,
    size: [u32; 2],
}

/// The state of the pointer over the picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pointer {
    /// Position in cells from the top left; `None` outside.
    pub at: Option<[f32; 2]>,
    pub held: bool,
    pub pressed: bool,
    pub released: bool,
    /// True if the secondary button is down.
    pub other: bool,
}

impl PictureFrame {
    /// The largest picture that fits; with `whole`, cells have a whole number of pixels.
    pub fn new(ui: &mut Ui, size: [u32; 2], whole: bool) -> Self {
        let room = ui.available_rect_before_wrap();
        let cells = Vec2::new(size[0] as f32, size[1] as f32);
        let pixels = ui.ctx().pixels_per_point();
        // A window may be smaller than its panels.
        let fits = (room.width() / cells.x).min(room.height() / cells.y).max(0.0) * pixels;
        let scale = if whole && fits >= 1.0 { fits.floor() } else { fits };
        // On whole pixels, so that all columns of cells are equally wide.
        let on_pixel = |v: f32| (v * pixels).round() / pixels;
        let extent = cells * scale / pixels;
        let corner = room.center() - 0.5 * extent;
        let corner = Pos2::new(on_pixel(corner.x), on_pixel(corner.y));
        let place = Rect::from_min_size(corner, extent);
        // Without clicks: egui takes a finger that rests for a long click, and would end the drag.
        let response = ui.allocate_rect(room, Sense::drag());
        Self { place, response, size }
    }

    /// Converts a position in the picture to the window.
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
        if !self.place.is_positive() {
            return Pointer::default();
        }
        // Unlike `contains_pointer`, this is false over what lies on the picture, such as the divider of a split one.
        let over = self.response.hovered();
        // A drag that started inside continues outside.
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

/// Returns true if a position in cells is in a picture of this size.
pub fn is_inside([w, h]: [u32; 2], [x, y]: [f32; 2]) -> bool {
    (0.0..w as f32).contains(&x) && (0.0..h as f32).contains(&y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Context, Event, Modifiers, RawInput, TouchDeviceId, TouchId, TouchPhase};

    /// A window with a picture of 32×18 cells.
    struct Window {
        context: Context,
        size: Vec2,
        whole: bool,
        /// The place of something to drag that lies on the picture.
        grip: Option<Rect>,
    }

    impl Window {
        fn new(size: Vec2, whole: bool) -> Self {
            Self { context: Context::default(), size, whole, grip: None }
        }

        /// The place of the picture and the pointer in a frame at this time in seconds.
        fn frame(&self, time: f64, events: Vec<Event>) -> (Rect, Pointer) {
            let mut seen = None;
            let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, self.size));
            let input = RawInput { screen_rect, events, time: Some(time), ..RawInput::default() };
            let mut output = self.context.run_ui(input, |ui| {
                let view = PictureFrame::new(ui, [32, 18], self.whole);
                seen = Some((view.place, view.pointer(ui)));
                if let Some(grip) = self.grip {
                    ui.interact(grip, ui.scope_id().with("grip"), Sense::drag());
                }
            });
            // No renderer takes the font's texture: egui panics on deltas dropped in silence.
            output.textures_delta.clear();
            seen.unwrap()
        }
    }

    fn press(pos: Pos2) -> Event {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed: true, modifiers }
    }

    fn release(pos: Pos2) -> Event {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed: false, modifiers }
    }

    /// The place of the picture, and a pointer that presses the centre of the window.
    fn shown(size: Vec2, whole: bool) -> (Rect, Pointer) {
        let (window, at) = (Window::new(size, whole), Pos2::ZERO + 0.5 * size);
        // egui assigns a press to the widget of the previous frame.
        window.frame(0.0, vec![Event::PointerMoved(at)]);
        window.frame(0.1, Vec::new());
        window.frame(0.2, vec![press(at)])
    }

    #[test]
    fn the_pointer_is_in_cells() {
        for whole in [false, true] {
            let (place, pointer) = shown(Vec2::new(400.0, 300.0), whole);
            assert!(place.width() >= 320.0 && (place.aspect_ratio() - 32.0 / 18.0).abs() < 1e-3);
            let [x, y] = pointer.at.unwrap();
            assert!((x - 16.0).abs() < 0.5 && (y - 9.0).abs() < 0.5, "{x} {y}");
            assert!(pointer.pressed && pointer.held && !pointer.other);
        }
    }

    #[test]
    fn what_lies_on_the_picture_is_dragged_without_painting() {
        let mut window = Window::new(Vec2::new(400.0, 300.0), false);
        window.grip = Some(Rect::from_center_size(Pos2::new(200.0, 150.0), Vec2::splat(16.0)));
        for (start, at, paints) in
            [(0.0, Pos2::new(200.0, 150.0), false), (10.0, Pos2::new(100.0, 150.0), true)]
        {
            window.frame(start, vec![Event::PointerMoved(at)]);
            window.frame(start + 0.1, Vec::new());
            let (_, pointer) = window.frame(start + 0.2, vec![press(at)]);
            assert_eq!([pointer.pressed, pointer.held], [paints; 2], "{at}");
            window.frame(start + 0.3, vec![release(at)]);
            // Both in one frame, as a slow one sees a quick click.
            let (_, pointer) = window.frame(start + 0.4, vec![press(at), release(at)]);
            assert_eq!(pointer.pressed, paints, "{at}");
        }
    }

    #[test]
    fn a_finger_that_rests_still_paints() {
        let window = Window::new(Vec2::new(400.0, 300.0), false);
        let touch = |phase, pos| Event::Touch {
            device_id: TouchDeviceId(0),
            id: TouchId(0),
            phase,
            pos,
            force: None,
        };
        window.frame(0.0, Vec::new());
        let [from, to] = [Pos2::new(100.0, 150.0), Pos2::new(300.0, 150.0)];
        window.frame(0.1, vec![press(from), touch(TouchPhase::Start, from)]);
        for frame in 0..20 {
            let (_, pointer) = window.frame(0.2 + 0.1 * f64::from(frame), Vec::new());
            assert!(pointer.held, "not held in frame {frame}");
        }
        let moved = vec![Event::PointerMoved(to), touch(TouchPhase::Move, to)];
        let (_, pointer) = window.frame(3.0, moved);
        assert!(pointer.held && pointer.at.is_some_and(|[x, _]| x > 23.0), "{pointer:?}");
    }

    #[test]
    fn a_window_without_space_has_no_pointer() {
        for window in [Vec2::ZERO, Vec2::new(0.0, 300.0), Vec2::new(300.0, 0.0), Vec2::splat(1.0)] {
            let (place, pointer) = shown(window, true);
            assert!(place.min.x.is_finite() && place.max.y.is_finite());
            assert!(pointer.at.is_none_or(|at| at.iter().all(|v| v.is_finite())), "{pointer:?}");
        }
    }
}
