//! Parameters of a flock: its fields, named sets of them, pools, and the choices users make by name.

mod choices;
mod field;
mod fields;
mod named_choice;
mod obstacles;
mod pools;
mod presets;
mod targets;
mod value;

pub use choices::{Noise, Scheme, Solver, Target};
pub(crate) use field::declare_fields;
pub use field::{Field, Range};
pub use fields::FlockParameters;
pub(crate) use named_choice::named_choice;
pub use obstacles::*;
pub use pools::Pool;
pub use presets::{Physics, Preset};
pub use targets::Targets;
pub use value::{Kind, Value};
pub(crate) use value::{Setting, named_fields, text_of, wrong_kind};
