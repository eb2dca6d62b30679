//! Signed gaps between hulls (negative = overlap), with the normal and lever arms that make a gap a
//! linear constraint on velocities.
//!
//! Two hulls overlap exactly if a core segment's end comes closer than 2r to the other core, or if
//! the cores cross. The four ends fall into two groups, those towards the stern and those towards the
//! bow of the first hull; the ends of a group describe the same touch, and the nearer of them counts.
//! That leaves at most two contacts a pair, both of them when hulls lie nearly parallel.

use super::{Hull, HullPose, Vec2, cross, turned_left};

/// A gap as a function of the motion of the two bodies it separates:
/// d(gap)/dt = normal·(v_i − v_j) + arm_i·ω_i − arm_j·ω_j.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Signed distance between the surfaces in cm, negative for overlap.
    pub gap: f64,
    /// Unit vector along which the first body is pushed.
    pub normal: Vec2,
    /// Lever arm of the normal about the first body's center in cm.
    pub arm_i: f64,
    /// Lever arm of the normal about the second body's center in cm; 0 for a wall.
    pub arm_j: f64,
    /// Second derivative of the gap by the first body's heading in cm/rad², where it matters: a flank
    /// on the inner wall; 0 elsewhere.
    pub bend: f64,
}

/// Where on the first hull of a pair a contact is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum PairFeature {
    /// Towards the first hull's stern.
    Stern = 0,
    /// Towards the first hull's bow.
    Bow = 1,
    /// The cores cross; the gap is how far they must be moved apart.
    Crossed = 2,
}

impl PairFeature {
    /// The feature of a code; any code beyond the two ends counts as crossed.
    pub fn from_code(code: u8) -> Self {
        match code {
            0 => Self::Stern,
            1 => Self::Bow,
            _ => Self::Crossed,
        }
    }
}

/// Cores nearer than this (cm) have no usable normal and count as crossed.
const TOUCHING_CORES: f64 = 1e-9;

/// Two hulls and what their gaps share.
struct Pair<'a> {
    a: &'a HullPose,
    b: &'a HullPose,
    hull: Hull,
}

/// Where along a core an end projects to, and what is nearest to it there.
struct Projection {
    /// Coordinate of the nearest point along the core, within [−h, h].
    nearest: f64,
    /// Whether the end projects beyond the core's own end.
    beyond: bool,
}

impl Pair<'_> {
    fn project(&self, point: Vec2, core: &HullPose) -> Projection {
        let h = self.hull.half_length;
        let along = (point - core.center).dot(&core.axis);
        Projection {
            nearest: along.clamp(-h, h),
            beyond: along.abs() > h,
        }
    }

    /// The gap between point `p` of hull a's core and point `q` of hull b's core; `None` if the
    /// points coincide.
    fn between(&self, p: Vec2, q: Vec2) -> Option<Gap> {
        let apart = p - q;
        let distance = apart.norm();
        if distance < TOUCHING_CORES {
            return None;
        }
        let normal = apart / distance;
        Some(self.along(normal, distance, p, q))
    }

    fn along(&self, normal: Vec2, distance: f64, p: Vec2, q: Vec2) -> Gap {
        Gap {
            gap: distance - 2.0 * self.hull.radius,
            normal,
            arm_i: cross(p - self.a.center, normal),
            arm_j: cross(q - self.b.center, normal),
            bend: 0.0,
        }
    }

    /// Nearest points for an end of hull a. Where end meets end, both hulls' ends describe it: with
    /// `once`, only the first hull's does, and only if neither end could slide nearer.
    fn end_of_a(&self, side: f64, once: bool) -> Option<(Vec2, Vec2)> {
        let h = self.hull.half_length;
        let p = self.a.end(side, h);
        let onto = self.project(p, self.b);
        let q = self.b.center + self.b.axis * onto.nearest;
        if once && onto.beyond && (q - self.a.center).dot(&self.a.axis) * side < h {
            return None;
        }
        Some((p, q))
    }

    /// Nearest points for an end of hull b, if it faces the side of hull a.
    fn end_of_b(&self, side: f64) -> Option<(Vec2, Vec2)> {
        let q = self.b.end(side, self.hull.half_length);
        let onto = self.project(q, self.a);
        (!onto.beyond).then(|| (self.a.center + self.a.axis * onto.nearest, q))
    }

    /// The nearest points of the group of ends on one side of hull a.
    fn nearest_towards(&self, side: f64) -> Option<(Vec2, Vec2)> {
        let follows = if self.a.axis.dot(&self.b.axis) >= 0.0 {
            side
        } else {
            -side
        };
        let (at_a, at_b) = (self.end_of_a(side, true), self.end_of_b(follows));
        match (at_a, at_b) {
            (Some(a), Some(b)) if (b.0 - b.1).norm_squared() < (a.0 - a.1).norm_squared() => at_b,
            (Some(_), _) => at_a,
            (None, _) => at_b,
        }
    }

    fn cores_cross(&self) -> bool {
        let h = self.hull.half_length;
        let apart = self.b.center - self.a.center;
        let sine = cross(self.a.axis, self.b.axis);
        let s = cross(apart, self.b.axis);
        let t = cross(apart, self.a.axis);
        // a + s/sine·axis_a = b + t/sine·axis_b with both coordinates within the cores.
        sine != 0.0 && s.abs() <= h * sine.abs() && t.abs() <= h * sine.abs()
    }
}

/// The contacts of two hulls with a gap below `margin`: none, one or two, handed to `found`.
pub fn pair_gaps(
    a: &HullPose,
    b: &HullPose,
    hull: Hull,
    margin: f64,
    mut found: impl FnMut(PairFeature, Gap),
) {
    let apart = b.center - a.center;
    let reach = 2.0 * hull.reach() + margin;
    let distance_squared = apart.norm_squared();
    if distance_squared > reach * reach {
        return;
    }
    let pair = Pair { a, b, hull };
    let h = hull.half_length;
    if distance_squared <= 4.0 * h * h && pair.cores_cross() {
        found(PairFeature::Crossed, crossed_gap(a, b, hull));
        return;
    }
    for (feature, side) in [(PairFeature::Stern, -1.0), (PairFeature::Bow, 1.0)] {
        let Some((p, q)) = pair.nearest_towards(side) else {
            continue;
        };
        let farthest = 2.0 * hull.radius + margin;
        if (p - q).norm_squared() >= farthest * farthest {
            continue;
        }
        match pair.between(p, q) {
            Some(gap) => found(feature, gap),
            None => {
                found(PairFeature::Crossed, crossed_gap(a, b, hull));
                return;
            }
        }
        if h == 0.0 {
            return;
        }
    }
}

/// The gap of a known contact at other poses of its hulls.
pub fn pair_gap(feature: PairFeature, a: &HullPose, b: &HullPose, hull: Hull) -> Gap {
    let pair = Pair { a, b, hull };
    let side = match feature {
        PairFeature::Stern => -1.0,
        PairFeature::Bow => 1.0,
        PairFeature::Crossed => return crossed_gap(a, b, hull),
    };
    // Where no end of the group faces the other hull any more, its own end still has a distance.
    let points = pair
        .nearest_towards(side)
        .or_else(|| pair.end_of_a(side, false));
    points
        .and_then(|(p, q)| pair.between(p, q))
        .unwrap_or_else(|| crossed_gap(a, b, hull))
}

/// The gap of crossed cores: the least distance by which one core's end must be moved across the
/// other's line, and as much more as makes the hulls touch.
pub fn crossed_gap(a: &HullPose, b: &HullPose, hull: Hull) -> Gap {
    let pair = Pair { a, b, hull };
    let h = hull.half_length;
    let mut least: Option<(f64, Gap)> = None;
    for side in [-1.0, 1.0] {
        let across_b = turned_left(b.axis);
        let p = a.end(side, h);
        let depth = across_b.dot(&(p - b.center));
        let q = p - across_b * depth;
        let candidate_a = (depth, across_b * -sign(depth), p, q);

        let across_a = turned_left(a.axis);
        let q = b.end(side, h);
        let depth = across_a.dot(&(q - a.center));
        let p = q - across_a * depth;
        let candidate_b = (depth, across_a * sign(depth), p, q);

        for (depth, normal, p, q) in [candidate_a, candidate_b] {
            if least.is_none_or(|(known, _)| depth.abs() < known) {
                least = Some((depth.abs(), pair.along(normal, -depth.abs(), p, q)));
            }
        }
    }
    least.map_or_else(
        || pair.along(turned_left(a.axis), 0.0, a.center, b.center),
        |(_, gap)| gap,
    )
}

fn sign(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}
