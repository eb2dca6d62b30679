//! What the pool's tuned law would do.

use super::super::course::CourseView;
use super::super::entry::{Entry, Scale, UNIT};
use super::{MadeFor, Seen, WriteBlock};
use crate::boat::DampedLaw;
use crate::error::Result;
use crate::parameters::FlockParameters;

/// What the tuned law would do.
#[rustfmt::skip]
pub(super) const LAW_RUDDER: [Entry; 1] = [
    Entry::new("law_rudder", "", Scale::Plain, UNIT, "rudder of the pool's tuned law, which reads what the leader sees of itself").odd(),
];

/// Writes [`LAW_RUDDER`].
#[derive(Debug, Clone)]
pub(super) struct LawRudder {
    law: DampedLaw,
    courses: CourseView,
}

impl MadeFor for LawRudder {
    fn made_for(parameters: &FlockParameters) -> Result<Self> {
        Ok(Self {
            law: DampedLaw::tuned("observation law_rudder", "true", parameters.pool.name())?,
            courses: CourseView::new(parameters)?,
        })
    }
}

impl WriteBlock for LawRudder {
    fn write(&mut self, seen: &Seen, _repeats: usize, physical: &mut Vec<f64>) {
        let course = self.courses.course(seen.view, seen.leader, 0.0);
        physical.push(self.law.rudder(&course));
    }
}
