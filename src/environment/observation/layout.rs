//! The entries that a leader observes, in order.

use super::blocks::{Block, PHASE, TARGET};
use super::entry::{BOAT, CLOCK, Entry};
use crate::error::{FlockError, Result};
use crate::parameters::{Kind, Setting, Value, wrong_kind};

/// Version of the observation: of the entries, their order, scales and bounds. A policy runs only with the version in
/// its file.
pub const OBSERVATION_VERSION: u32 = 1;

/// The most neighbors, and the most obstacles, that a leader may observe.
pub(crate) const MOST_NEIGHBORS: usize = 64;

/// Blocks that are on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ObservationLayout {
    #[serde(with = "stored_repeats")]
    repeats: [usize; Block::COUNT],
    /// Whether observation and action are reflected if the target is counter-clockwise, so that both directions are the
    /// clockwise task.
    pub is_mirrored: bool,
}

/// The stored form of blocks, by name; missing ones occur as often as by default.
mod stored_repeats {
    use super::Block;
    use crate::by_name;

    pub(super) fn serialize<S: serde::Serializer>(
        repeats: &[usize; Block::COUNT],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let names = Block::ALL.iter().map(|block| block.name());
        by_name::write(names.zip(*repeats), to)
    }

    pub(super) fn deserialize<'de, D: serde::Deserializer<'de>>(
        from: D,
    ) -> Result<[usize; Block::COUNT], D::Error> {
        let mut repeats = Block::DEFAULT;
        by_name::read(from, "the blocks of an observation", |name, count| {
            let block = name.parse::<Block>();
            block.map(|block| repeats[block as usize] = count).is_ok()
        })?;
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
    /// A layout of these blocks alone, each once.
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
    /// [`FlockError::Parameter`] if nothing is observed, or too many neighbors or obstacles.
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

    /// Sets the occurrences of a block: 0 or 1, or the number of neighbors or obstacles.
    pub fn repeat(&mut self, block: Block, repeats: usize) {
        self.repeats[block as usize] = if block.is_counted() {
            repeats
        } else {
            repeats.min(1)
        };
    }

    /// Index of a block's first entry, if it is on.
    pub fn offset(&self, wanted: Block) -> Option<usize> {
        let before = Block::ALL.iter().take(wanted as usize);
        let sizes = before.map(|&block| self.repeats(block) * block.entries().len());
        self.has(wanted).then(|| sizes.sum())
    }

    /// Index of a block's entry, if the block is on; the first neighbor's for `Neighbors`.
    pub fn index(&self, block: Block, name: &str) -> Option<usize> {
        let mut entries = block.entries().iter();
        let index = entries.position(|entry| entry.name == name)?;
        self.offset(block).map(|offset| offset + index)
    }

    /// Size of the observation of one leader.
    pub fn size(&self) -> usize {
        let blocks = Block::ALL.iter();
        blocks
            .map(|&block| self.repeats(block) * block.entries().len())
            .sum()
    }

    /// All entries in order, with their block and its count from 0.
    pub fn entries(&self) -> Vec<(Block, usize, Entry)> {
        Block::ALL
            .iter()
            .flat_map(|&block| (0..self.repeats(block)).map(move |count| (block, count)))
            .flat_map(|(block, count)| {
                let entries = block.entries().iter();
                entries.map(move |entry| (block, count, *entry))
            })
            .collect()
    }
}

impl Setting for ObservationLayout {
    const KIND: Kind = Kind::Map(Block::names);

    fn value(&self) -> Value {
        let blocks = Block::ALL.iter().map(|block| {
            let repeats = self.repeats(*block);
            let shown = if block.is_counted() {
                Value::Count(repeats)
            } else {
                Value::Flag(repeats > 0)
            };
            (block.name(), shown)
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

/// All entries of the global state of a number of boats.
pub fn state_entries(boats: usize) -> Vec<Entry> {
    let mut entries: Vec<Entry> = (0..boats).flat_map(|_| BOAT).collect();
    entries.extend(PHASE.iter().chain(&TARGET).chain(&CLOCK));
    entries
}
