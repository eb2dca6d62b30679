//! Many flocks stepped in parallel. Each flock's bits are its own: they depend neither on the batch it
//! is in nor on the number of threads.

use super::flock::Flock;
use crate::clock::{Ticks, seconds};
use crate::error::{FlockError, Result};
use crate::integrator::Steering;
use crate::parallel;
use crate::parameters::FlockParameters;

/// A batch of flocks, which may differ in parameters.
#[derive(Debug, Clone)]
pub struct FlockBatch {
    flocks: Vec<Flock>,
}

impl FlockBatch {
    /// One flock for each (parameters, seed).
    ///
    /// # Errors
    /// The first error of making a flock.
    pub fn new(members: Vec<(FlockParameters, u64)>) -> Result<Self> {
        let flocks = parallel::map(members, |(parameters, seed)| Flock::new(parameters, seed));
        Ok(Self {
            flocks: flocks.into_iter().collect::<Result<_>>()?,
        })
    }

    /// How many flocks there are.
    pub fn len(&self) -> usize {
        self.flocks.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.flocks.is_empty()
    }

    /// The flocks.
    pub fn flocks(&self) -> &[Flock] {
        &self.flocks
    }

    /// The flocks, to change.
    pub fn flocks_mut(&mut self) -> &mut [Flock] {
        &mut self.flocks
    }

    /// Advances every flock by so many ticks; `rudders` holds the commands of all flocks' leaders one
    /// after another, `None` steers by the paper's law.
    ///
    /// # Errors
    /// A bad rudder or duration refuses the whole step before anything moves. A flock whose numbers left the finite
    /// range is as it was before, and its error is returned after the others have moved.
    pub fn advance(&mut self, duration: Ticks, rudders: Option<&[f64]>) -> Result<()> {
        self.check_rudder_count(rudders)?;
        let mut begin = 0;
        let mut moves = Vec::with_capacity(self.flocks.len());
        for flock in &self.flocks {
            let leaders = flock.parameters().n_leaders;
            let commands = rudders.map(|all| &all[begin..begin + leaders]);
            flock.check_rudder(commands)?;
            let end = flock.end_of(seconds(duration))?;
            moves.push((end, commands.map_or(Steering::Law, Steering::Held)));
            begin += leaders;
        }
        let pairs: Vec<_> = self.flocks.iter_mut().zip(moves).collect();
        let advance = |(flock, (end, steering)): (&mut Flock, _)| flock.advance_to(end, steering);
        parallel::map(pairs, advance).into_iter().collect()
    }

    fn check_rudder_count(&self, rudders: Option<&[f64]>) -> Result<()> {
        let leaders: usize = self.flocks.iter().map(|f| f.parameters().n_leaders).sum();
        match rudders {
            Some(commands) if commands.len() != leaders => Err(FlockError::Shape {
                field: "rudder",
                found: format!("({},)", commands.len()),
                expected: format!("({leaders},), one a leader of every flock"),
            }),
            _ => Ok(()),
        }
    }
}
