//! Obstacles in the water, which do not move.

use super::{Feature, Gap, Hull, HullPose, Vec2, inner_wall_gap, pair_gap, pair_gaps};
use crate::parameters::{Disc, FlockParameters, Wall};

/// An obstacle's shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacle {
    /// A disc.
    Disc {
        /// Its center.
        center: Vec2,
        /// Its radius in cm.
        radius: f64,
    },
    /// A straight wall without thickness.
    Wall {
        /// Its center, and its direction from one end to the other.
        pose: HullPose,
        /// Half its length in cm.
        half_length: f64,
        /// Direction in which another wall leaves from its start, and from its end, if any.
        joints: [Option<Vec2>; 2],
    },
}

/// Two ends of walls nearer to each other than this, in cm, are one point.
const JOINED: f64 = 1e-6;
/// Cosine below which a normal counts as perpendicular to a wall.
const UPRIGHT: f64 = 1e-9;

impl From<&Disc> for Obstacle {
    fn from(disc: &Disc) -> Self {
        Self::Disc {
            center: Vec2::new(disc.x_cm, disc.y_cm),
            radius: disc.radius_cm,
        }
    }
}

impl From<&Wall> for Obstacle {
    fn from(wall: &Wall) -> Self {
        let (start, end) = (
            Vec2::new(wall.x0_cm, wall.y0_cm),
            Vec2::new(wall.x1_cm, wall.y1_cm),
        );
        let half_length = 0.5 * wall.length_cm();
        Self::Wall {
            pose: HullPose {
                center: (start + end) * 0.5,
                axis: (end - start) * (0.5 / half_length),
            },
            half_length,
            joints: [None; 2],
        }
    }
}

impl Obstacle {
    /// The obstacles of checked parameters: discs, then walls, with their joints.
    pub fn all(parameters: &FlockParameters) -> Vec<Self> {
        let discs = parameters.discs.iter().map(Self::from);
        let walls = parameters.walls.iter().map(Self::from);
        let mut all: Vec<Self> = discs.chain(walls).collect();
        join(&mut all);
        all
    }

    /// Whether a boat that moves by more than half its radius in a substep might pass through the obstacle.
    pub(crate) fn is_thin(&self) -> bool {
        matches!(self, Self::Wall { .. })
    }

    /// The two ends of a wall, each with the direction from there into the wall; `None` for a disc.
    fn ends(&self) -> Option<[(Vec2, Vec2); 2]> {
        let Self::Wall {
            pose, half_length, ..
        } = self
        else {
            return None;
        };
        Some([-1.0, 1.0].map(|side| (pose.end(side, *half_length), -pose.axis * side)))
    }

    /// Whether the boat, which is pushed along `normal`, lies past an end of this wall where another wall leads on toward
    /// the boat. Such an end has no contact, since that would brake a boat that slides past.
    fn is_continued(&self, normal: Vec2) -> bool {
        let Self::Wall { pose, joints, .. } = self else {
            return false;
        };
        let beyond = normal.dot(&pose.axis);
        let joint = joints[usize::from(beyond > 0.0)];
        beyond.abs() > UPRIGHT && joint.is_some_and(|next_wall| normal.dot(&next_wall) > UPRIGHT)
    }

    /// The point of the obstacle's core that is nearest to a point, and the radius around the core. A disc's core is
    /// its center.
    fn core(&self, point: Vec2) -> (Vec2, f64) {
        match self {
            Self::Disc { center, radius } => (*center, *radius),
            Self::Wall {
                pose, half_length, ..
            } => {
                let along = (point - pose.center).dot(&pose.axis);
                let along = along.clamp(-half_length, *half_length);
                (pose.center + pose.axis * along, 0.0)
            }
        }
    }

    /// The point of the obstacle's surface that is nearest to a point; for a disc's center, the center itself.
    pub fn nearest(&self, point: Vec2) -> Vec2 {
        let (core, radius) = self.core(point);
        let direction = (point - core).try_normalize(0.0);
        direction.map_or(point, |direction| core + direction * radius)
    }

    /// Distance in cm of the obstacle's surface from a point, negative inside a disc.
    pub fn distance(&self, point: Vec2) -> f64 {
        let (core, radius) = self.core(point);
        (point - core).norm() - radius
    }

    /// Calls `visit` with each contact of a boat's hull whose gap is below `margin`: at most one at a disc, two at a wall.
    pub fn gaps(
        &self,
        boat: &HullPose,
        hull: Hull,
        margin: f64,
        visit: &mut dyn FnMut(Feature, Gap),
    ) {
        match self {
            Self::Disc { .. } => {
                let gap = self.gap(Feature::Flank, boat, hull);
                if gap.gap < margin {
                    visit(Feature::Flank, gap);
                }
            }
            Self::Wall {
                pose, half_length, ..
            } => {
                let wall = (pose, wall_hull(*half_length));
                pair_gaps((boat, hull), wall, margin, |feature, gap| {
                    if feature == Feature::Crossed || !self.is_continued(gap.normal) {
                        visit(feature, wall_gap(feature, gap, hull));
                    }
                });
            }
        }
    }

    /// The gap of the contact at `feature` of the boat's hull, however wide it is.
    pub fn gap(&self, feature: Feature, boat: &HullPose, hull: Hull) -> Gap {
        match self {
            Self::Disc { center, radius } => {
                let boat_from_disc = HullPose {
                    center: boat.center - center,
                    axis: boat.axis,
                };
                inner_wall_gap(&boat_from_disc, hull, *radius)
            }
            Self::Wall {
                pose, half_length, ..
            } => {
                let wall = (pose, wall_hull(*half_length));
                wall_gap(feature, pair_gap(feature, (boat, hull), wall), hull)
            }
        }
    }
}

/// An end of a straight wall.
struct WallEnd {
    position: Vec2,
    /// Unit vector from the end into the wall.
    inward: Vec2,
    /// Index of the wall among the obstacles.
    wall: usize,
    /// 0 for the wall's start, 1 for its end.
    side: usize,
}

/// Links walls that share an end. If more than two walls share it, each is linked to the one that continues it most nearly
/// straight.
fn join(obstacles: &mut [Obstacle]) {
    let mut ends: Vec<WallEnd> = Vec::new();
    for (wall, obstacle) in obstacles.iter().enumerate() {
        let sides = obstacle.ends().into_iter().flatten().enumerate();
        ends.extend(sides.map(|(side, (position, inward))| WallEnd {
            position,
            inward,
            wall,
            side,
        }));
    }
    // Sorted by x, so that only neighbors in the list can be one point.
    ends.sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
    for (k, end) in ends.iter().enumerate() {
        let is_near = |other: &&WallEnd| (other.position.x - end.position.x).abs() <= JOINED;
        let (before, after) = (ends[..k].iter().rev(), ends[k + 1..].iter());
        let near_ends = before.take_while(is_near).chain(after.take_while(is_near));
        let joined_ends = near_ends.filter(|other| {
            (other.position - end.position).norm() <= JOINED && other.wall != end.wall
        });
        let straightest = joined_ends
            .map(|other| other.inward)
            .min_by(|a, b| a.dot(&end.inward).total_cmp(&b.dot(&end.inward)));
        if let Obstacle::Wall { joints, .. } = &mut obstacles[end.wall] {
            joints[end.side] = straightest;
        }
    }
}

/// A wall as a hull of radius 0.
fn wall_hull(half_length: f64) -> Hull {
    Hull {
        radius: 0.0,
        half_length,
    }
}

/// The gap to a straight wall. `gap` is that to a hull of the wall's shape. The wall has no lever arm, since it does not
/// turn. If the wall's end touches the boat's flank, turning the boat either way brings the flank into the wall.
fn wall_gap(feature: Feature, gap: Gap, hull: Hull) -> Gap {
    let is_flank = feature != Feature::Crossed && gap.along.abs() < hull.half_length;
    Gap {
        arm_j: 0.0,
        bend: if is_flank {
            -(gap.gap + hull.radius)
        } else {
            0.0
        },
        ..gap
    }
}
