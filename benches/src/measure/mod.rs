//! The measurements, one file each.

pub mod horizon;
pub mod momentum;
pub mod order;
pub mod overlap;
pub mod parts;
pub mod profile;
pub mod slide;
pub mod solvers;
pub mod speed;
pub mod threads;
pub mod wall_push;
pub mod work;

use crate::Configuration;
use crate::table::Table;
use flockenv::FlockParameters;
use flockenv::geometry::{Pose, rms_distance};
use rayon::prelude::*;

/// How much to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Enough to see that everything runs.
    Trial,
    /// Enough for the report.
    Full,
}

impl Effort {
    /// Chooses one of two amounts.
    pub fn choose<T>(self, trial: T, full: T) -> T {
        match self {
            Self::Trial => trial,
            Self::Full => full,
        }
    }
}

/// A table whose rows start with a configuration.
pub fn table(columns: &[&str]) -> Table {
    Table::new(&[Configuration::COLUMNS.as_slice(), columns].concat())
}

/// Appends a row that starts with the cells of a configuration.
pub fn push_row(table: &mut Table, configuration: &[String], cells: Vec<String>) {
    table.row([configuration, cells.as_slice()].concat());
}

/// Maps items on all cores; not for timed work.
pub fn on_all_cores<I: Sync, T: Send>(items: &[I], work: impl Fn(&I) -> T + Send + Sync) -> Vec<T> {
    items.par_iter().map(work).collect()
}

/// Distance of two sets of poses in cm, in the metric of these boats.
pub fn distance(parameters: &FlockParameters, a: &[Pose], b: &[Pose]) -> f64 {
    rms_distance(a, b, parameters.gyration_radius_cm)
}
