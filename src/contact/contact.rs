//! One point at which a hull is near another hull or a wall.

use crate::geometry::{Feature, Gap, Hull, HullPose, Vec2, Velocity};

/// The other side of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Partner {
    /// Another boat, always of a larger index.
    Boat(u32),
    /// The outer wall.
    OuterWall,
    /// The inner wall.
    InnerWall,
    /// An obstacle: the discs are numbered first, then the walls.
    Obstacle(u32),
}

/// Two bodies that touch or are near each other, as a constraint on the velocities of one or two boats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The boat that the normal pushes.
    pub boat: u32,
    /// The other side.
    pub partner: Partner,
    /// Part of `boat`'s hull at which the contact is.
    pub feature: Feature,
    /// Gap, normal and lever arms at the pose where the contact was found.
    pub gap: Gap,
}

impl Contact {
    /// A contact of a boat with a partner.
    pub(super) fn new(boat: u32, partner: Partner, feature: Feature, gap: Gap) -> Self {
        Self {
            boat,
            partner,
            feature,
            gap,
        }
    }

    /// Whether both contacts are between the same two bodies.
    #[inline]
    pub(super) fn is_twin(&self, other: &Self) -> bool {
        (self.boat, self.partner) == (other.boat, other.partner)
    }

    /// Index of the other boat, if the partner is a boat.
    #[inline]
    pub fn second(&self) -> Option<usize> {
        match self.partner {
            Partner::Boat(boat) => Some(boat as usize),
            Partner::OuterWall | Partner::InnerWall | Partner::Obstacle(_) => None,
        }
    }

    /// Whether the partner is a boat or an obstacle, and so may have ends. Then a contact may pass from one end of the boat
    /// to the other although the point of contact does not move.
    #[inline]
    pub(super) fn has_ends(&self) -> bool {
        matches!(self.partner, Partner::Boat(_) | Partner::Obstacle(_))
    }

    /// The point of the first hull's surface at which the normal pushes.
    pub fn point(&self, boat: &HullPose, hull: Hull) -> Vec2 {
        let Gap { along, normal, .. } = self.gap;
        boat.center + boat.axis * along - normal * hull.radius
    }

    /// The contact's boats, each with its normal and lever arm.
    #[inline]
    pub fn sides(&self) -> impl Iterator<Item = (u32, Vec2, f64)> {
        let gap = &self.gap;
        let first = (self.boat, gap.normal, gap.arm_i);
        let second = self
            .second()
            .map(|boat| (boat as u32, -gap.normal, -gap.arm_j));
        std::iter::once(first).chain(second)
    }

    /// Rate of change of the gap at given velocities of all boats, in cm/s.
    #[inline]
    pub(crate) fn gap_rate(&self, velocities: &[Velocity]) -> f64 {
        let gap = &self.gap;
        let first = &velocities[self.boat as usize];
        let rate = gap.normal.dot(&first.linear) + gap.arm_i * first.angular;
        match self.second() {
            None => rate,
            Some(second) => {
                let second = &velocities[second];
                rate - gap.normal.dot(&second.linear) - gap.arm_j * second.angular
            }
        }
    }
}
