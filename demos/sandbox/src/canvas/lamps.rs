//! Lamps and the sky of a canvas.

use super::{Canvas, Error, Result};
use lamplight::{Lamp, Sky};

impl Canvas {
    /// The lamps.
    pub fn lamps(&self) -> &[Lamp] {
        self.cells.lamps()
    }

    /// The nearest lamp whose disc contains a point, within a tolerance of a px.
    pub fn lamp_at(&self, [x, y]: [f32; 2]) -> Option<usize> {
        let away = |lamp: &Lamp| (lamp.position[0] - x).hypot(lamp.position[1] - y);
        let all = self.lamps().iter().enumerate();
        let near = all.filter(|(_, lamp)| away(lamp) <= lamp.size.max(2.0) + 1.0);
        near.min_by(|a, b| away(a.1).total_cmp(&away(b.1))).map(|(i, _)| i)
    }

    /// Adds a lamp and returns its index.
    pub fn add_lamp(&mut self, lamp: Lamp) -> Result<usize> {
        let number = self.lamps().len();
        lamp.check(&format_args!("lamp[{number}]"))?;
        if number >= Self::MAX_LAMPS {
            return Err(Error::Lamps(number + 1));
        }
        self.grouped(|canvas| canvas.beside_mut().lamps_mut().push(lamp));
        Ok(number)
    }

    /// Replaces a lamp.
    pub fn set_lamp(&mut self, number: usize, lamp: Lamp) -> Result<()> {
        lamp.check(&format_args!("lamp[{number}]"))?;
        if number >= self.lamps().len() {
            return Err(Error::NoLamp(number));
        }
        self.grouped(|canvas| canvas.beside_mut().lamps_mut()[number] = lamp);
        Ok(())
    }

    /// Moves a lamp. A drag between [`Canvas::begin`] and [`Canvas::end`] is one edit.
    pub fn move_lamp(&mut self, number: usize, position: [f32; 2]) -> Result<()> {
        let lamp = self.lamps().get(number).ok_or(Error::NoLamp(number))?;
        self.set_lamp(number, Lamp { position, ..lamp.clone() })
    }

    /// Removes a lamp. The indices of later lamps decrease by one.
    pub fn remove_lamp(&mut self, number: usize) -> Result<()> {
        if number >= self.lamps().len() {
            return Err(Error::NoLamp(number));
        }
        self.grouped(|canvas| {
            canvas.beside_mut().lamps_mut().remove(number);
        });
        Ok(())
    }

    /// Sets the sky around the canvas.
    pub fn set_sky(&mut self, sky: Sky) -> Result<()> {
        sky.check()?;
        self.grouped(|canvas| canvas.beside_mut().set_sky(sky));
        Ok(())
    }
}
