//! Pictures of flocks.

mod frames;

pub use frames::FrameRenderer;
