//! The entries that a leader observes, in order.

use super::blocks::{Block, PHASE, TARGET};
use super::entry::{BOAT, CLOCK, Entry};
use crate::error::{FlockError, Result};
use crate::parameters::{Kind, Setting, Value, wrong_kind};

/// Version of the observation: of the entries, their order, scales and bounds. A policy runs only with the version in
/// its file.
pub const OBSERVATION_VERSION: u32 = 1;

/// The largest number of neighbors, and of obstacles, that a leader may observe.
pub(crate) const MOST_NEIGHBORS: usize = 64;

/// Selection of blocks: how often each block occurs in an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ObservationLayout {
    /// Occurrences of each block; 0 if the block is off.
    #[serde(with = "stored_repeats")]
    repeats: [usize; Block::COUNT],
    /// Whether observation and action are reflected if the target is counter-clockwise, so that leaders always meet the
    /// clockwise task.
    pub is_mirrored: bool,
}

/// The stored form of occurrences, by the names of the blocks. A missing block has its default.
mod stored_repeats {
    use super::Block;
    use crate::by_name;

    pub(super) fn serialize<S: serde::Serializer>(
        repeats: &[usize; Block::COUNT],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let names = Block::ALL.iter().map(|block| block.name());
        by_name::write(names.zip(*repeats), serializer)
    }

    pub(super) fn deserialize<'de, D: serde::Deserializer<'de>>(
        deserializer: D,
    ) -> Result<[usize; Block::COUNT], D::Error> {
        let mut repeats = Block::DEFAULT;
        let set = |name: &str, count| {
            let block = name.parse::<Block>();
            block.map(|block| repeats[block as usize] = count).is_ok()
        };
        by_name::read(deserializer, "the blocks of an observation", set)?;
        Ok(repeats)
    }
}

impl Default for ObservationLayout {
    fn default() -> Self {
        Self {
            repeats: Block::DEFAULT,
            is_mirrored: false,
        }
    }
}

impl ObservationLayout {
    /// A layout with only these blocks, each once.
    pub fn from_blocks(blocks: &[Block]) -> Self {
        let mut layout = Self {
            repeats: [0; Block::COUNT],
            is_mirrored: false,
        };
        for &block in blocks {
            layout.repeat(block, 1);
        }
        layout
    }

    /// This layout, mirrored or not.
    #[must_use]
    pub fn mirrored(self, is_mirrored: bool) -> Self {
        Self {
            is_mirrored,
            ..self
        }
    }

    /// Checks the layout.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if all blocks are off, or if there are too many neighbors or obstacles.
    pub fn check(&self) -> Result<()> {
        for &block in Block::ALL {
            let repeats = self.repeats(block);
            let most = if block.is_counted() {
                MOST_NEIGHBORS
            } else {
                1
            };
            let accepted = format!("0 (off) to {most}");
            FlockError::unless(repeats <= most, block.option(), repeats, accepted)?;
        }
        let accepted = format!("at least one of {}", Block::names().join(", "));
        FlockError::unless(self.size() > 0, "observation", "no block", accepted)
    }

    /// Whether a block is on.
    pub fn has(&self, block: Block) -> bool {
        self.repeats(block) > 0
    }

    /// Occurrences of a block: 0 or 1, or the number of neighbors or obstacles.
    pub fn repeats(&self, block: Block) -> usize {
        self.repeats[block as usize]
    }

    /// Sets the occurrences of a block: the number of neighbors or obstacles; at most 1 for any other block.
    pub fn repeat(&mut self, block: Block, repeats: usize) {
        self.repeats[block as usize] = if block.is_counted() {
            repeats
        } else {
            repeats.min(1)
        };
    }

    /// Index of a block's first entry in the observation; `None` if the block is off.
    pub fn offset(&self, block: Block) -> Option<usize> {
        let earlier_blocks = Block::ALL.iter().take(block as usize);
        let sizes = earlier_blocks.map(|&block| self.repeats(block) * block.entries().len());
        self.has(block).then(|| sizes.sum())
    }

    /// Index of an entry of a block in the observation; `None` if the block is off. If the block occurs more than once,
    /// the entry is that of its first occurrence, such as the nearest neighbor.
    pub fn index(&self, block: Block, name: &str) -> Option<usize> {
        let mut entries = block.entries().iter();
        let index = entries.position(|entry| entry.name == name)?;
        self.offset(block).map(|offset| offset + index)
    }

    /// Number of entries in the observation of one leader.
    pub fn size(&self) -> usize {
        let blocks = Block::ALL.iter();
        blocks
            .map(|&block| self.repeats(block) * block.entries().len())
            .sum()
    }

    /// All entries in order, each with its block and the number of the block's occurrence, from 0.
    pub fn entries(&self) -> Vec<(Block, usize, Entry)> {
        Block::ALL
            .iter()
            .flat_map(|&block| (0..self.repeats(block)).map(move |number| (block, number)))
            .flat_map(|(block, number)| {
                let entries = block.entries().iter();
                entries.map(move |entry| (block, number, *entry))
            })
            .collect()
    }
}

impl Setting for ObservationLayout {
    const KIND: Kind = Kind::Map(Block::names);

    fn value(&self) -> Value {
        let blocks = Block::ALL.iter().map(|block| {
            let repeats = self.repeats(*block);
            let value = if block.is_counted() {
                Value::Count(repeats)
            } else {
                Value::Flag(repeats > 0)
            };
            (block.name(), value)
        });
        blocks.collect()
    }

    /// Blocks that the value does not name keep their default.
    fn from_value(name: &'static str, value: &Value) -> Result<Self> {
        let Value::Map(blocks) = value else {
            return wrong_kind(name, "a dictionary of blocks");
        };
        let mut layout = Self::default();
        for (block, value) in blocks {
            let block: Block = block.parse()?;
            let repeats = if block.is_counted() {
                usize::from_value(block.option(), value)?
            } else {
                usize::from(bool::from_value(block.option(), value)?)
            };
            layout.repeat(block, repeats);
        }
        Ok(layout)
    }
}

/// All entries of the global state of a flock with this number of boats.
pub fn state_entries(boats: usize) -> Vec<Entry> {
    let mut entries: Vec<Entry> = (0..boats).flat_map(|_| BOAT).collect();
    entries.extend(PHASE.iter().chain(&TARGET).chain(&CLOCK));
    entries
}
