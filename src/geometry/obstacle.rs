//! Obstacles in the water, which do not move.

use super::{Feature, Gap, Hull, HullPose, Vec2, inner_wall_gap, pair_gap, pair_gaps};
use crate::parameters::{Disc, FlockParameters, Wall};

/// What stands in the water.
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
    },
}

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
        }
    }
}

impl Obstacle {
    /// The obstacles of checked parameters: discs, then walls.
    pub fn all(parameters: &FlockParameters) -> Vec<Self> {
        let discs = parameters.discs.iter().map(Self::from);
        let walls = parameters.walls.iter().map(Self::from);
        discs.chain(walls).collect()
    }

    /// The point of its core, which a disc has at its center, that is nearest to a place, and its radius about that.
    fn core(&self, place: Vec2) -> (Vec2, f64) {
        match self {
            Self::Disc { center, radius } => (*center, *radius),
            Self::Wall { pose, half_length } => {
                let along = (place - pose.center).dot(&pose.axis);
                let along = along.clamp(-half_length, *half_length);
                (pose.center + pose.axis * along, 0.0)
            }
        }
    }

    /// The point of its surface that is nearest to a place; the place itself at a disc's very center.
    pub fn nearest(&self, place: Vec2) -> Vec2 {
        let (core, radius) = self.core(place);
        let away = (place - core).try_normalize(0.0);
        away.map_or(place, |away| core + away * radius)
    }

    /// Distance of its surface from a place in cm, negative inside a disc.
    pub fn distance(&self, place: Vec2) -> f64 {
        let (core, radius) = self.core(place);
        (place - core).norm() - radius
    }

    /// The contacts of a boat's hull with a gap below `margin`: none, one or, along a wall, two.
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
            Self::Wall { pose, half_length } => pair_gaps(
                (boat, hull),
                (pose, wall_hull(*half_length)),
                margin,
                |feature, gap| found(feature, beside_wall(feature, gap, hull)),
            ),
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
            Self::Wall { pose, half_length } => {
                let wall = (pose, wall_hull(*half_length));
                beside_wall(feature, pair_gap(feature, (boat, hull), wall), hull)
            }
        }
    }
}

/// A wall is a hull of no radius.
fn wall_hull(half_length: f64) -> Hull {
    Hull {
        radius: 0.0,
        half_length,
    }
}

/// The gap to a wall, which has no lever arm. Where a wall's end touches the flank, turning the boat either way brings
/// the flank into it, as at a disc.
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
