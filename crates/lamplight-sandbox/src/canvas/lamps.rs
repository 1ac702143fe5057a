//! Lamps and the sky of a canvas: what is not in cells.

use super::{Canvas, Error, Result};
use lamplight::{Lamp, Sky};

impl Canvas {
    /// The lamps.
    pub fn lamps(&self) -> &[Lamp] {
        self.cells.lamps()
    }

    /// The lamp whose disc, or a px about it, holds a point: the nearest.
    pub fn lamp_at(&self, [x, y]: [f32; 2]) -> Option<usize> {
        let away = |lamp: &Lamp| (lamp.position[0] - x).hypot(lamp.position[1] - y);
        let all = self.lamps().iter().enumerate();
        let near = all.filter(|(_, lamp)| away(lamp) <= lamp.size.max(2.0) + 1.0);
        near.min_by(|a, b| away(a.1).total_cmp(&away(b.1))).map(|(i, _)| i)
    }

    /// Adds a lamp and says its number.
    pub fn add_lamp(&mut self, lamp: Lamp) -> Result<usize> {
        let number = self.lamps().len();
        lamp.check(&format_args!("lamp[{number}]"))?;
        if number >= Self::MAX_LAMPS {
            return Err(Error::Lamps(number + 1));
        }
        self.grouped(|canvas| canvas.beside_mut().lamps_mut().push(lamp));
        Ok(number)
    }

    /// Changes a lamp: its place, colour, size.
    pub fn set_lamp(&mut self, number: usize, lamp: Lamp) -> Result<()> {
        lamp.check(&format_args!("lamp[{number}]"))?;
        if number >= self.lamps().len() {
            return Err(Error::NoLamp(number));
        }
        self.grouped(|canvas| canvas.beside_mut().lamps_mut()[number] = lamp);
        Ok(())
    }

    /// Moves a lamp. Between [`Canvas::begin`] and [`Canvas::end`] a whole drag is one edit.
    pub fn move_lamp(&mut self, number: usize, position: [f32; 2]) -> Result<()> {
        let lamp = *self.lamps().get(number).ok_or(Error::NoLamp(number))?;
        self.set_lamp(number, Lamp { position, ..lamp })
    }

    /// Removes a lamp; those after it move up.
    pub fn remove_lamp(&mut self, number: usize) -> Result<()> {
        if number >= self.lamps().len() {
            return Err(Error::NoLamp(number));
        }
        self.grouped(|canvas| {
            canvas.beside_mut().lamps_mut().remove(number);
        });
        Ok(())
    }

    /// Sets what lies beyond the canvas.
    pub fn set_sky(&mut self, sky: Sky) -> Result<()> {
        sky.check()?;
        self.grouped(|canvas| canvas.beside_mut().set_sky(sky));
        Ok(())
    }
}
