//! Views of what a frame works with, of the right light, and of the error; all found on the CPU.

use anyhow::{Context as _, Result};
use eframe::egui::{Color32, ColorImage, Context, Painter, Pos2, Rect, TextureHandle};
use eframe::egui::{TextureOptions, Vec2};
use lamplight::image::RgbImage;
use lamplight::{Cells, Display, Light, Settings, Solver, views};
use lamplight_truth::{Measures, PathTracer, Refining, heat};
use std::time::Duration;
use web_time::Instant;

/// Time that the reference may take of a frame.
const BUDGET: Duration = Duration::from_millis(10);
/// Fewest cells of the reference in a frame.
const FEWEST: usize = 64;

/// What is to be seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
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
    /// What the method keeps to itself.
    Inside,
    Reference,
    Error,
}

impl View {
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

    /// What is to be seen, in a line.
    pub fn words(self) -> &'static str {
        match self {
            Self::Picture => "colour × light, tone mapped",
            Self::Light => "the light that arrives, alone",
            Self::Emission => "the light that cells give off, lamps drawn in",
            Self::Opacity => "what stops light: white is solid",
            Self::Albedo => "the share of light that is sent on",
            Self::Tint => "the colour filter of what light passes",
            Self::Seeds => "where there is matter, as the jump flood begins",
            Self::Voronoi => "the nearest occupied cell, a colour each, as it ends",
            Self::Distance => "px to it, with contour lines",
            Self::Inside => "what the method keeps to itself",
            Self::Reference => "the right light, path by path; it begins anew when something moves",
            Self::Error => "how far the light is from the right one; the same scale as the report",
        }
    }

    /// Whether it shows the light of a method, and nothing has to be looked up.
    pub fn is_lit(self) -> bool {
        matches!(self, Self::Picture | Self::Light)
    }

    /// Whether the light of a method has to come for it.
    pub fn needs_light(self) -> bool {
        self == Self::Error
    }
}

/// Makes views.
pub struct Inspector {
    pub view: View,
    /// Which of the inside.
    pub inside: u32,
    solver: Option<Solver>,
    refining: Option<Watched>,
    texture: TextureHandle,
    /// What is to be said about the view.
    said: String,
}

/// A reference, and what it is of.
struct Watched {
    cells: Cells,
    settings: PathTracer,
    refining: Refining,
    /// Cells that fit in a frame's time.
    count: usize,
}

impl Inspector {
    pub fn new(context: &Context) -> Self {
        let black = ColorImage::filled([1, 1], Color32::BLACK);
        Self {
            view: View::default(),
            inside: 0,
            solver: None,
            refining: None,
            texture: context.load_texture("view", black, TextureOptions::NEAREST),
            said: String::new(),
        }
    }

    /// Makes the view at hand; `light` is the method's, where it has come.
    pub fn look(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        display: Display,
        light: Option<&Light>,
    ) -> Result<()> {
        self.said.clear();
        let looked = self.picture(cells, settings, display, light);
        // What another view showed does not stay.
        let (picture, told) = match looked {
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
        told
    }

    /// The view at hand; none of light itself, and while there is nothing to see.
    fn picture(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        display: Display,
        light: Option<&Light>,
    ) -> Result<Option<RgbImage>> {
        Ok(Some(match self.view {
            View::Picture | View::Light => return Ok(None),
            View::Emission => views::emission(&cells.drawn(), &display),
            View::Opacity => views::opacity(&cells.drawn()),
            View::Albedo => views::albedo(&cells.drawn()),
            View::Tint => views::tint(&cells.drawn()),
            View::Seeds | View::Voronoi | View::Distance => self.fields(cells, settings)?,
            View::Inside => self.inside(cells, settings, display)?,
            View::Reference | View::Error => return self.compare(cells, settings, display, light),
        }))
    }

    fn fields(&mut self, cells: &Cells, settings: &Settings) -> Result<RgbImage> {
        let view = self.view;
        let solver = solve(&mut self.solver, cells, &settings.fields_only())?;
        let stages = solver.stages();
        let width = cells.width();
        Ok(match view {
            View::Seeds => views::seeds(width, stages.seeds),
            View::Voronoi => views::seeds(width, stages.nearest),
            _ => views::distance(width, stages.distance),
        })
    }

    fn inside(&mut self, cells: &Cells, settings: &Settings, display: Display) -> Result<RgbImage> {
        let solver = solve(&mut self.solver, cells, settings)?;
        let count = solver.insides();
        self.inside = self.inside.min(count.saturating_sub(1));
        let inside = solver.inside(self.inside, &display);
        let inside = inside.context("with these settings the method keeps nothing to itself")?;
        let number = self.inside + 1;
        self.said = format!("{number} of {count}: {}, {}", inside.name, inside.words);
        Ok(inside.picture)
    }

    /// The reference, or how far the light is from it; none before there is one.
    fn compare(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        display: Display,
        light: Option<&Light>,
    ) -> Result<Option<RgbImage>> {
        let Settings { bounces, wall_depth, seed, .. } = *settings;
        let tracer = PathTracer { samples: 1, bounces, wall_depth, seed };
        let known = self.refining.take().filter(|w| w.settings == tracer && w.cells == *cells);
        let watched = match known {
            Some(known) => self.refining.insert(known),
            None => self.refining.insert(Watched {
                cells: cells.clone(),
                settings: tracer,
                refining: Refining::new(tracer, cells)?,
                count: FEWEST,
            }),
        };
        watched.refine();
        let passes = watched.refining.passes();
        let Some(truth) = watched.refining.light() else {
            self.said =
                "the first paths are on their way, as long as nothing moves: worlds can be paused"
                    .to_owned();
            return Ok(None);
        };
        let paths = 16 * passes;
        if self.view == View::Reference {
            self.said = format!("{paths} paths a cell");
            return Ok(Some(truth.compose(cells, &display)?));
        }
        let same = |light: &&Light| light.pixels().len() == truth.pixels().len();
        let Some(light) = light.filter(same) else { return Ok(None) };
        let measures = Measures::of(light.pixels(), truth.pixels(), truth.solid());
        self.said = format!(
            "{:.1} % off (relative RMSE), the noise of {paths} paths a cell counted in",
            100.0 * measures.relative_rmse
        );
        Ok(Some(heat::map(light, &truth, measures.mean)))
    }

    /// Draws the view into a rectangle, as large as its own shape lets it be.
    pub fn draw(&self, painter: &Painter, place: Rect) {
        let [w, h] = self.texture.size().map(|side| side.max(1) as f32);
        let scale = (place.width() / w).min(place.height() / h);
        let place = Rect::from_center_size(place.center(), Vec2::new(w, h) * scale);
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        painter.image(self.texture.id(), place, all, Color32::WHITE);
    }

    /// What there is to say about the view.
    pub fn said(&self) -> &str {
        if self.said.is_empty() { self.view.words() } else { &self.said }
    }
}

impl Watched {
    /// Goes on for about a frame's time.
    fn refine(&mut self) {
        let start = Instant::now();
        self.refining.refine(self.count);
        let share = BUDGET.as_secs_f64() / start.elapsed().as_secs_f64().max(1e-6);
        let count = self.count as f64 * share.clamp(0.5, 2.0);
        self.count = (count as usize).clamp(FEWEST, self.cells.len().max(FEWEST));
    }
}

/// Solves a frame with a solver that is kept as long as the settings are the same.
fn solve<'a>(
    solver: &'a mut Option<Solver>,
    cells: &Cells,
    settings: &Settings,
) -> Result<&'a mut Solver> {
    let known = solver.take().filter(|known| known.settings() == settings);
    let solver = solver.insert(match known {
        Some(known) => known,
        None => Solver::new(settings.clone())?,
    });
    solver.solve(cells)?;
    Ok(solver)
}
