//! Views of the scene, of intermediate results, of the reference and of the error, computed on the CPU.

use anyhow::{Context as _, Result};
use eframe::egui::{Color32, ColorImage, Context, Painter, Pos2, Rect, TextureHandle};
use eframe::egui::{TextureOptions, Vec2};
use lamplight::image::RgbImage;
use lamplight::{Cells, Display, Light, Settings, Solver, debug_views};
use lamplight_truth::{Measures, PathTracer, ProgressiveReference, heat};
use std::time::Duration;
use web_time::Instant;

/// Time per frame for the reference.
const BUDGET: Duration = Duration::from_millis(10);
/// The smallest number of cells of the reference per frame.
const MIN_CELLS: usize = 64;

/// A view of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureView {
    /// The final picture.
    #[default]
    Picture,
    /// The light alone, on white.
    Light,
    Emission,
    Opacity,
    Albedo,
    Tint,
    Seeds,
    Voronoi,
    Distance,
    /// Intermediate results of the method.
    Inside,
    Reference,
    Error,
}

impl PictureView {
    pub const ALL: [Self; 12] = [
        Self::Picture,
        Self::Light,
        Self::Emission,
        Self::Opacity,
        Self::Albedo,
        Self::Tint,
        Self::Seeds,
        Self::Voronoi,
        Self::Distance,
        Self::Inside,
        Self::Reference,
        Self::Error,
    ];

    /// The name in lists and scripts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Light => "light",
            Self::Emission => "emission",
            Self::Opacity => "opacity",
            Self::Albedo => "albedo",
            Self::Tint => "tint",
            Self::Seeds => "seeds",
            Self::Voronoi => "voronoi",
            Self::Distance => "distance",
            Self::Inside => "inside",
            Self::Reference => "reference",
            Self::Error => "error",
        }
    }

    /// A description of one line.
    pub fn words(self) -> &'static str {
        match self {
            Self::Picture => "colour × light, tone mapped",
            Self::Light => "light alone, on white",
            Self::Emission => "emitted radiance of cells, with lamps drawn in",
            Self::Opacity => "opacity: white is solid",
            Self::Albedo => "the fraction of light that is reflected or scattered",
            Self::Tint => "the colour filter of glass and fog",
            Self::Seeds => "occupied cells, the input of the jump flood",
            Self::Voronoi => "the nearest occupied cell, one colour each",
            Self::Distance => "px to the nearest occupied cell, with contour lines",
            Self::Inside => "intermediate results of the method",
            Self::Reference => "the path-traced reference; it restarts when anything moves",
            Self::Error => "the difference to the reference, on the scale of reports",
        }
    }

    /// Returns true if it shows the light of the method directly.
    pub fn is_lit(self) -> bool {
        matches!(self, Self::Picture | Self::Light)
    }

    /// Returns true if it needs the light of the method on the CPU.
    pub fn needs_light(self) -> bool {
        self == Self::Error
    }
}

/// Computes and draws views.
pub struct Inspector {
    pub view: PictureView,
    /// Index of the intermediate result.
    pub inside: u32,
    solver: Option<Solver>,
    refining: Option<Watched>,
    texture: TextureHandle,
    /// A message about the view.
    message: String,
}

/// A reference and its inputs.
struct Watched {
    cells: Cells,
    settings: PathTracer,
    refining: ProgressiveReference,
    /// Cells to refine per frame.
    count: usize,
}

impl Inspector {
    pub fn new(context: &Context) -> Self {
        let black = ColorImage::filled([1, 1], Color32::BLACK);
        Self {
            view: PictureView::default(),
            inside: 0,
            solver: None,
            refining: None,
            texture: context.load_texture("view", black, TextureOptions::NEAREST),
            message: String::new(),
        }
    }

    /// Computes the current view. `light` is that of the method, if it has arrived.
    pub fn look(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        display: Display,
        light: Option<&Light>,
    ) -> Result<()> {
        self.message.clear();
        let looked = self.picture(cells, settings, display, light);
        // After an error, the picture of another view must not stay.
        let (picture, result) = match looked {
            Ok(picture) => (picture, Ok(())),
            Err(why) => (None, Err(why)),
        };
        if !self.view.is_lit() {
            let image = picture.map_or_else(
                || ColorImage::filled([1, 1], Color32::BLACK),
                |picture| {
                    let size = [picture.width() as usize, picture.height() as usize];
                    ColorImage::from_rgb(size, picture.as_raw())
                },
            );
            self.texture.set(image, TextureOptions::NEAREST);
        }
        result
    }

    /// The picture of the current view; `None` for light itself, and while there is nothing to show.
    fn picture(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        display: Display,
        light: Option<&Light>,
    ) -> Result<Option<RgbImage>> {
        Ok(Some(match self.view {
            PictureView::Picture | PictureView::Light => return Ok(None),
            PictureView::Emission => debug_views::emission(&cells.drawn(), &display),
            PictureView::Opacity => debug_views::opacity(&cells.drawn()),
            PictureView::Albedo => debug_views::albedo(&cells.drawn()),
            PictureView::Tint => debug_views::tint(&cells.drawn()),
            PictureView::Seeds | PictureView::Voronoi | PictureView::Distance => {
                self.fields(cells, settings)?
            }
            PictureView::Inside => self.inside(cells, settings, display)?,
            PictureView::Reference | PictureView::Error => {
                return self.compare(cells, settings, display, light);
            }
        }))
    }

    fn fields(&mut self, cells: &Cells, settings: &Settings) -> Result<RgbImage> {
        let view = self.view;
        let solver = solve(&mut self.solver, cells, &settings.fields_only())?;
        let stages = solver.stages();
        let width = cells.width();
        Ok(match view {
            PictureView::Seeds => debug_views::seeds(width, stages.seeds),
            PictureView::Voronoi => debug_views::seeds(width, stages.nearest),
            _ => debug_views::distance(width, stages.distance),
        })
    }

    fn inside(&mut self, cells: &Cells, settings: &Settings, display: Display) -> Result<RgbImage> {
        let solver = solve(&mut self.solver, cells, settings)?;
        let count = solver.debug_view_count();
        self.inside = self.inside.min(count.saturating_sub(1));
        let inside = solver.debug_view(self.inside, &display);
        let inside =
            inside.context("with these settings the method has no intermediate results")?;
        let number = self.inside + 1;
        self.message = format!("{number} of {count}: {}, {}", inside.name, inside.description);
        Ok(inside.picture)
    }

    /// The reference, or the difference to it; `None` before the first pass.
    fn compare(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        display: Display,
        light: Option<&Light>,
    ) -> Result<Option<RgbImage>> {
        let Settings { bounces, wall_depth, elevation, seed, .. } = *settings;
        let tracer = PathTracer { samples: 1, bounces, wall_depth, elevation, seed };
        let known = self.refining.take().filter(|w| w.settings == tracer && w.cells == *cells);
        let watched = match known {
            Some(known) => self.refining.insert(known),
            None => self.refining.insert(Watched {
                cells: cells.clone(),
                settings: tracer,
                refining: ProgressiveReference::new(tracer, cells)?,
                count: MIN_CELLS,
            }),
        };
        watched.refine();
        let passes = watched.refining.passes();
        let Some(truth) = watched.refining.light() else {
            self.message =
                "the first paths are being traced; pause the world if it moves".to_owned();
            return Ok(None);
        };
        let paths = 16 * passes;
        if self.view == PictureView::Reference {
            self.message = format!("{paths} paths per cell");
            return Ok(Some(truth.compose(cells, &display)?));
        }
        let same = |light: &&Light| light.pixels().len() == truth.pixels().len();
        let Some(light) = light.filter(same) else { return Ok(None) };
        let measures = Measures::of(light.pixels(), truth.pixels(), truth.solid());
        self.message = format!(
            "{:.1} % relative RMSE, including the noise of {paths} paths per cell",
            100.0 * measures.relative_rmse
        );
        Ok(Some(heat::map(light, &truth, measures.mean)))
    }

    /// Draws the view into a rectangle, with its own aspect ratio.
    pub fn draw(&self, painter: &Painter, place: Rect) {
        let [w, h] = self.texture.size().map(|side| side.max(1) as f32);
        let scale = (place.width() / w).min(place.height() / h);
        let place = Rect::from_center_size(place.center(), Vec2::new(w, h) * scale);
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        painter.image(self.texture.id(), place, all, Color32::WHITE);
    }

    /// The message or the description of the view.
    pub fn message(&self) -> &str {
        if self.message.is_empty() { self.view.words() } else { &self.message }
    }
}

impl Watched {
    /// Refines for about [`BUDGET`].
    fn refine(&mut self) {
        let start = Instant::now();
        self.refining.refine(self.count);
        let share = BUDGET.as_secs_f64() / start.elapsed().as_secs_f64().max(1e-6);
        let count = self.count as f64 * share.clamp(0.5, 2.0);
        self.count = (count as usize).clamp(MIN_CELLS, self.cells.len().max(MIN_CELLS));
    }
}

/// Solves a frame with the solver, or a new one.
fn solve<'a>(
    solver: &'a mut Option<Solver>,
    cells: &Cells,
    settings: &Settings,
) -> Result<&'a mut Solver> {
    let solver = match solver {
        Some(solver) => {
            solver.set_settings(settings.clone())?;
            solver
        }
        none => none.insert(Solver::new(settings.clone())?),
    };
    solver.solve(cells)?;
    Ok(solver)
}
