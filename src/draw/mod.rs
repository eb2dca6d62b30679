//! Pictures of flocks, and animations of pictures.

mod animation;
mod frames;

pub use animation::{AnimationEncoder, AnimationFormat};
pub use frames::FrameRenderer;
