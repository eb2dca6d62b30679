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

/// Ends of walls nearer than this, in cm, are one point.
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
    /// the boat.
    /// Such an end has no contact, since that would brake a boat that slides past.
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
        let away = (point - core).try_normalize(0.0);
        away.map_or(point, |away| core + away * radius)
    }

    /// Distance in cm of the obstacle's surface from a point, negative inside a disc.
    pub fn distance(&self, point: Vec2) -> f64 {
        let (core, radius) = self.core(point);
        (point - core).norm() - radius
    }

    /// Calls `found` with each contact of a boat's hull whose gap is below `margin`: at most one at a disc, two at a wall.
    pub fn gaps(
        &self,
        boat: &HullPose,
        hull: Hull,
        margin: f64,
        found: &mut dyn FnMut(Feature, Gap),
    ) {
        match self {
            Self::Disc { .. } => {
                let gap = self.gap(Feature::Flank, boat, hull);
                if gap.gap < margin {
                    found(Feature::Flank, gap);
                }
            }
            Self::Wall {
                pose, half_length, ..
            } => {
                let wall = (pose, wall_hull(*half_length));
                pair_gaps((boat, hull), wall, margin, |feature, gap| {
                    if feature == Feature::Crossed || !self.is_continued(gap.normal) {
                        found(feature, beside_wall(feature, gap, hull));
                    }
                });
            }
        }
    }

    /// The gap of a known contact at another pose of the boat.
    pub fn gap(&self, feature: Feature, boat: &HullPose, hull: Hull) -> Gap {
        match self {
            Self::Disc { center, radius } => {
                let seen = HullPose {
                    center: boat.center - center,
                    axis: boat.axis,
                };
                inner_wall_gap(&seen, hull, *radius)
            }
            Self::Wall {
                pose, half_length, ..
            } => {
                let wall = (pose, wall_hull(*half_length));
                beside_wall(feature, pair_gap(feature, (boat, hull), wall), hull)
            }
        }
    }
}

/// Links walls that share an end. If several walls do, a wall is linked to the one that continues it most nearly
/// straight.
fn join(obstacles: &mut [Obstacle]) {
    let mut ends: Vec<(Vec2, Vec2, usize, usize)> = Vec::new();
    for (number, obstacle) in obstacles.iter().enumerate() {
        let its_ends = obstacle.ends().into_iter().flatten().enumerate();
        ends.extend(its_ends.map(|(side, (end, inward))| (end, inward, number, side)));
    }
    ends.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
    for (k, &(end, inward, number, side)) in ends.iter().enumerate() {
        let near = |other: &&(Vec2, Vec2, usize, usize)| (other.0.x - end.x).abs() <= JOINED;
        let (before, after) = (ends[..k].iter().rev(), ends[k + 1..].iter());
        let others = before.take_while(near).chain(after.take_while(near));
        let others = others.filter(|other| (other.0 - end).norm() <= JOINED && other.2 != number);
        let onward = others
            .map(|other| other.1)
            .min_by(|a, b| a.dot(&inward).total_cmp(&b.dot(&inward)));
        if let Obstacle::Wall { joints, .. } = &mut obstacles[number] {
            joints[side] = onward;
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

/// The gap to a wall, which has no lever arm. If a wall's end touches the flank, turning the boat either way brings the
/// flank into it, as at a disc.
fn beside_wall(feature: Feature, gap: Gap, hull: Hull) -> Gap {
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
