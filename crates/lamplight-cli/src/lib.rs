//! What the command `lamplight` shares with the project's chores: how results are drawn.

pub mod plot;
