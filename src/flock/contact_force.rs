//! The contacts of a flock, with the forces that they carried.

use super::flock::Flock;
use crate::contact::Contact;
use crate::geometry::Vec2;

/// A contact with the force it carried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// The contact, with its gap at the present poses.
    pub contact: Contact,
    /// Point of the hull of `contact.boat` on which the force acts, at the present poses.
    pub point: Vec2,
    /// Mean force on `contact.boat` over the last substep in cm/s² (mass 1), along the contact's normal.
    pub force: f64,
}

impl Flock {
    /// Contacts and near-contacts of the last substep, with their gaps at the present poses and their mean forces. There
    /// are none after a state was set or restored, or an advance failed.
    pub fn contacts(&self) -> Vec<ContactForce> {
        let resolver = &self.integrator.contacts;
        let detector = &resolver.detector;
        let hull = detector.hull();
        resolver
            .contacts
            .iter()
            .zip(&resolver.solver.impulses)
            .enumerate()
            .map(|(index, (contact, &impulse))| {
                let gap = detector.moved_gap(&resolver.contacts, index, &self.integrator.boats);
                let force = if impulse > 0.0 {
                    impulse / self.integrator.step_length_s
                } else {
                    0.0
                };
                let contact = Contact { gap, ..*contact };
                ContactForce {
                    point: contact.point(&self.hulls()[contact.boat as usize], hull),
                    contact,
                    force,
                }
            })
            .collect()
    }
}
