//! Neighbor list: pairs of boats that may touch soon. The list has a skin, and is rebuilt when a boat has moved by half
//! of the skin. It follows from the centers and the cutoff of its last build, so a snapshot stores only these.

use super::Vec2;

/// Candidate pairs, in an order that follows the polar angle around the pool: contacts listed in this
/// order give the contact matrix a narrow envelope.
#[derive(Debug, Clone, Default)]
pub(crate) struct NeighborList {
    /// Centers the list was built from; empty before the first build.
    reference: Vec<Vec2>,
    /// Boats sorted by polar angle.
    order: Vec<u32>,
    /// Centers in that order; unused if cells list the pairs.
    ordered: Vec<Vec2>,
    /// Start of each boat's partners in `partners`, by its index in `order`.
    starts: Vec<u32>,
    /// For each boat, the partners that come before it in `order`.
    partners: Vec<u32>,
    /// Center distance within which the list is complete at the reference.
    cutoff: f64,
    /// Number of builds of the list.
    builds: u64,
    grid: Grid,
}

/// Up to this many boats, testing all pairs beats sorting boats into cells.
const ALL_PAIRS: usize = 64;

impl NeighborList {
    /// Centers the list was last built from, for snapshots.
    pub(crate) fn reference(&self) -> &[Vec2] {
        &self.reference
    }

    /// Number of builds of the list.
    pub(crate) fn builds(&self) -> u64 {
        self.builds
    }

    /// Forgets the list, so that the next update rebuilds it.
    pub(crate) fn clear(&mut self) {
        self.reference.clear();
        self.cutoff = 0.0;
    }

    /// Ensures that every pair of centers within `distance` is listed. If the list is rebuilt, its cutoff is `distance`
    /// plus `skin`.
    pub(crate) fn update(
        &mut self,
        centers: impl ExactSizeIterator<Item = Vec2> + Clone,
        distance: f64,
        skin: f64,
    ) {
        let allowed_motion = 0.5 * (self.cutoff - distance);
        let complete = self.reference.len() == centers.len()
            && allowed_motion >= 0.0
            && self.have_moved_at_most(allowed_motion, centers.clone());
        if !complete {
            self.reference.clear();
            self.reference.extend(centers);
            self.build(distance + skin);
        }
    }

    /// Whether every center lies within `distance` of its reference.
    fn have_moved_at_most(&self, distance: f64, centers: impl Iterator<Item = Vec2>) -> bool {
        let pairs = centers.zip(&self.reference);
        // No early exit: nearly always all centers lie within the distance, and a branch for each center is saved.
        pairs.fold(true, |all, (now, then)| {
            all & ((now - then).norm_squared() <= distance * distance)
        })
    }

    /// Rebuilds the list of a snapshot from its reference centers.
    pub(crate) fn restore(&mut self, reference: &[Vec2], cutoff: f64) {
        self.reference.clear();
        self.reference.extend_from_slice(reference);
        if self.reference.is_empty() {
            return;
        }
        self.build(cutoff);
    }

    /// Center distance within which the list is complete at the reference.
    pub(crate) fn cutoff(&self) -> f64 {
        self.cutoff
    }

    /// Boats by polar angle, each with the candidate partners that come before it.
    pub(crate) fn groups(&self) -> impl Iterator<Item = (u32, &[u32])> {
        let ranges = self.starts.windows(2);
        self.order.iter().zip(ranges).map(|(&boat, range)| {
            let range = range[0] as usize..range[1] as usize;
            (boat, &self.partners[range])
        })
    }

    fn build(&mut self, cutoff: f64) {
        self.cutoff = cutoff;
        self.builds += 1;
        self.sort_by_angle();
        self.starts.clear();
        self.partners.clear();
        self.starts.push(0);
        if self.reference.len() <= ALL_PAIRS {
            self.list_all_pairs(cutoff * cutoff);
        } else {
            self.list_from_cells(cutoff);
        }
    }

    fn list_all_pairs(&mut self, squared_cutoff: f64) {
        self.ordered.clear();
        for &boat in &self.order {
            let center = self.reference[boat as usize];
            for (&earlier, other) in self.order.iter().zip(&self.ordered) {
                if (center - other).norm_squared() < squared_cutoff {
                    self.partners.push(earlier);
                }
            }
            self.ordered.push(center);
            self.starts.push(self.partners.len() as u32);
        }
    }

    fn list_from_cells(&mut self, cutoff: f64) {
        let squared_cutoff = cutoff * cutoff;
        self.grid.sort(&self.reference, &self.order, cutoff);
        for index in 0..self.order.len() {
            let center = self.reference[self.order[index] as usize];
            let start = self.partners.len();
            self.grid.for_each_near(center, |other| {
                let other_center = self.reference[self.order[other as usize] as usize];
                let is_near = (center - other_center).norm_squared() < squared_cutoff;
                if (other as usize) < index && is_near {
                    self.partners.push(other);
                }
            });
            // Partners are indices in `order` until they are sorted; then they become boats.
            let group = &mut self.partners[start..];
            group.sort_unstable();
            group
                .iter_mut()
                .for_each(|other| *other = self.order[*other as usize]);
            self.starts.push(self.partners.len() as u32);
        }
    }

    fn sort_by_angle(&mut self) {
        let keys = self.reference.iter().map(polar_key);
        let mut keyed: Vec<(f64, u32)> = keys.zip(0..).collect();
        keyed.sort_unstable_by(|(key, boat), (other_key, other_boat)| {
            key.total_cmp(other_key).then(boat.cmp(other_boat))
        });
        self.order.clear();
        self.order.extend(keyed.iter().map(|&(_, boat)| boat));
    }
}

/// A number in [−2, 2] that grows with the polar angle in (−π, π], and takes less time to compute: the position along the
/// square |x| + |y| = 1.
fn polar_key(center: &Vec2) -> f64 {
    let size = center.x.abs() + center.y.abs();
    if size == 0.0 {
        return 0.0;
    }
    let x = center.x / size;
    if center.y < 0.0 { x - 1.0 } else { 1.0 - x }
}

/// Boats sorted into square cells at least a cutoff wide.
#[derive(Debug, Clone, Default)]
struct Grid {
    /// The corner of the grid at which x and y are smallest.
    low: Vec2,
    /// Side of a cell in cm.
    cell: f64,
    columns: usize,
    rows: usize,
    /// Start of each cell in `indices`.
    starts: Vec<u32>,
    /// Indices into the angular order, cell by cell.
    indices: Vec<u32>,
}

impl Grid {
    /// Sorts boats into cells. Within a cell they keep their order by polar angle, which `order` gives.
    fn sort(&mut self, centers: &[Vec2], order: &[u32], cutoff: f64) {
        let (mut low, mut high) = (centers[0], centers[0]);
        for center in centers {
            low = low.inf(center);
            high = high.sup(center);
        }
        let extent = high - low;
        // In open water boats may drift far apart, so there are at most about four cells per boat.
        let most_cells = 4.0 * centers.len() as f64;
        self.cell = cutoff
            .max((extent.x * extent.y / most_cells).sqrt())
            .max(extent.x.max(extent.y) / most_cells);
        self.low = low;
        self.columns = (extent.x / self.cell) as usize + 1;
        self.rows = (extent.y / self.cell) as usize + 1;

        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        for center in centers {
            let (column, row) = self.cell_of(*center);
            self.starts[row * self.columns + column + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut next = self.starts.clone();
        self.indices.clear();
        self.indices.resize(centers.len(), 0);
        for (index, &boat) in order.iter().enumerate() {
            let (column, row) = self.cell_of(centers[boat as usize]);
            let slot = &mut next[row * self.columns + column];
            self.indices[*slot as usize] = index as u32;
            *slot += 1;
        }
    }

    /// Column and row of the cell that holds a center.
    fn cell_of(&self, center: Vec2) -> (usize, usize) {
        let scaled = (center - self.low) / self.cell;
        (
            (scaled.x as usize).min(self.columns - 1),
            (scaled.y as usize).min(self.rows - 1),
        )
    }

    /// Calls `visit` with the index in the angular order of each boat in a center's cell and in the cells around it.
    fn for_each_near(&self, center: Vec2, mut visit: impl FnMut(u32)) {
        let (column, row) = self.cell_of(center);
        for near_row in row.saturating_sub(1)..=(row + 1).min(self.rows - 1) {
            for near_column in column.saturating_sub(1)..=(column + 1).min(self.columns - 1) {
                let cell = near_row * self.columns + near_column;
                let range = self.starts[cell] as usize..self.starts[cell + 1] as usize;
                self.indices[range].iter().for_each(|&index| visit(index));
            }
        }
    }
}
