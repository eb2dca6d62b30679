//! Random initial conditions: hulls without overlap, with uniform headings (the random start of Section 2.5).
//!
//! Dilute flocks are placed by rejection: uniform positions and headings, one boat after another. If that fails, hulls
//! start small at uniform positions, grow, and are pushed apart by the least displacement. Their headings stay random,
//! but pushing turns them a little.

use crate::contact::{ContactDetector, KeepGoing, push_apart};
use crate::error::{FlockError, Result};
use crate::geometry::{
    Hull, HullPose, Obstacle, Pose, Vec2, inner_wall_gap, outer_wall_gap, pair_gaps,
};
use crate::parameters::{FlockParameters, Pool};
use crate::random::{Stream, StreamRng};
use rand::RngExt;
use std::f64::consts::{PI, TAU};

/// Number of draws for each boat after which rejection fails.
const TRIES_PER_BOAT: usize = 200;
/// Number of attempts to grow hulls before placement fails.
const ATTEMPTS: usize = 6;
/// Fraction of the water that hulls may cover. If they would cover more, placement fails.
const LARGEST_COVER: f64 = 0.92;
/// Fraction of the water that randomly placed hulls can cover without overlap.
const REACHABLE_COVER: f64 = 0.78;
/// Sizes at which growing hulls are pushed apart, as fractions of the full size.
const GROWTH: [f64; 8] = [0.5, 0.65, 0.78, 0.87, 0.93, 0.97, 0.99, 1.0];
/// The most passes that push hulls of one size apart.
const PASSES_PER_SIZE: u32 = 60;
/// Distance kept between placed hulls, as a fraction of the boat's radius.
const CLEARANCE: f64 = 1e-3;
/// Area of open water for the centers per boat, in hull areas: as dilute as 20 boats in the pool `wide`.
const OPEN_WATER_AREAS: f64 = 25.0;
/// Number of bisections between an outer radius of open water that suffices and one that does not.
const HALVINGS: u32 = 10;
/// Number of points that sample the area of obstacles, to about a percent.
const SURVEY_POINTS: u32 = 1024;

/// Places all boats of checked parameters.
///
/// # Errors
/// [`FlockError::Placement`] if no placement without overlap was found, [`FlockError::Interrupted`]
/// if `keep_going` returned false.
pub(super) fn place(
    parameters: &FlockParameters,
    seed: u64,
    keep_going: KeepGoing,
) -> Result<Vec<Pose>> {
    let mut rng = Stream::PLACEMENT.rng(seed);
    let region = Region::new(parameters);
    // No hull fits between the walls.
    if region.outer <= region.inner {
        return Err(FlockError::Placement {
            requested: parameters.n_boats,
            placed: 0,
        });
    }
    if let Some(poses) = place_by_rejection(parameters.n_boats, &region, &mut rng, keep_going) {
        return Ok(poses);
    }
    let (boats, attempts) = region.growth_plan(parameters.n_boats);
    let mut most_placed = 0;
    for _ in 0..attempts {
        let poses = place_by_growth(parameters, boats, &region, &mut rng, keep_going);
        if !keep_going() {
            return Err(FlockError::Interrupted);
        }
        let placed = region.count_disjoint(&poses);
        if placed == parameters.n_boats {
            return Ok(poses);
        }
        most_placed = most_placed.max(placed);
    }
    Err(FlockError::Placement {
        requested: parameters.n_boats,
        placed: most_placed,
    })
}

/// The water that boats are placed in.
struct Region {
    hull: Hull,
    pool: Pool,
    obstacles: Vec<Obstacle>,
    /// Radii in cm between which centers are drawn.
    inner: f64,
    outer: f64,
    /// Area of the water in cm², without obstacles.
    area: f64,
    /// Number of draws for each boat after which rejection fails.
    tries: usize,
}

impl Region {
    /// Number of boats to grow, and number of attempts. Hulls that cover nearly all of the water must overlap. Then a
    /// single attempt with fewer boats counts those without overlap, for the error message.
    fn growth_plan(&self, boats: usize) -> (usize, usize) {
        let full_count = self.area / self.hull.area();
        if boats as f64 <= LARGEST_COVER * full_count {
            (boats, ATTEMPTS)
        } else {
            ((REACHABLE_COVER * full_count) as usize, 1)
        }
    }

    fn new(parameters: &FlockParameters) -> Self {
        let hull = Hull::new(parameters);
        let pool = parameters.pool;
        let inner = if pool.has_inner_wall() {
            pool.inner_radius_cm + hull.radius
        } else {
            0.0
        };
        let mut region = Self {
            hull,
            pool,
            obstacles: Obstacle::all(parameters),
            inner,
            outer: pool.outer_radius_cm - hull.radius,
            area: 0.0,
            tries: TRIES_PER_BOAT,
        };
        if !pool.has_outer_wall() {
            region.enclose(OPEN_WATER_AREAS * hull.area() * parameters.n_boats as f64);
        }
        region.area = region.free_area();
        region
    }

    /// In open water, makes the region the smallest disc whose area without obstacles is at least `area` (cm²).
    fn enclose(&mut self, area: f64) {
        let inner_square = self.inner * self.inner;
        let share = |outer: f64| self.free_share(inner_square, outer * outer, self.hull.radius);
        // The factor allows for rounding, and for the spacing of the survey's points.
        let suffices =
            |outer: f64| share(outer) * PI * (outer * outer - inner_square) >= 0.999 * area;
        let least = (area / PI + inner_square).sqrt();
        let (mut low, mut high) = (least, least);
        while !suffices(high) {
            (low, high) = (high, 2.0 * high);
        }
        // If the least radius suffices, there is nothing to bisect.
        let halvings = if low < high { HALVINGS } else { 0 };
        for _ in 0..halvings {
            let middle = 0.5 * (low + high);
            if suffices(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        // Draws that hit an obstacle do not count.
        let tries = TRIES_PER_BOAT as f64 / share(high);
        (self.outer, self.tries) = (high, tries.ceil() as usize);
    }

    /// Area in cm² that hulls can cover. A hull reaches its radius further than its center may lie.
    fn free_area(&self) -> f64 {
        let inner = (self.inner - self.hull.radius).max(0.0);
        let outer = self.outer + self.hull.radius;
        let (inner_square, outer_square) = (inner * inner, outer * outer);
        PI * (outer_square - inner_square) * self.free_share(inner_square, outer_square, 0.0)
    }

    /// Fraction of the water between two squared radii that is at least `clearance` from every obstacle. It is sampled
    /// at points along a spiral.
    fn free_share(&self, inner_square: f64, outer_square: f64, clearance: f64) -> f64 {
        if self.obstacles.is_empty() {
            return 1.0;
        }
        // The golden angle spreads the points evenly: each turn of the spiral lies between earlier turns.
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let free = (0..SURVEY_POINTS).filter(|&index| {
            let fraction = (f64::from(index) + 0.5) / f64::from(SURVEY_POINTS);
            let (sin, cos) = libm::sincos(golden * f64::from(index));
            let radius = (inner_square + fraction * (outer_square - inner_square)).sqrt();
            let point = Vec2::new(cos, sin) * radius;
            self.is_open(point, clearance)
        });
        free.count() as f64 / f64::from(SURVEY_POINTS)
    }

    /// Whether a point is at least `clearance` from every obstacle.
    fn is_open(&self, point: Vec2, clearance: f64) -> bool {
        let mut obstacles = self.obstacles.iter();
        obstacles.all(|obstacle| obstacle.distance(point) >= clearance)
    }

    /// Draws a uniform position and a uniform heading.
    fn draw(&self, rng: &mut StreamRng) -> Pose {
        let square = rng.random_range(self.inner * self.inner..=self.outer * self.outer);
        let (radius, angle) = (square.sqrt(), rng.random_range(-PI..PI));
        Pose::new(
            radius * libm::cos(angle),
            radius * libm::sin(angle),
            rng.random_range(-PI..PI),
        )
    }

    /// Whether all gaps between a boat and the walls and obstacles are larger than `clearance`.
    fn is_inside(&self, boat: &HullPose, clearance: f64) -> bool {
        let (outer, inner) = (self.pool.outer_radius_cm, self.pool.inner_radius_cm);
        let is_end_clear = |side| outer_wall_gap(boat, side, self.hull, outer).gap > clearance;
        if self.pool.has_outer_wall() && ![-1.0, 1.0].into_iter().all(is_end_clear) {
            return false;
        }
        let is_clear_of_inner = || inner_wall_gap(boat, self.hull, inner).gap > clearance;
        if self.pool.has_inner_wall() && !is_clear_of_inner() {
            return false;
        }
        self.obstacles.iter().all(|obstacle| {
            let mut is_clear = true;
            let mut note_small_gap = |_, _| is_clear = false;
            obstacle.gaps(boat, self.hull, clearance, &mut note_small_gap);
            is_clear
        })
    }

    /// Whether all gaps between a boat and the walls, obstacles and other boats are larger than `clearance`.
    fn is_clear(&self, boat: &HullPose, others: &[HullPose], clearance: f64) -> bool {
        self.is_inside(boat, clearance)
            && others.iter().all(|other| {
                let mut is_clear = true;
                let (first, second) = ((boat, self.hull), (other, self.hull));
                let note_small_gap = |_, _| is_clear = false;
                pair_gaps(first, second, clearance, note_small_gap);
                is_clear
            })
    }

    /// Number of boats that can be placed in turn without overlapping those already placed.
    fn count_disjoint(&self, poses: &[Pose]) -> usize {
        let mut placed: Vec<HullPose> = Vec::with_capacity(poses.len());
        for pose in poses {
            let boat = HullPose::new(pose);
            if self.is_clear(&boat, &placed, 0.0) {
                placed.push(boat);
            }
        }
        placed.len()
    }
}

/// Adds boats one by one at random; `None` if that stalls, would be slow, or is stopped.
fn place_by_rejection(
    boats: usize,
    region: &Region,
    rng: &mut StreamRng,
    keep_going: KeepGoing,
) -> Option<Vec<Pose>> {
    // Adding hulls at random stalls if they cover nearly half of the area. In very large flocks, comparing each boat with
    // all others would be slow, and growth succeeds.
    if boats as f64 * region.hull.area() > 0.4 * region.area || boats > 4000 {
        return None;
    }
    let clearance = CLEARANCE * region.hull.radius;
    let (mut poses, mut placed) = (Vec::new(), Vec::new());
    while poses.len() < boats && keep_going() {
        let (pose, boat) = (0..region.tries).find_map(|_| {
            let pose = region.draw(rng);
            let boat = HullPose::new(&pose);
            let is_clear = region.is_clear(&boat, &placed, clearance);
            is_clear.then_some((pose, boat))
        })?;
        poses.push(pose);
        placed.push(boat);
    }
    (poses.len() == boats).then_some(poses)
}

/// Lets small hulls grow and pushes them apart. Hulls may still overlap at the end.
fn place_by_growth(
    parameters: &FlockParameters,
    boats: usize,
    region: &Region,
    rng: &mut StreamRng,
    keep_going: KeepGoing,
) -> Vec<Pose> {
    let mut draw_start = || loop {
        let pose = region.draw(rng);
        // A hull that starts deep inside an obstacle of open water would have to move far.
        if region.pool.has_outer_wall() || region.is_open(pose.position, region.hull.radius) {
            return pose;
        }
    };
    let mut poses: Vec<Pose> = (0..boats).map(|_| draw_start()).collect();
    for size in GROWTH {
        // The last size is a little more than the hull's, so that gaps stay open.
        let boat_radius_cm = parameters.boat_radius_cm * size * (1.0 + CLEARANCE);
        let grown = FlockParameters {
            boat_radius_cm,
            ..parameters.clone()
        };
        let mut detector = ContactDetector::new(&grown);
        push_apart(
            &mut detector,
            &mut poses,
            parameters,
            PASSES_PER_SIZE,
            keep_going,
        );
    }
    for pose in &mut poses {
        pose.heading = pose.heading.rem_euclid(TAU);
        if pose.heading > PI {
            pose.heading -= TAU;
        }
    }
    poses
}
