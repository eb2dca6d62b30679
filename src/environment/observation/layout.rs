//! The entries that a leader observes, in order.

use super::entry::{
    BOAT, CLOCK, Entry, FELLOW_LEADER, LAW_RUDDER, NEIGHBOR, OBSTACLE, ORDER, OWN, PHASE, TARGET,
};
use crate::boat::Law;
use crate::environment::tuned_law;
use crate::error::{FlockError, Result};
use crate::parameters::{FlockParameters, named_choice};

/// Newest version of the observation: of the entries, their order, scales and bounds. A policy belongs to the one of
/// its layout.
pub const OBSERVATION_VERSION: u32 = 2;

/// The most neighbors, the most obstacles and the most fellow leaders that a leader may observe.
pub(crate) const MOST_NEIGHBORS: usize = 64;

named_choice! {
    /// A part of the observation that can be switched off.
    pub enum Block ("observation") {
        /// The leader itself.
        Own = "own",
        /// Where in the fw-nop-bw-nop cycle the flock is.
        Phase = "phase",
        /// The direction to lead the flock in.
        Target = "target",
        /// The nearest boats.
        Neighbors = "neighbors",
        /// Order parameters of the normal boats.
        Order = "order",
        /// The rudder of the pool's tuned law.
        LawRudder = "law_rudder",
        /// The nearest obstacles.
        Obstacles = "obstacles",
        /// The nearest fellow leaders, at any distance.
        FellowLeaders = "fellow_leaders",
    }
}

impl Block {
    /// Whether the block may occur more than once, as that of a neighbor does.
    pub fn is_counted(self) -> bool {
        matches!(
            self,
            Self::Neighbors | Self::Obstacles | Self::FellowLeaders
        )
    }

    /// What messages call the choice of this block.
    pub fn option(self) -> &'static str {
        match self {
            Self::Own => "observation own",
            Self::Phase => "observation phase",
            Self::Target => "observation target",
            Self::Neighbors => "observation neighbors",
            Self::Order => "observation order",
            Self::LawRudder => "observation law_rudder",
            Self::Obstacles => "observation obstacles",
            Self::FellowLeaders => "observation fellow_leaders",
        }
    }
}

/// Which blocks are on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ObservationLayout {
    /// The leader itself.
    pub own: bool,
    /// The phase.
    pub phase: bool,
    /// The target direction.
    pub target: bool,
    /// How many of the nearest boats; 0: off.
    pub neighbors: usize,
    /// Order parameters.
    pub order: bool,
    /// Whether observation and action are reflected where the target is counter-clockwise, so that
    /// both directions are one task, the clockwise one.
    pub mirror_to_target: bool,
    /// The rudder of the pool's tuned law.
    pub law_rudder: bool,
    /// How many of the nearest obstacles; 0: off.
    pub obstacles: usize,
    /// How many of the nearest fellow leaders; 0: off.
    pub fellow_leaders: usize,
}

impl Default for ObservationLayout {
    fn default() -> Self {
        Self {
            own: true,
            phase: true,
            target: true,
            neighbors: 6,
            order: true,
            mirror_to_target: false,
            law_rudder: false,
            obstacles: 0,
            fellow_leaders: 0,
        }
    }
}

impl ObservationLayout {
    /// Checks the layout.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if nothing is observed, or too many neighbors, obstacles or fellow leaders.
    pub fn check(&self) -> Result<()> {
        for &block in Block::ALL {
            let repeats = self.repeats(block);
            if repeats > MOST_NEIGHBORS {
                let accepted = format!("0 (off) to {MOST_NEIGHBORS}");
                return Err(FlockError::parameter(block.option(), repeats, accepted));
            }
        }
        if self.size() == 0 {
            return Err(FlockError::parameter(
                "observation",
                "no block",
                "at least one of own, phase, target, neighbors, order, law_rudder, obstacles and fellow_leaders",
            ));
        }
        Ok(())
    }

    /// The version of the observation that has this layout: 1 without obstacles and fellow leaders.
    pub fn version(&self) -> u32 {
        if self.obstacles > 0 || self.fellow_leaders > 0 {
            OBSERVATION_VERSION
        } else {
            1
        }
    }

    /// The law whose rudder is observed, if it is.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] in a pool in which it has not been tuned.
    pub fn law(&self, parameters: &FlockParameters) -> Result<Option<Law>> {
        self.law_rudder
            .then(|| tuned_law("observation law_rudder", "true", parameters))
            .transpose()
    }

    /// The entries of a block; those of a counted block are one neighbor's, obstacle's or leader's.
    pub(crate) fn entries_of(block: Block) -> &'static [Entry] {
        match block {
            Block::Own => &OWN,
            Block::Phase => &PHASE,
            Block::Target => &TARGET,
            Block::Neighbors => &NEIGHBOR,
            Block::Order => &ORDER,
            Block::LawRudder => &LAW_RUDDER,
            Block::Obstacles => &OBSTACLE,
            Block::FellowLeaders => &FELLOW_LEADER,
        }
    }

    /// How often a block occurs: 0 or 1, or the number of neighbors, obstacles or fellow leaders.
    pub fn repeats(&self, block: Block) -> usize {
        match block {
            Block::Own => usize::from(self.own),
            Block::Phase => usize::from(self.phase),
            Block::Target => usize::from(self.target),
            Block::Neighbors => self.neighbors,
            Block::Order => usize::from(self.order),
            Block::LawRudder => usize::from(self.law_rudder),
            Block::Obstacles => self.obstacles,
            Block::FellowLeaders => self.fellow_leaders,
        }
    }

    /// Has a block occur so often: 0 or 1, or the number of neighbors, obstacles or fellow leaders.
    pub fn repeat(&mut self, block: Block, repeats: usize) {
        match block {
            Block::Own => self.own = repeats > 0,
            Block::Phase => self.phase = repeats > 0,
            Block::Target => self.target = repeats > 0,
            Block::Neighbors => self.neighbors = repeats,
            Block::Order => self.order = repeats > 0,
            Block::LawRudder => self.law_rudder = repeats > 0,
            Block::Obstacles => self.obstacles = repeats,
            Block::FellowLeaders => self.fellow_leaders = repeats,
        }
    }

    /// Where a block starts, if it is on.
    pub fn offset(&self, wanted: Block) -> Option<usize> {
        let mut offset = 0;
        for &block in Block::ALL {
            if block == wanted {
                return (self.repeats(block) > 0).then_some(offset);
            }
            offset += self.repeats(block) * Self::entries_of(block).len();
        }
        None
    }

    /// Where an entry of a block stands, if the block is on; the first neighbor's for `Neighbors`.
    pub fn place(&self, block: Block, name: &str) -> Option<usize> {
        let entries = Self::entries_of(block);
        let place = entries.iter().position(|entry| entry.name == name)?;
        self.offset(block).map(|offset| offset + place)
    }

    /// Size of the observation of one leader.
    pub fn size(&self) -> usize {
        Block::ALL
            .iter()
            .map(|&block| self.repeats(block) * Self::entries_of(block).len())
            .sum()
    }

    /// All entries in order, with their block and its count from 0.
    pub fn entries(&self) -> Vec<(Block, usize, Entry)> {
        Block::ALL
            .iter()
            .flat_map(|&block| (0..self.repeats(block)).map(move |count| (block, count)))
            .flat_map(|(block, count)| {
                Self::entries_of(block)
                    .iter()
                    .map(move |entry| (block, count, *entry))
            })
            .collect()
    }
}

/// All entries of the global state of so many boats.
pub fn state_entries(boats: usize) -> Vec<Entry> {
    let mut entries: Vec<Entry> = (0..boats).flat_map(|_| BOAT).collect();
    entries.extend(PHASE.iter().chain(&TARGET).chain(&CLOCK));
    entries
}
