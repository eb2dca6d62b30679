//! Finds the contacts of a flock: candidate pairs from the neighbor list, walls, obstacles, exact gaps.

use super::near_obstacles::NearObstacles;
use super::{Contact, Partner};
use crate::geometry::{
    Feature, Hull, HullPose, NeighborList, Obstacle, Vec2, Velocity, inner_wall_gap,
    outer_wall_gap, pair_gaps,
};
use crate::parameters::{FlockParameters, Pool};
use std::ops::RangeInclusive;

/// Skipping open contacts saves work in a substep in which the fastest boat moves by more than this fraction of a radius.
const LONG: f64 = 0.1;
/// Largest number of pairs per boat in a substep in which boats move by more than half their length. It covers all boats
/// within a few lengths in the densest flock. With more pairs, linearized gaps are meaningless, and memory and time grow
/// with the square of the number of boats.
const MOST_PAIRS_A_BOAT: usize = 32;
/// A substep in which boats reach too many others is cut, but not below this fraction of `dt_s`.
const SHORTEST_SHARE: f64 = 1e-3;

/// Geometry of a flock: hulls, walls, obstacles and the neighbor list.
#[derive(Debug, Clone)]
pub struct ContactDetector {
    pub(super) hull: Hull,
    pub(super) pool: Pool,
    /// Candidate pairs.
    pub(crate) neighbors: NeighborList,
    pub(super) obstacles: NearObstacles,
    skin: f64,
    /// A substep in which boats reach too many others is cut, but not below this length in s.
    shortest_s: f64,
    /// Whether detection stopped because boats reach too many others in this substep.
    is_crowded: bool,
    /// Reach of each boat in cm. Two bodies may touch if their gap is smaller than the sum of their reaches.
    reaches: Vec<f64>,
    /// Distance that the fastest boat moves in this substep, in cm.
    pub(super) farthest: f64,
}

impl ContactDetector {
    /// A detector for checked parameters.
    pub fn new(parameters: &FlockParameters) -> Self {
        let hull = Hull::new(parameters);
        // The list lasts until boats have drifted by about a radius, and for at least a few long substeps.
        let some_substeps = 6.0 * parameters.speed_cm_s * parameters.dt_s;
        let skin = some_substeps.clamp(0.8 * hull.radius, 2.0 * hull.radius);
        Self {
            hull,
            pool: parameters.pool,
            neighbors: NeighborList::default(),
            obstacles: NearObstacles::new(Obstacle::all(parameters)),
            skin,
            shortest_s: SHORTEST_SHARE * parameters.dt_s,
            is_crowded: false,
            reaches: Vec::new(),
            farthest: 0.0,
        }
    }

    /// Sets the length in s of an uncut substep. How far a crowded substep may be cut depends on it.
    pub(crate) fn set_whole_substep(&mut self, dt_s: f64) {
        self.shortest_s = SHORTEST_SHARE * dt_s;
    }

    /// The hull that all boats share.
    pub fn hull(&self) -> Hull {
        self.hull
    }

    /// The largest speed of a hull at these velocities, in cm/s.
    #[inline]
    fn fastest(&self, velocities: &[Velocity]) -> f64 {
        let mut fastest = 0.0;
        for velocity in velocities {
            let speed = self.hull.speed(velocity);
            if speed > fastest {
                fastest = speed;
            }
        }
        fastest
    }

    /// Fills `contacts` with everything that boats with these velocities can reach within `dt`, even if contacts speed
    /// up each boat by half the speed of the fastest one. Returns a margin in cm that exceeds all their gaps. If boats
    /// reach too many others, `contacts` stays empty, and `moves_too_far` is true.
    pub fn detect_moving(
        &mut self,
        boats: &[HullPose],
        velocities: &[Velocity],
        dt: f64,
        contacts: &mut Vec<Contact>,
    ) -> f64 {
        let hull = self.hull;
        // `reaches` first holds speeds in cm/s; the loop below turns them into reaches in cm.
        self.reaches.clear();
        self.reaches
            .extend(velocities.iter().map(|velocity| hull.speed(velocity)));
        let mut fastest = 0.0;
        for &speed in &self.reaches {
            if speed > fastest {
                fastest = speed;
            }
        }
        self.farthest = fastest * dt;
        let added = 0.5 * (self.farthest + 1e-3 * self.hull.radius);
        self.reaches
            .iter_mut()
            .for_each(|reach| *reach = *reach * dt + added);
        let margin = self.margin();
        let may_crowd = boats.len() > 2 * MOST_PAIRS_A_BOAT && dt > self.shortest_s;
        self.is_crowded =
            may_crowd && fastest * dt > self.hull.reach() && self.reach_too_many(boats, margin);
        if self.is_crowded {
            contacts.clear();
        } else {
            self.detect_within_reach(boats, margin, contacts);
        }
        margin
    }

    /// Whether boats move so far in this substep that skipping contacts saves work.
    pub(super) fn does_skipping_save_work(&self) -> bool {
        self.farthest > LONG * self.hull.radius
    }

    /// Whether the neighbor list for `margin` has too many pairs of boats. A list with far too large a cutoff, left by a
    /// longer substep, is rebuilt first.
    #[cold]
    fn reach_too_many(&mut self, boats: &[HullPose], margin: f64) -> bool {
        if self.neighbors.cutoff() > 2.0 * (2.0 * self.hull.reach() + margin + self.skin) {
            self.neighbors.clear();
        }
        self.update(boats, margin);
        let pairs: usize = self
            .neighbors
            .groups()
            .map(|(_, partners)| partners.len())
            .sum();
        pairs > MOST_PAIRS_A_BOAT * boats.len()
    }

    /// Fills `contacts` with all pairs of boats nearer than `margin`, and with walls and obstacles nearer than half of
    /// it, since these do not move. The contacts are ordered along the pool's polar angle.
    pub fn detect(&mut self, boats: &[HullPose], margin: f64, contacts: &mut Vec<Contact>) {
        self.reaches.clear();
        self.reaches.resize(boats.len(), 0.5 * margin);
        self.detect_within_reach(boats, margin, contacts);
    }

    /// As [`Self::detect`], but each boat has its own reach from `self.reaches`, at most half the margin.
    fn detect_within_reach(
        &mut self,
        boats: &[HullPose],
        margin: f64,
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        self.update(boats, margin);
        self.detect_listed(boats, margin, contacts);
    }

    /// Adds the contacts within reach: with walls, obstacles, and the boats in the neighbor list.
    fn detect_listed(&self, boats: &[HullPose], margin: f64, contacts: &mut Vec<Contact>) {
        // A boat's reach is at most half the margin; the wall does not move.
        let open_water = self.open_water(0.5 * margin);
        let has_obstacles = !self.obstacles.obstacles.is_empty();
        // Slices of one length, so that one bounds check covers both.
        let reaches = &self.reaches[..boats.len()];
        for (boat, partners) in self.neighbors.groups() {
            let (pose, reach) = (&boats[boat as usize], reaches[boat as usize]);
            if !open_water.contains(&pose.center.norm_squared()) {
                self.detect_walls(boat, pose, reach, contacts);
            }
            if has_obstacles {
                self.detect_obstacles(boat, pose, reach, contacts);
            }
            for &partner in partners {
                let (first, second) = (boat.min(partner), boat.max(partner));
                let (a, b) = (&boats[first as usize], &boats[second as usize]);
                let pair_reach = reach + reaches[partner as usize];
                pair_gaps(
                    (a, self.hull),
                    (b, self.hull),
                    pair_reach,
                    |feature, gap| {
                        contacts.push(Contact::new(first, Partner::Boat(second), feature, gap));
                    },
                );
            }
        }
    }

    /// Updates the neighbor list so that it holds all pairs of boats nearer than `margin`, and the lists of obstacles.
    pub(super) fn update(&mut self, boats: &[HullPose], margin: f64) {
        let distance = 2.0 * self.hull.reach() + margin;
        self.neighbors
            .update(boats.iter().map(|boat| boat.center), distance, self.skin);
        self.obstacles.update(&self.neighbors);
    }

    /// Whether boats move too far for one substep of `dt` at these velocities: they reach too many others, or might
    /// pass through a wall without thickness. A boat that moves by at most half its radius cannot pass through. After a boat
    /// has passed through, no gap shows from which side it came.
    pub(crate) fn moves_too_far(&self, velocities: &[Velocity], dt: f64) -> bool {
        let farthest = 0.5 * self.hull.radius;
        self.is_crowded || self.obstacles.has_walls && self.fastest(velocities) * dt > farthest
    }

    /// Whether a boat moves farther than its reach. Then it may meet a body with which no contact was detected.
    pub(super) fn is_outrun(&self, displacements: &[f64]) -> bool {
        let mut pairs = displacements.iter().zip(&self.reaches);
        pairs.any(|(displacement, reach)| displacement > reach)
    }

    /// Whether any bodies in the neighbor list overlap by more than `allowed` at the poses in `boats`, even if no contact
    /// between them was detected. Also true if a boat's displacement is so large that the list may lack a body that it
    /// meets.
    #[cold]
    pub(super) fn may_overlap_undetected(
        &mut self,
        boats: &[HullPose],
        displacements: &[f64],
        allowed: f64,
    ) -> bool {
        let listed_displacement = 0.5 * self.margin();
        let mut contacts = Vec::new();
        self.reaches.fill(0.0);
        self.detect_listed(boats, 0.0, &mut contacts);
        contacts.iter().any(|contact| contact.gap.gap < -allowed)
            || displacements
                .iter()
                .any(|&displacement| displacement > listed_displacement)
    }

    /// Distance in cm up to which two boats are listed as neighbors: the largest possible sum of their reaches.
    fn margin(&self) -> f64 {
        3.0 * self.farthest + 1e-3 * self.hull.radius
    }

    /// Squared distances of a hull's center from the pool's center, in cm², at which the hull is farther than `margin`
    /// from both walls. The range is empty if no center is so far from both.
    fn open_water(&self, margin: f64) -> RangeInclusive<f64> {
        let square = |distance: f64| distance.max(0.0) * distance;
        let reach = self.hull.reach() + margin;
        let low = if self.pool.has_inner_wall() {
            square(self.pool.inner_radius_cm + reach)
        } else {
            0.0
        };
        let high = self.pool.outer_radius_cm - reach;
        // A hull for which the pool is too small is never in open water.
        low..=if high < 0.0 { -1.0 } else { square(high) }
    }

    /// Whether a boat's center is between the pool's walls, and outside all obstacles that the list has near the boat.
    pub(crate) fn is_in_water(&self, boat: u32, center: Vec2) -> bool {
        let Pool {
            inner_radius_cm: inner,
            outer_radius_cm: outer,
        } = self.pool;
        let distance_squared = center.norm_squared();
        if !(inner * inner..=outer * outer).contains(&distance_squared) {
            return false;
        }
        let obstacles = &self.obstacles;
        let near_obstacles = obstacles.near_boat(boat).iter();
        near_obstacles
            .map(|&number| &obstacles.obstacles[number as usize])
            .all(|obstacle| obstacle.distance(center) >= 0.0)
    }

    fn detect_walls(&self, boat: u32, pose: &HullPose, margin: f64, contacts: &mut Vec<Contact>) {
        let (outer, inner) = (self.pool.outer_radius_cm, self.pool.inner_radius_cm);
        let distance = pose.center.norm_squared().sqrt();
        if distance + self.hull.reach() + margin > outer {
            let ends = if self.hull.half_length > 0.0 { 2 } else { 1 };
            // An end nearer to the pool's center than this has a gap above the margin.
            let open_radius = (outer - self.hull.radius - margin).max(0.0);
            for (feature, side) in Feature::ENDS.into_iter().zip([-1.0, 1.0]).take(ends) {
                let end = pose.end(side, self.hull.half_length);
                if end.norm_squared() < open_radius * open_radius {
                    continue;
                }
                let gap = outer_wall_gap(pose, side, self.hull, outer);
                if gap.gap < margin {
                    contacts.push(Contact::new(boat, Partner::OuterWall, feature, gap));
                }
            }
        }
        if self.pool.has_inner_wall() && distance - self.hull.reach() - margin < inner {
            let gap = inner_wall_gap(pose, self.hull, inner);
            if gap.gap < margin {
                let feature = Feature::Flank;
                contacts.push(Contact::new(boat, Partner::InnerWall, feature, gap));
            }
        }
    }

    #[inline(never)]
    fn detect_obstacles(
        &self,
        boat: u32,
        pose: &HullPose,
        margin: f64,
        contacts: &mut Vec<Contact>,
    ) {
        for &number in self.obstacles.near_boat(boat) {
            let obstacle = &self.obstacles.obstacles[number as usize];
            obstacle.gaps(pose, self.hull, margin, &mut |feature, gap| {
                contacts.push(Contact::new(boat, Partner::Obstacle(number), feature, gap));
            });
        }
    }
}
