//! The tests of the judge and of what it judges, in one program, which is linked once.

mod bounces;
mod cascades;
mod common;
mod cookbook;
mod direct;
mod holographic;
mod holographic_gold;
mod inflow;
mod invariants;
mod lamps;
mod moments;
mod progressive;
mod raymarch;
mod sky;
mod spots;
mod suns;
