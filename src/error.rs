//! Errors, in physical words. Nothing here knows of Python; `python::error` converts them.

/// Every error that the simulator reports. No input reaches a panic.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FlockError {
    /// A parameter, option or argument lies outside the accepted range.
    #[error("{field} = {value} is not accepted: {accepted}")]
    Parameter {
        /// The field's public name, unit included.
        field: &'static str,
        /// The given value.
        value: String,
        /// The accepted values.
        accepted: String,
    },
    /// A value is of another kind than its field.
    #[error("{field} must be {accepted}")]
    Kind {
        /// The field's public name.
        field: &'static str,
        /// The accepted values.
        accepted: String,
    },
    /// An array has the wrong number of entries.
    #[error("{field} has shape {found}, expected {expected}")]
    Shape {
        /// The name of the array.
        field: &'static str,
        /// The shape it has.
        found: String,
        /// The shape it should have.
        expected: String,
    },
    /// The pool is too small for the flock: no placement without overlap was found.
    #[error(
        "n_boats = {requested} boats do not fit the pool: at most {placed} were placed without \
         overlap; use fewer boats, a larger pool or fewer obstacles"
    )]
    Placement {
        /// Requested number of boats.
        requested: usize,
        /// Number of boats that the best attempt placed without overlap.
        placed: usize,
    },
    /// A state given by the user holds overlapping hulls.
    #[error("{what} overlap by {overlap_cm} cm; move them apart or pass allow_overlap=True")]
    Overlap {
        /// The boats (or boat and wall).
        what: String,
        /// Depth of the overlap in cm.
        overlap_cm: f64,
    },
    /// Snapshot bytes that this flock cannot continue from.
    #[error("snapshot not restored: {0}")]
    Snapshot(String),
    /// An environment was stepped before a reset or after the end of its episode.
    #[error("{0}")]
    Episode(String),
    /// The motion left the accepted range of states; the flock is as it was before the call.
    #[error("{0}")]
    Solver(String),
    /// Long work was stopped by a signal; nothing has changed.
    #[error("interrupted")]
    Interrupted,
    /// An object is at work in another thread.
    #[error("{0} is in use in another thread: each thread needs one of its own")]
    InUse(&'static str),
}

impl FlockError {
    /// A [`FlockError::Parameter`] from anything printable.
    #[cold]
    pub fn parameter(
        field: &'static str,
        value: impl std::fmt::Display,
        accepted: impl Into<String>,
    ) -> Self {
        Self::Parameter {
            field,
            value: readable(&value.to_string()),
            accepted: accepted.into(),
        }
    }

    /// The same error for one flock of a batch, with the number of others that failed.
    #[cold]
    pub(crate) fn of_flock(self, flock: usize, more: usize) -> Self {
        let others = match more {
            0 => String::new(),
            1 => " and 1 other".to_owned(),
            more => format!(" and {more} others"),
        };
        Self::Solver(format!(
            "flock {flock}{others}: {self}; its episode is over, the other flocks go on"
        ))
    }

    /// Refuses a value as [`Self::parameter`] does, unless it is accepted.
    ///
    /// # Errors
    /// [`FlockError::Parameter`].
    #[inline]
    pub(crate) fn unless(
        is_accepted: bool,
        field: &'static str,
        value: impl std::fmt::Display,
        accepted: impl Into<String>,
    ) -> Result<()> {
        if is_accepted {
            return Ok(());
        }
        Err(Self::parameter(field, value, accepted))
    }

    /// Refuses bytes or their content, with a reason, unless a condition holds.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`].
    pub(crate) fn unless_fitting(fits: bool, why: &str) -> Result<()> {
        fits.then_some(())
            .ok_or_else(|| Self::Snapshot(why.to_owned()))
    }
}

/// A text in which very long numbers have an exponent, such as 1e300.
fn readable(text: &str) -> String {
    const MOST_DIGITS: usize = 20;
    let (mut written, mut rest) = (String::new(), text);
    while let Some(start) = rest.find(|letter: char| letter.is_ascii_digit()) {
        let (before, from) = rest.split_at(start);
        let is_over = |letter: char| !letter.is_ascii_digit() && letter != '.';
        let (digits, after) = from.split_at(from.find(is_over).unwrap_or(from.len()));
        written += before;
        match digits.parse::<f64>() {
            // The full length is not known here.
            Ok(number) if digits.len() > MOST_DIGITS && !after.starts_with('…') => {
                written += &format!("{number:e}");
            }
            _ => written += digits,
        }
        rest = after;
    }
    written + rest
}

/// Shorthand for results with a [`FlockError`].
pub type Result<T> = std::result::Result<T, FlockError>;
