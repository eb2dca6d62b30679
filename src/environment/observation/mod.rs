//! What leaders see: the layout of an observation, the camera between flock and eye, and the numbers.

mod camera;
mod entry;
mod layout;
mod observed_law;
mod observer;

pub use camera::{Camera, CameraSettings, CameraState};
pub use entry::{ANGULAR_VELOCITY_SCALE, BOAT, Entry, Scale, speed_scale_cm_s};
pub use layout::{Block, MOST_NEIGHBORS, OBSERVATION_VERSION, ObservationLayout, state_entries};
pub use observed_law::ObservedLaw;
pub use observer::{FlockView, Observer, StateObserver};
