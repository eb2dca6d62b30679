//! What leaders see: the layout of an observation, the camera between flock and eye, and the numbers.

mod camera;
mod entry;
mod fellow_leaders;
mod flock_features;
mod layout;
mod leader_law;
mod nearest;
mod nearest_obstacles;
mod observed_law;
mod observer;
mod view;

pub use camera::CameraSettings;
pub(crate) use camera::{Camera, CameraState};
pub(crate) use entry::{ANGULAR_VELOCITY_SCALE, speed_scale_cm_s};
pub use entry::{BOAT, Entry, Scale};
pub use flock_features::{FlockFeatures, flock_feature_entries};
pub use layout::{Block, OBSERVATION_VERSION, ObservationLayout, state_entries};
pub use leader_law::LeaderLaw;
pub use observed_law::ObservedLaw;
pub(crate) use observer::StateObserver;
pub use observer::{Observer, observe_flock};
pub use view::FlockView;
