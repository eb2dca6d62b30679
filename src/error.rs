//! Errors that the simulator reports. Nothing here knows of Python; `python::error` converts them.

/// Every error that the simulator reports. No input from a user causes a panic.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FlockError {
    /// A parameter, option or argument lies outside the accepted range.
    #[error("{field} = {value} is not accepted: {accepted}")]
    Parameter {
        /// The field's public name, unit included.
        field: &'static str,
        /// The refused value.
        value: String,
        /// The accepted values.
        accepted: String,
    },
    /// A value has the wrong type for its field.
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
        /// The overlapping hulls: two boats, or a boat and a wall.
        what: String,
        /// Depth of the overlap in cm.
        overlap_cm: f64,
    },
    /// Bytes of a snapshot from which this flock or environment cannot continue.
    #[error("snapshot not restored: {0}")]
    Snapshot(String),
    /// An environment was stepped before a reset or after the end of its episode.
    #[error("{0}")]
    Episode(String),
    /// The motion left the accepted range of states; the flock has the state from before the call.
    #[error("{0}")]
    Solver(String),
    /// A long computation was stopped by a signal.
    #[error("interrupted")]
    Interrupted,
    /// Another thread is using an object.
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

    /// Adds to this error which flock of a batch failed, and how many further flocks did.
    #[cold]
    pub(crate) fn with_flock(self, flock: usize, further_flocks: usize) -> Self {
        let others = match further_flocks {
            0 => String::new(),
            1 => " and 1 other".to_owned(),
            count => format!(" and {count} others"),
        };
        Self::Solver(format!(
            "flock {flock}{others}: {self}; its episode is over, the other flocks go on"
        ))
    }

    /// Refuses a value if `is_accepted` is false.
    ///
    /// # Errors
    /// The [`FlockError::Parameter`] that [`Self::parameter`] makes.
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

    /// Refuses stored bytes, or their content, if `fits` is false.
    ///
    /// # Errors
    /// [`FlockError::Snapshot`] with the reason.
    pub(crate) fn unless_fitting(fits: bool, reason: &str) -> Result<()> {
        fits.then_some(())
            .ok_or_else(|| Self::Snapshot(reason.to_owned()))
    }
}

/// Writes a text's numbers of more than 20 digits with an exponent, such as 1e300.
fn readable(text: &str) -> String {
    const MOST_DIGITS: usize = 20;
    let (mut output, mut remaining) = (String::new(), text);
    while let Some(start) = remaining.find(|letter: char| letter.is_ascii_digit()) {
        let (before, from_digit) = remaining.split_at(start);
        let is_past_number = |letter: char| !letter.is_ascii_digit() && letter != '.';
        let end = from_digit.find(is_past_number).unwrap_or(from_digit.len());
        let (digits, after) = from_digit.split_at(end);
        output += before;
        match digits.parse::<f64>() {
            // A number that is cut off by '…' has an unknown magnitude.
            Ok(number) if digits.len() > MOST_DIGITS && !after.starts_with('…') => {
                output += &format!("{number:e}");
            }
            _ => output += digits,
        }
        remaining = after;
    }
    output + remaining
}

/// Shorthand for results with a [`FlockError`].
pub type Result<T> = std::result::Result<T, FlockError>;
