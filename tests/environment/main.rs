//! Laws of the environment core.
