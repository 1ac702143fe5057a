//! The canvas that another subject replaced, so that a click does not lose what was painted.

use crate::platform::File;
use crate::window::subject::Subject;
use lamplight_sandbox::canvas::{Canvas, Result};
use lamplight_sandbox::look::Look;

/// A canvas that was replaced; empty if there is none that is worth it.
#[derive(Default)]
pub struct Former(Option<Box<Canvas>>);

impl Former {
    /// Sets a subject aside that is replaced while it has this look. Returns true if it is a canvas with edits.
    ///
    /// A scene that was only opened does not take the place of edits.
    pub fn keep(&mut self, subject: Subject, look: Look) -> bool {
        let Subject::Canvas(mut canvas) = subject else { return false };
        canvas.end();
        let [done, undone] = canvas.history_depth();
        let has_edits = done > 0;
        let is_first = || Canvas::welcome(canvas.size()).is_ok_and(|c| c.cells() == canvas.cells());
        if has_edits || self.0.is_none() && (undone > 0 || !is_first()) {
            canvas.set_look(look);
            self.0 = Some(canvas);
        }
        has_edits
    }

    /// Takes the canvas back.
    pub fn take(&mut self) -> Option<Box<Canvas>> {
        self.0.take()
    }

    /// Returns true if undoing on a canvas brings the former one back: if nothing is done on it.
    pub fn precedes(&self, canvas: &Canvas) -> bool {
        self.0.is_some() && canvas.history_depth()[0] == 0
    }

    /// The files of the canvas as a scene; empty if there is none.
    pub fn scene(&self, name: &str) -> Result<Vec<File>> {
        self.0.as_ref().map_or(Ok(Vec::new()), |canvas| canvas.save(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::subject::Choice;
    use lamplight_sandbox::canvas::{Brush, Stuff};

    const SIZE: [u32; 2] = [96, 54];

    fn welcome() -> Box<Canvas> {
        Box::new(Canvas::welcome(SIZE).unwrap())
    }

    fn painted(color: f32) -> Box<Canvas> {
        let mut canvas = welcome();
        canvas.stroke(Brush { stuff: Stuff::Wall([color; 3]), radius: 3.0 }, &[[9.0, 9.0]]);
        canvas
    }

    #[test]
    fn a_painted_canvas_comes_back_as_it_was() {
        let mut former = Former::default();
        let look = Look { wall_depth: 7.0, ..Look::default() };
        assert!(former.keep(Subject::Canvas(painted(0.3)), look));
        // Neither a world nor an untouched or opened canvas takes its place.
        let opened = Box::new(Canvas::new(SIZE).unwrap());
        let world = Subject::new(Choice::Sand, SIZE, 1).unwrap();
        for other in [world, Subject::Canvas(welcome()), Subject::Canvas(opened)] {
            assert!(!former.keep(other, Look::default()));
        }
        assert!(former.precedes(&welcome()) && !former.precedes(&painted(0.1)));
        assert_eq!(former.scene("a").unwrap()[0].0, "a.toml");
        // Nor does one on which all was undone, such as that of a picture dropped on a world.
        let mut undone = painted(0.1);
        assert!(undone.undo() && former.precedes(&undone));
        assert!(!former.keep(Subject::Canvas(undone), Look::default()));
        let mut back = former.take().unwrap();
        assert!(back.cells() == painted(0.3).cells() && back.look() == look);
        assert!(back.undo() && back.cells() == welcome().cells());
        assert!(former.take().is_none() && !former.precedes(&welcome()));
    }

    #[test]
    fn the_later_edits_are_kept() {
        let mut former = Former::default();
        let opened = Box::new(Canvas::new(SIZE).unwrap());
        assert!(!former.keep(Subject::Canvas(welcome()), Look::default()));
        assert!(former.take().is_none());
        assert!(!former.keep(Subject::Canvas(opened), Look::default()));
        assert!(former.keep(Subject::Canvas(painted(0.1)), Look::default()));
        assert!(former.keep(Subject::Canvas(painted(0.2)), Look::default()));
        assert!(former.take().unwrap().cells() == painted(0.2).cells());
    }
}
