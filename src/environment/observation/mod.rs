//! Observations of leaders: their layout, the camera through which leaders see the flock, and the observed numbers.

mod blocks;
mod camera;
mod course;
mod entry;
mod flock_features;
mod layout;
mod nearest;
mod observer;
mod view;

pub use blocks::{Block, LEAN_FEATURES, LeanFeatures};
pub(crate) use camera::{Camera, Lens};
pub use course::{CourseReader, CourseView};
pub(crate) use entry::{ANGULAR_VELOCITY_SCALE, speed_scale_cm_s};
pub use entry::{BOAT, Entry, Scale};
pub use flock_features::{FlockFeatures, flock_feature_entries};
pub use layout::{OBSERVATION_VERSION, ObservationLayout, state_entries};
pub(crate) use observer::StateObserver;
pub use observer::{Observer, observe_flock};
pub use view::FlockView;
