//! The laws of the physics, one file per law.
