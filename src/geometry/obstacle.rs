//! Obstacles in the water: a disc is a hull of no length, a straight wall a hull of no radius, and neither moves.

use super::gap::capsule_gap;
use super::{Gap, Hull, HullPose, PairFeature, Vec2, capsule_gaps, inner_wall_gap};
use crate::parameters::{Disc, FlockParameters, Wall};

/// A disc or a straight wall that stands in the water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// Where it stands; the axis of a wall points to its end.
    pub pose: HullPose,
    /// Its shape.
    pub shape: Hull,
}

impl From<&Disc> for Obstacle {
    fn from(disc: &Disc) -> Self {
        Self {
            pose: HullPose {
                center: Vec2::new(disc.x_cm, disc.y_cm),
                axis: Vec2::new(1.0, 0.0),
            },
            shape: Hull {
                radius: disc.radius_cm,
                half_length: 0.0,
            },
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
        Self {
            pose: HullPose {
                center: (start + end) * 0.5,
                axis: (end - start) * (0.5 / half_length),
            },
            shape: Hull {
                radius: 0.0,
                half_length,
            },
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

    /// Whether it is a disc.
    #[inline]
    pub fn is_disc(&self) -> bool {
        self.shape.half_length == 0.0
    }

    /// The point of its core that is nearest to a place.
    pub fn nearest_of_core(&self, place: Vec2) -> Vec2 {
        let h = self.shape.half_length;
        let along = (place - self.pose.center).dot(&self.pose.axis);
        self.pose.center + self.pose.axis * along.clamp(-h, h)
    }

    /// The point of its surface that is nearest to a place; the place itself at a disc's very center.
    pub fn nearest(&self, place: Vec2) -> Vec2 {
        let core = self.nearest_of_core(place);
        let away = (place - core).try_normalize(0.0);
        away.map_or(place, |away| core + away * self.shape.radius)
    }

    /// Distance of its surface from a place in cm, negative inside a disc.
    pub fn distance(&self, place: Vec2) -> f64 {
        (place - self.nearest_of_core(place)).norm() - self.shape.radius
    }

    /// A boat as seen from the obstacle's center.
    fn seen(&self, boat: &HullPose) -> HullPose {
        HullPose {
            center: boat.center - self.pose.center,
            axis: boat.axis,
        }
    }

    /// The contacts of a boat's hull with a gap below `margin`: none, one or, along a wall, two.
    pub fn gaps(
        &self,
        boat: &HullPose,
        hull: Hull,
        margin: f64,
        found: &mut dyn FnMut(PairFeature, Gap),
    ) {
        if self.is_disc() {
            let gap = inner_wall_gap(&self.seen(boat), hull, self.shape.radius);
            if gap.gap < margin {
                found(PairFeature::Stern, gap);
            }
            return;
        }
        capsule_gaps(
            (boat, hull),
            (&self.pose, self.shape),
            margin,
            |feature, gap| found(feature, beside_wall(feature, gap, hull)),
        );
    }

    /// The gap of a known contact at another pose of the boat.
    pub fn gap(&self, feature: PairFeature, boat: &HullPose, hull: Hull) -> Gap {
        if self.is_disc() {
            return inner_wall_gap(&self.seen(boat), hull, self.shape.radius);
        }
        let gap = capsule_gap(feature, (boat, hull), (&self.pose, self.shape));
        beside_wall(feature, gap, hull)
    }
}

/// The gap to a wall, which has no lever arm. Where a wall's end touches the flank, turning the boat either way brings
/// the flank into it, as at a disc.
fn beside_wall(feature: PairFeature, gap: Gap, hull: Hull) -> Gap {
    let is_flank = feature != PairFeature::Crossed && gap.along.abs() < hull.half_length;
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
