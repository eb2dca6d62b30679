//! The blocks of an observation. Each has a file with its entries and the writer of their physical values, and is
//! declared here: by `mod` and one line of [`declare_blocks`].

mod lean_features;
mod neighbors;
mod obstacles;
mod order;
mod own;
mod phase;
mod target;

pub use lean_features::{LEAN_FEATURES, LeanFeatures};
pub(crate) use own::{OWN, own_values};
pub(crate) use phase::{PHASE, phase_values};
pub(crate) use target::TARGET;

use super::entry::Entry;
use super::view::FlockView;
use crate::error::Result;
use crate::geometry::LapFrame;
use crate::parameters::{FlockParameters, named_choice};

/// A flock as one of its leaders sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeaderView<'a> {
    /// The flock.
    pub flock: &'a FlockView<'a>,
    /// Index of the leader. Leaders are observed one after another, from 0.
    pub leader: usize,
    /// The leader's outward and clockwise axes.
    pub frame: LapFrame,
}

impl<'a> LeaderView<'a> {
    /// The flock as that leader sees it.
    pub(super) fn new(flock: &'a FlockView<'a>, leader: usize) -> Self {
        Self {
            flock,
            leader,
            frame: LapFrame::at(flock.poses[leader].position),
        }
    }
}

/// A writer that is made from a flock's parameters. Types that implement `Default` are the same for every flock.
trait FromParameters: Sized {
    /// The writer for checked parameters.
    ///
    /// # Errors
    /// [`crate::FlockError::Parameter`] for flocks that the block cannot describe.
    fn from_parameters(parameters: &FlockParameters) -> Result<Self>;
}

impl<T: Default> FromParameters for T {
    fn from_parameters(_parameters: &FlockParameters) -> Result<Self> {
        Ok(Self::default())
    }
}

/// Writer of the physical values of a block.
trait WriteBlock: FromParameters {
    /// Appends the values of a block that occurs `repeats` times, in the order of its entries.
    fn write(&mut self, view: &LeaderView, repeats: usize, physical: &mut Vec<f64>);
}

/// Declares blocks in the order of an observation: name, entries, writer, default number of occurrences, and `counted` if
/// the block may occur more than once, such as once per neighbor, otherwise `once`.
macro_rules! declare_blocks {
    ($($(#[doc = $doc:literal])+ $block:ident = $name:literal:
        $module:ident::{$entries:ident, $writer:ident}, $default:literal $counted:ident;)+) => {
        named_choice! {
            /// A part of the observation that can be switched off.
            pub enum Block ("observation") { $($(#[doc = $doc])+ $block = $name,)+ }
        }

        impl Block {
            /// Number of blocks.
            pub(super) const COUNT: usize = Self::ALL.len();

            /// Default number of occurrences of each block.
            pub(super) const DEFAULT: [usize; Self::COUNT] = [$($default),+];

            /// Whether the block may occur more than once, like that of a neighbor.
            pub fn is_counted(self) -> bool {
                match self { $(Self::$block => declare_blocks!(@ $counted),)+ }
            }

            /// Name of this block's option in messages.
            pub fn option(self) -> &'static str {
                match self { $(Self::$block => concat!("observation ", $name),)+ }
            }

            /// The block's entries; for a counted block, those of one neighbor or obstacle.
            pub(crate) fn entries(self) -> &'static [Entry] {
                match self { $(Self::$block => &$module::$entries,)+ }
            }
        }

        /// The writers of the blocks in a layout, each with its number of occurrences.
        #[derive(Debug, Clone)]
        pub(super) struct Writers { $($module: Option<(usize, $module::$writer)>,)+ }

        impl Writers {
            /// Writers for checked parameters; `repeats` says how often each block occurs.
            ///
            /// # Errors
            /// [`crate::FlockError::Parameter`] for flocks that one of the blocks cannot describe.
            pub(super) fn new(repeats: impl Fn(Block) -> usize, parameters: &FlockParameters) -> Result<Self> {
                Ok(Self { $($module: match repeats(Block::$block) {
                    0 => None,
                    count => Some((count, $module::$writer::from_parameters(parameters)?)),
                },)+ })
            }

            /// Appends the physical values of all blocks.
            pub(super) fn write(&mut self, view: &LeaderView, physical: &mut Vec<f64>) {
                $(if let Some((repeats, writer)) = &mut self.$module {
                    writer.write(view, *repeats, physical);
                })+
            }
        }
    };
    (@ counted) => { true };
    (@ once) => { false };
}

declare_blocks! {
    /// The leader itself.
    Own = "own": own::{OWN, Own}, 1 once;
    /// Time in the fw-nop-bw-nop cycle.
    Phase = "phase": phase::{PHASE, Phase}, 1 once;
    /// The direction to lead in.
    Target = "target": target::{TARGET, Target}, 1 once;
    /// The nearest boats.
    Neighbors = "neighbors": neighbors::{NEIGHBOR, Neighbors}, 6 counted;
    /// Order parameters of the normal boats.
    Order = "order": order::{ORDER, Order}, 1 once;
    /// The nearest obstacles.
    Obstacles = "obstacles": obstacles::{OBSTACLE, NearestObstacles}, 0 counted;
    /// Features that a leader's lean depends on, mirrored so that the target is clockwise, and standardized.
    LeanFeatures = "lean_features": lean_features::{ENTRIES, LeanFeatures}, 0 once;
}
