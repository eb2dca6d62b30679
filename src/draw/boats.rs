//! The boats: hulls (segments swept by a disc) with a mark towards the bow.

use super::palette::{Coloring, LEADER, LEADER_MARK, MARK, NORMAL, OPPONENT, OUTLINE, Rgb, tint};
use super::view::View;
use crate::flock::Flock;
use crate::geometry::{Hull, HullPose, turned_left};
use crate::parameters::{Target, Targets};
use tiny_skia::{PathBuilder, Pixmap};

/// Width of outlines as a fraction of the hull's radius, and the least width in pixels.
const EDGE: (f32, f32) = (0.14, 1.0);
/// Width of a leader's ring as a fraction of the hull's radius, and the least width in pixels.
const RING: (f32, f32) = (0.34, 1.8);
/// Least drawn radius in pixels: boats of a huge pool stay visible.
const LEAST_RADIUS: f32 = 1.0;
/// The radius from which on marks are legible, in pixels.
const LEAST_MARKED: f32 = 2.5;

/// The colors of a boat: a ring, if it has one, its body and its mark.
struct Colors {
    ring: Option<Rgb>,
    body: Rgb,
    mark: Rgb,
}

/// Draws all boats, leaders on top.
pub(super) fn draw(canvas: &mut Pixmap, flock: &Flock, view: &View, coloring: Coloring) {
    let hull = Hull::new(flock.parameters());
    let target = &flock.parameters().target;
    // In open water there is no center to circle around.
    let is_tinted = coloring == Coloring::Direction && flock.parameters().pool.has_walls();
    // Leaders come first, and are drawn last.
    for (boat, (hull_pose, pose)) in flock.hulls().iter().zip(flock.poses()).enumerate().rev() {
        let role = (boat < flock.parameters().n_leaders).then(|| color_of(target, boat));
        let colors = match (is_tinted, role) {
            (true, ring) => Colors {
                ring,
                body: tint(pose),
                mark: MARK,
            },
            (false, Some(body)) => Colors {
                ring: None,
                body,
                mark: if body == LEADER { LEADER_MARK } else { MARK },
            },
            (false, None) => Colors {
                ring: None,
                body: NORMAL,
                mark: MARK,
            },
        };
        if view.shows(hull_pose.center, hull.reach()) {
            draw_boat(canvas, view, hull, hull_pose, &colors);
        }
    }
}

/// The color of a leader: the same for all, unless they head against each other.
fn color_of(targets: &Targets, leader: usize) -> Rgb {
    if targets.are_opposed() && targets.of(leader) == Target::CounterClockwise {
        OPPONENT
    } else {
        LEADER
    }
}

/// A hull as thick lines with round ends, one within the other: outline, ring, body; and its mark.
fn draw_boat(canvas: &mut Pixmap, view: &View, hull: Hull, boat: &HullPose, colors: &Colors) {
    let radius = view.length(hull.radius).max(LEAST_RADIUS);
    let outline = (EDGE.0 * radius).max(EDGE.1).min(0.3 * radius);
    let ring = (RING.0 * radius).max(RING.1).min(radius - outline);
    let ends = [-1.0, 1.0].map(|side| view.pixel(boat.end(side, hull.half_length)));
    let mut inner = radius - outline;
    OUTLINE.line(canvas, ends, 2.0 * radius);
    if let Some(color) = colors.ring {
        color.line(canvas, ends, 2.0 * inner);
        inner -= ring;
    }
    if inner > 0.0 {
        colors.body.line(canvas, ends, 2.0 * inner);
    }
    if radius >= LEAST_MARKED {
        let share = f64::from(inner / radius);
        let (along, across) = (hull.half_length + share * hull.radius, share * hull.radius);
        colors.mark.fill(canvas, mark(view, boat, along, across));
    }
}

/// An arrowhead in the bow half of a hull with these half lengths along and across, in cm.
fn mark(view: &View, boat: &HullPose, along: f64, across: f64) -> PathBuilder {
    let corners = [(0.84, 0.0), (-0.12, 0.68), (0.1, 0.0), (-0.12, -0.68)];
    let mut path = PathBuilder::new();
    for (ahead, aside) in corners {
        let offset = boat.axis * (ahead * along) + turned_left(boat.axis) * (aside * across);
        let point = view.pixel(boat.center + offset);
        if path.is_empty() {
            path.move_to(point.x, point.y);
        } else {
            path.line_to(point.x, point.y);
        }
    }
    path.close();
    path
}
