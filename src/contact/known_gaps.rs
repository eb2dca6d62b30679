//! Gaps of known contacts at other poses of their boats.

use super::touches::{are_swapped, first_of_two};
use super::{Contact, ContactDetector, Partner};
use crate::geometry::{
    EndTouch, Feature, Gap, HullPose, end_touches, inner_wall_gap, outer_wall_gap, pair_gap,
    smaller, smallest_gap,
};

impl ContactDetector {
    /// Whether the two bodies of a contact overlap at other poses by more than `allowed`.
    pub(super) fn overlaps_at(&self, contact: &Contact, boats: &[HullPose], allowed: f64) -> bool {
        let gap = if contact.has_ends() {
            self.smallest_gap_at(contact, boats)
        } else {
            self.gap_at(contact, boats).gap
        };
        gap < -allowed
    }

    /// The smaller of the two gaps between a contact's boat and its partner at other poses, in cm. The partner is a boat or
    /// an obstacle.
    #[inline]
    pub(super) fn smallest_gap_at(&self, contact: &Contact, boats: &[HullPose]) -> f64 {
        let boat = &boats[contact.boat as usize];
        match contact.second() {
            Some(second) => smallest_gap((boat, self.hull), (&boats[second], self.hull)),
            None => {
                let [stern, bow] = self.obstacle_touches(contact, boat);
                smaller(stern.gap, bow.gap)
            }
        }
    }

    /// The two touches between a contact's boat and its partner at other poses: first that at the boat's stern, then that at
    /// its bow. The partner is a boat or an obstacle. If the cores cross, both are at their crossing.
    #[inline]
    pub(super) fn touches_at(&self, contact: &Contact, boats: &[HullPose]) -> [EndTouch; 2] {
        let boat = &boats[contact.boat as usize];
        match contact.second() {
            Some(second) => end_touches((boat, self.hull), (&boats[second], self.hull)),
            None => self.obstacle_touches(contact, boat),
        }
    }

    // Kept out of the loop over boats, so that the gaps of boats stay in registers there.
    #[inline(never)]
    fn obstacle_touches(&self, contact: &Contact, boat: &HullPose) -> [EndTouch; 2] {
        let mut touches = [EndTouch::MISSING; 2];
        if let Partner::Obstacle(number) = contact.partner {
            let (hull, margin) = (self.hull, 2.0 * self.hull.reach());
            let obstacle = &self.obstacles.obstacles[number as usize];
            obstacle.gaps(boat, hull, margin, &mut |feature, gap| {
                store_touch(&mut touches, feature, &gap);
            });
        }
        touches
    }

    /// The gap of a contact at other poses, with the same ends of the two hulls.
    // Inlined, as most callers need only the distance.
    #[inline(always)]
    pub(crate) fn gap_at(&self, contact: &Contact, boats: &[HullPose]) -> Gap {
        let first = &boats[contact.boat as usize];
        match contact.partner {
            Partner::OuterWall => outer_wall_gap(
                first,
                contact.feature.side().unwrap_or(-1.0),
                self.hull,
                self.pool.outer_radius_cm,
            ),
            Partner::InnerWall => inner_wall_gap(first, self.hull, self.pool.inner_radius_cm),
            Partner::Boat(second) => self.pair_gap_at(contact, first, &boats[second as usize]),
            Partner::Obstacle(number) => {
                let obstacle = &self.obstacles.obstacles[number as usize];
                obstacle.gap(contact.feature, first, self.hull)
            }
        }
    }

    /// The gap of contact k at other poses, at the point to which its touch has moved. If two bodies have a single contact,
    /// the touch with the smaller gap counts.
    pub(crate) fn moved_gap(&self, contacts: &[Contact], k: usize, boats: &[HullPose]) -> Gap {
        let contact = &contacts[k];
        if !contact.has_ends() || contact.feature.side().is_none() {
            return self.gap_at(contact, boats);
        }
        let [stern, bow] = self.touches_at(contact, boats);
        let is_bow = match first_of_two(contacts, k) {
            Some(first) => {
                let is_second = k > first;
                is_second != are_swapped(&[stern, bow], &contacts[first..])
            }
            None => bow.gap < stern.gap,
        };
        let feature = Feature::ENDS[usize::from(is_bow)];
        self.gap_at(
            &Contact {
                feature,
                ..*contact
            },
            boats,
        )
    }

    #[inline(never)]
    fn pair_gap_at(&self, contact: &Contact, first: &HullPose, second: &HullPose) -> Gap {
        pair_gap(contact.feature, (first, self.hull), (second, self.hull))
    }
}

/// Stores a touch at the index of the boat's end; a touch at neither end counts for both.
#[inline]
fn store_touch(touches: &mut [EndTouch; 2], feature: Feature, gap: &Gap) {
    match feature {
        Feature::Stern => touches[0] = gap.into(),
        Feature::Bow => touches[1] = gap.into(),
        Feature::Crossed | Feature::Flank => *touches = [gap.into(); 2],
    }
}
