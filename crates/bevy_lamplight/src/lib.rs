//! Light for Bevy.
