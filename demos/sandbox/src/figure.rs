//! Rotated boxes and balls, drawn into cells with antialiasing.

use crate::paint::Paint;
use lamplight::Cells;

/// The outline of a body around its own centre, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Figure {
    /// A disc of a radius.
    Ball(f32),
    /// A box: half of its width and height.
    Box([f32; 2]),
}

impl Figure {
    /// The largest distance from its centre.
    pub fn reach(self) -> f32 {
        match self {
            Self::Ball(radius) => radius,
            Self::Box([x, y]) => x.hypot(y),
        }
    }

    /// The signed distance in px from a point in the figure's own frame to the outline; negative inside.
    pub fn distance(self, [x, y]: [f32; 2]) -> f32 {
        match self {
            Self::Ball(radius) => x.hypot(y) - radius,
            Self::Box([half_x, half_y]) => {
                let (dx, dy) = (x.abs() - half_x, y.abs() - half_y);
                dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0)
            }
        }
    }

    /// Draws it with its centre at `at`, rotated by `angle` (radians from +x towards +y).
    ///
    /// `paint` receives the position of a cell in the figure's own frame and its depth inside. Coverage is
    /// that of a straight edge at the same distance, which is exact except at corners.
    pub fn draw(
        self,
        cells: &mut Cells,
        at: [f32; 2],
        angle: f32,
        paint: impl Fn([f32; 2], f32) -> Paint,
    ) {
        let reach = self.reach() + 1.0;
        let span = |i: usize, side: u32| {
            let from = (at[i] - reach).floor().max(0.0) as i32;
            from..((at[i] + reach).ceil().min(side as f32) as i32)
        };
        let (sin, cos) = angle.sin_cos();
        for y in span(1, cells.height()) {
            for x in span(0, cells.width()) {
                let (dx, dy) = (x as f32 + 0.5 - at[0], y as f32 + 0.5 - at[1]);
                let local = [cos * dx + sin * dy, cos * dy - sin * dx];
                let distance = self.distance(local);
                // Coverage near 0 and 1 is rounded, so that walls are solid.
                let coverage = (0.5 - distance).clamp(0.0, 1.0);
                let coverage = if coverage > 0.9 { 1.0 } else { coverage };
                if coverage > 0.1 {
                    paint(local, -distance).lay(cells, x, y, coverage);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotated_figures_cover_their_area() {
        for figure in [Figure::Box([20.0, 3.0]), Figure::Ball(9.0)] {
            let area = match figure {
                Figure::Box([x, y]) => 4.0 * x * y,
                Figure::Ball(radius) => std::f32::consts::PI * radius * radius,
            };
            for step in 0..12 {
                let mut cells = Cells::new(64, 64).unwrap();
                let paint = Paint::wall([0.5; 3]);
                figure.draw(&mut cells, [32.3, 31.6], step as f32 * 0.37, |_, _| paint);
                let sum: f32 = cells.opacity().iter().sum();
                // Coverage is rounded at the edge, which is a few per cent of the area.
                assert!((sum / area - 1.0).abs() < 0.03, "{figure:?} {step}: {sum} of {area}");
            }
        }
    }

    #[test]
    fn nothing_is_drawn_beyond_the_grid() {
        let mut cells = Cells::new(8, 8).unwrap();
        for at in [[-50.0, 4.0], [4.0, 1e6], [f32::NAN, 4.0]] {
            Figure::Ball(3.0).draw(&mut cells, at, 0.0, |_, _| Paint::wall([1.0; 3]));
        }
        assert!(cells.opacity().iter().all(|&o| o == 0.0));
    }
}
