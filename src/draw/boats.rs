//! The boats: hulls (segments swept by a disc) with a mark that points to the bow.

use super::palette::{Coloring, LEADER, LEADER_MARK, MARK, NORMAL, OPPONENT, OUTLINE, Rgb, tint};
use super::view::View;
use crate::flock::Flock;
use crate::geometry::{Hull, HullPose, turned_left};
use crate::parameters::{Target, Targets};
use tiny_skia::{PathBuilder, Pixmap};

/// Width of outlines.
const OUTLINE_WIDTH: LineWidth = LineWidth {
    fraction: 0.14,
    least: 1.0,
};
/// Width of a leader's ring.
const RING_WIDTH: LineWidth = LineWidth {
    fraction: 0.34,
    least: 1.8,
};
/// Least drawn radius in pixels, so that boats in a huge pool stay visible.
const LEAST_RADIUS: f32 = 1.0;
/// Least radius in pixels at which marks are drawn.
const LEAST_MARKED: f32 = 2.5;

/// Width of a line around a hull.
struct LineWidth {
    /// Width as a fraction of the hull's radius.
    fraction: f32,
    /// Least width in pixels.
    least: f32,
}

impl LineWidth {
    /// The width in pixels around a hull with this radius in pixels.
    fn pixels(&self, radius: f32) -> f32 {
        (self.fraction * radius).max(self.least)
    }
}

/// The colors of a boat's ring (if it has one), body and mark.
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
    // Leaders have the first indices. The reversed order draws them last.
    for (boat, (hull_pose, pose)) in flock.hulls().iter().zip(flock.poses()).enumerate().rev() {
        let is_leader = boat < flock.parameters().n_leaders;
        let leader_color = is_leader.then(|| leader_color(target, boat));
        let colors = match (is_tinted, leader_color) {
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

/// The color of a leader. All leaders have the same color unless their targets differ.
fn leader_color(targets: &Targets, leader: usize) -> Rgb {
    if targets.are_opposed() && targets.of(leader) == Target::CounterClockwise {
        OPPONENT
    } else {
        LEADER
    }
}

/// Draws a hull as thick lines with round ends, one on top of the other (outline, ring, body), and then its mark.
fn draw_boat(canvas: &mut Pixmap, view: &View, hull: Hull, boat: &HullPose, colors: &Colors) {
    let radius = view.length(hull.radius).max(LEAST_RADIUS);
    let outline = OUTLINE_WIDTH.pixels(radius).min(0.3 * radius);
    let ring = RING_WIDTH.pixels(radius).min(radius - outline);
    let ends = [-1.0, 1.0].map(|side| view.pixel(boat.end(side, hull.half_length)));
    let mut inner_radius = radius - outline;
    OUTLINE.line(canvas, ends, 2.0 * radius);
    if let Some(color) = colors.ring {
        color.line(canvas, ends, 2.0 * inner_radius);
        inner_radius -= ring;
    }
    if inner_radius > 0.0 {
        colors.body.line(canvas, ends, 2.0 * inner_radius);
    }
    if radius >= LEAST_MARKED {
        let body_fraction = f64::from(inner_radius / radius);
        let half_width = body_fraction * hull.radius;
        let half_length = hull.half_length + half_width;
        colors
            .mark
            .fill(canvas, mark(view, boat, half_length, half_width));
    }
}

/// An arrowhead in the bow half of a hull with this half-length and half-width in cm.
fn mark(view: &View, boat: &HullPose, half_length: f64, half_width: f64) -> PathBuilder {
    // Fractions of the half-length ahead of the center, and of the half-width to its left.
    let corners = [(0.84, 0.0), (-0.12, 0.68), (0.1, 0.0), (-0.12, -0.68)];
    let mut path = PathBuilder::new();
    for (ahead, aside) in corners {
        let offset =
            boat.axis * (ahead * half_length) + turned_left(boat.axis) * (aside * half_width);
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
