//! Drawing of results, shared by the command `lamplight` and the project's chores.

pub mod plot;
