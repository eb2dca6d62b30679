//! Statistics of a flock's substeps: work counts and worst cases.

use super::solver::SolveReport;
use crate::parameters::{Value, named_fields};

/// Running statistics since the flock was created or reset; snapshots store them.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Statistics {
    /// Substeps taken.
    pub substeps: u64,
    /// Contact problems solved, relinearization passes included; substeps without a contact have none.
    pub solves: u64,
    /// Contacts and near-contacts, summed over substeps.
    pub contacts: u64,
    /// Islands with contacts, summed over solves.
    pub islands: u64,
    /// Solver iterations, summed over solves and islands.
    pub solver_iterations: u64,
    /// Rows of Cholesky factors computed.
    pub factored_rows: u64,
    /// Most numbers that the Cholesky factors of one solve held.
    pub most_factor_entries: u64,
    /// Substeps that left overlaps deeper than the tolerance. Either moving poses could not undo deep overlaps, or the
    /// substep could not be halved any further although constraints contradicted each other, relinearization did not
    /// converge, or a boat was pushed into a body beyond its reach. Velocities are then those of the nearest problem that
    /// can be solved.
    pub unsolved: u64,
    /// Halvings of substeps that left overlaps deeper than the tolerance, whose contacts would have added energy to
    /// boats or took too much work, or in which a boat moved too far.
    pub halved_substeps: u64,
    /// Passes that moved deeply overlapping hulls apart.
    pub depenetration_passes: u64,
    /// Rebuilds of the neighbor list in substeps; a substep may need several.
    pub neighbor_builds: u64,
    /// Largest natural residual of a solve in cm/s.
    pub worst_residual_cm_s: f64,
    /// Deepest overlap at the start of a substep in cm, positive.
    pub worst_overlap_cm: f64,
    /// Sum of the absolute changes of angular momentum about the pool's center when deep overlaps were undone, in
    /// cm²/s. No displacement conserves it for hulls that slide past each other while they overlap.
    pub displaced_angular_momentum_cm2_s: f64,
    /// Largest error in cm that an advance has estimated; 0 if no estimate was asked for.
    pub worst_error_cm: f64,
}

impl Statistics {
    /// All statistics by name.
    pub fn named(&self) -> Value {
        let counts = named_fields!(self; substeps solves contacts islands solver_iterations
            factored_rows most_factor_entries unsolved halved_substeps depenetration_passes
            neighbor_builds);
        let worst = named_fields!(self; worst_residual_cm_s worst_overlap_cm
            displaced_angular_momentum_cm2_s worst_error_cm);
        counts.into_iter().chain(worst).collect()
    }

    /// Statistics of overlaps, by name.
    pub fn named_overlaps(&self) -> Value {
        let named = named_fields!(self; worst_overlap_cm unsolved halved_substeps);
        named.into_iter().collect()
    }

    /// Counts one solve.
    pub fn count(&mut self, report: &SolveReport) {
        self.solves += 1;
        self.islands += report.islands;
        self.solver_iterations += report.iterations;
        self.factored_rows += report.factored_rows;
        self.most_factor_entries = self.most_factor_entries.max(report.factor_entries);
        self.worst_residual_cm_s = self.worst_residual_cm_s.max(report.residual);
    }
}
