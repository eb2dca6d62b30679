//! Signed gaps between hulls (negative = overlap), with the normal and lever arms that make a gap a
//! linear constraint on velocities.
//!
//! Two hulls overlap exactly if a core segment's end comes closer than 2r to the other core, or if
//! the cores cross. So the features of a pair are its four ends; the two of them that lie towards the
//! same end of the first core describe the same touch, and the nearer of those is kept. That leaves
//! at most two contacts a pair, both of them when hulls lie nearly parallel.

use super::{Hull, HullPose, Vec2, cross, turned_left};

/// A gap as a function of the motion of the two bodies it separates:
/// d(gap)/dt = normal·(v_i − v_j) + arm_i·ω_i − arm_j·ω_j.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Signed distance between the surfaces in cm, negative for overlap.
    pub gap: f64,
    /// Unit vector along which the first body is pushed.
    pub normal: Vec2,
    /// Lever arm of the normal about the first body's centre in cm.
    pub arm_i: f64,
    /// Lever arm of the normal about the second body's centre in cm; 0 for a wall.
    pub arm_j: f64,
}

/// Which part of two hulls a gap is measured between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum PairFeature {
    /// The first hull's stern against the second hull.
    SternOfFirst = 0,
    /// The first hull's bow against the second hull.
    BowOfFirst = 1,
    /// The second hull's stern against the first hull.
    SternOfSecond = 2,
    /// The second hull's bow against the first hull.
    BowOfSecond = 3,
    /// The cores cross; the gap is how far they must be moved apart.
    Crossed = 4,
}

impl PairFeature {
    const ENDS_OF_FIRST: [(Self, f64); 2] = [(Self::SternOfFirst, -1.0), (Self::BowOfFirst, 1.0)];
    const ENDS_OF_SECOND: [(Self, f64); 2] =
        [(Self::SternOfSecond, -1.0), (Self::BowOfSecond, 1.0)];

    /// The feature of a code 0 to 4; any other code counts as crossed.
    pub fn from_code(code: u8) -> Self {
        match code {
            0 => Self::SternOfFirst,
            1 => Self::BowOfFirst,
            2 => Self::SternOfSecond,
            3 => Self::BowOfSecond,
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
        }
    }

    /// The gap at an end of hull a. Where end meets end, both hulls' features would describe it:
    /// `None` unless this one is asked for with `mutual`.
    fn end_of_a(&self, side: f64, mutual: bool) -> Option<(Vec2, Vec2)> {
        let h = self.hull.half_length;
        let p = self.a.end(side, h);
        let onto = self.project(p, self.b);
        let q = self.b.center + self.b.axis * onto.nearest;
        if mutual && onto.beyond && (q - self.a.center).dot(&self.a.axis) * side < h {
            return None;
        }
        Some((p, q))
    }

    /// The gap at an end of hull b, only where it faces the side of hull a if `strict`.
    fn end_of_b(&self, side: f64, strict: bool) -> Option<(Vec2, Vec2)> {
        let q = self.b.end(side, self.hull.half_length);
        let onto = self.project(q, self.a);
        if strict && onto.beyond {
            return None;
        }
        Some((self.a.center + self.a.axis * onto.nearest, q))
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
    let ends_of_b_follow = a.axis.dot(&b.axis) >= 0.0;
    for (end, (feature_a, side_a)) in PairFeature::ENDS_OF_FIRST.into_iter().enumerate() {
        if h == 0.0 && end == 1 {
            break;
        }
        let (feature_b, side_b) =
            PairFeature::ENDS_OF_SECOND[if ends_of_b_follow { end } else { 1 - end }];
        let at_a = pair
            .end_of_a(side_a, true)
            .map(|points| (feature_a, points));
        let at_b = pair
            .end_of_b(side_b, true)
            .map(|points| (feature_b, points));
        let nearer = [at_a, at_b].into_iter().flatten().min_by(|(_, x), (_, y)| {
            let [x, y] = [x, y].map(|(p, q)| (p - q).norm_squared());
            x.total_cmp(&y)
        });
        let Some((feature, (p, q))) = nearer else {
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
    }
}

/// The gap of one known feature at other poses, for passes that re-evaluate gaps.
pub fn pair_gap(feature: PairFeature, a: &HullPose, b: &HullPose, hull: Hull) -> Gap {
    let pair = Pair { a, b, hull };
    let points = match feature {
        PairFeature::SternOfFirst => pair.end_of_a(-1.0, false),
        PairFeature::BowOfFirst => pair.end_of_a(1.0, false),
        PairFeature::SternOfSecond => pair.end_of_b(-1.0, false),
        PairFeature::BowOfSecond => pair.end_of_b(1.0, false),
        PairFeature::Crossed => None,
    };
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
