//! The module `lamplight2d._core`: the solver and the reference over numpy arrays.
//!
//! Objects are immutable, so that arrays can be views of them and several threads can read them.

mod arrays;
mod cells;
mod command;
mod json;
mod light;
mod map;
mod reference;
mod scene;
mod solver;
mod threads;
mod tiling;
mod window;
mod world;

use pyo3::pymodule;

#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use crate::cells::{Cells, cells_within};
    #[pymodule_export]
    use crate::command::run_command;
    #[pymodule_export]
    use crate::light::Light;
    #[pymodule_export]
    use crate::map::Map;
    #[pymodule_export]
    use crate::reference::{Measures, Reference, compare, join_parts, reference, trace_part};
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::solver::Solver;
    #[pymodule_export]
    use crate::tiling::Tiling;
    #[pymodule_export]
    use crate::world::{FarWorld, Lamps};
}
