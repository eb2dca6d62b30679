//! Pictures of a flock, drawn without a display, and the colors that pages take from the same palette.

pub mod palette;

#[cfg(feature = "draw")]
mod boats;
#[cfg(feature = "draw")]
mod frame;
#[cfg(feature = "draw")]
mod legend;
#[cfg(feature = "draw")]
mod look;
#[cfg(feature = "draw")]
mod paint;
#[cfg(feature = "draw")]
mod text;
#[cfg(feature = "draw")]
mod view;
#[cfg(feature = "draw")]
mod water;

#[cfg(feature = "draw")]
pub use frame::FrameRenderer;
#[cfg(feature = "draw")]
pub use look::Look;
