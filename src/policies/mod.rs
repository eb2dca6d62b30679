//! Laws that steer leaders, their evaluation from observations, and pilots, which lead a flock by a law.

mod law;
mod leaning;
mod observed;
mod pilot;

pub use law::{Law, NamedLaw};
pub use leaning::{Bound, Judged, LeaningLaw};
pub use observed::ObservedLaw;
pub use pilot::Pilot;
