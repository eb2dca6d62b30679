//! Identity of touches: two bodies may touch at two points, and a contact describes one of them.
//!
//! A touch is identified by its position along both cores. That it is at the stern or at the bow identifies it at one pose
//! only: without moving, a touch passes from one to the other when an end slides past the other hull's end, or when two
//! hulls turn past a right angle.

use super::Contact;
use crate::geometry::{EndTouch, Gap};

/// Position of a touch: its coordinates along both cores in cm.
pub(super) type TouchPosition = [f64; 2];

/// Position of a gap's touch.
#[inline]
pub(super) fn position(gap: &Gap) -> TouchPosition {
    [gap.along, gap.along_j]
}

/// Distance of two touches along both cores, in cm.
#[inline]
pub(super) fn distance(a: TouchPosition, b: TouchPosition) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).abs()
}

/// Index of the first of the two contacts between the bodies of contact k; `None` if contact k is their only one.
#[inline]
pub(super) fn first_of_two(contacts: &[Contact], k: usize) -> Option<usize> {
    let is_twin = |other: Option<&Contact>| other.is_some_and(|other| contacts[k].is_twin(other));
    let previous = k.checked_sub(1).and_then(|index| contacts.get(index));
    if is_twin(previous) {
        Some(k - 1)
    } else {
        is_twin(contacts.get(k + 1)).then_some(k)
    }
}

/// Index of the other contact between the bodies of contact k, if there is one.
#[inline]
pub(super) fn twin(contacts: &[Contact], k: usize) -> Option<usize> {
    first_of_two(contacts, k).map(|first| 2 * first + 1 - k)
}

/// Whether the touches of two bodies at other poses belong to their two contacts, the first two of `contacts`, in reverse
/// order. The order with the smaller change of positions and gaps counts. A missing touch has no position, so the other
/// one goes to the nearer contact.
#[inline]
pub(super) fn are_swapped(touches: &[EndTouch; 2], contacts: &[Contact]) -> bool {
    let change = |touch: usize, contact: usize| {
        let EndTouch { gap, along } = touches[touch];
        if gap == f64::INFINITY {
            return 0.0;
        }
        let before = &contacts[contact].gap;
        distance(along, position(before)) + (gap - before.gap).abs()
    };
    change(1, 0) + change(0, 1) < change(0, 0) + change(1, 1)
}
