//! Leaders that steer by themselves: laws, what a law does for leaders that are observed, and pilots, which lead a
//! flock by a law.

mod law;
mod leaning;
mod observed;
mod pilot;

pub use law::{Law, NamedLaw};
pub use leaning::{Bound, Judged, LeaningLaw};
pub use observed::ObservedLaw;
pub use pilot::Pilot;
