//! Obstacles that each boat may touch soon. The lists are rebuilt with the neighbor list.

use crate::geometry::{NeighborList, Obstacle};

/// The obstacles of a pool, and for each boat a list of those near it.
#[derive(Debug, Clone, Default)]
pub(super) struct NearObstacles {
    pub(super) obstacles: Vec<Obstacle>,
    /// Whether some obstacles have no thickness.
    pub(super) has_walls: bool,
    /// Start of each boat's obstacles in `near`.
    starts: Vec<u32>,
    /// Indices of obstacles, boat by boat.
    near: Vec<u32>,
    /// The neighbor list's number of builds when these lists were built.
    neighbor_builds: u64,
}

impl NearObstacles {
    /// Lists for these obstacles, empty at first.
    pub(super) fn new(obstacles: Vec<Obstacle>) -> Self {
        Self {
            has_walls: obstacles.iter().any(Obstacle::is_thin),
            obstacles,
            ..Self::default()
        }
    }

    /// Rebuilds the lists if the neighbor list was rebuilt. Two moving boats are listed within its cutoff. An obstacle
    /// does not move, so half the cutoff is enough for it.
    pub(super) fn update(&mut self, neighbors: &NeighborList) {
        if self.obstacles.is_empty() || self.neighbor_builds == neighbors.builds() {
            return;
        }
        self.neighbor_builds = neighbors.builds();
        let reach = 0.5 * neighbors.cutoff();
        self.starts.clear();
        self.near.clear();
        self.starts.push(0);
        for &center in neighbors.reference() {
            let obstacles = self.obstacles.iter().enumerate();
            let near = obstacles.filter(|(_, obstacle)| obstacle.distance(center) <= reach);
            self.near.extend(near.map(|(number, _)| number as u32));
            self.starts.push(self.near.len() as u32);
        }
    }

    /// Indices of the obstacles near a boat.
    pub(super) fn near_boat(&self, boat: u32) -> &[u32] {
        let boat = boat as usize;
        if self.starts.is_empty() {
            return &[];
        }
        &self.near[self.starts[boat] as usize..self.starts[boat + 1] as usize]
    }
}
