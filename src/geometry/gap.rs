//! Signed gaps between hulls (negative = overlap), with the normal and lever arms that make a gap a
//! linear constraint on velocities.
//!
//! Two hulls overlap if and only if an end of one core comes closer than 2r to the other core, or the cores cross. The
//! four ends fall into two groups, those towards the stern and those towards the bow of the first hull; the ends of a
//! group describe the same touch, and the nearer of them counts. So a pair has at most two contacts, and two only if
//! its hulls are nearly parallel.

use super::{Hull, HullPose, Vec2, cross, smaller, turned_left};

/// A gap as a function of the motion of the two bodies it separates:
/// d(gap)/dt = normal·(v_i − v_j) + arm_i·ω_i − arm_j·ω_j.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Signed distance between the surfaces in cm, negative for overlap.
    pub gap: f64,
    /// Unit vector along which the first body is pushed.
    pub normal: Vec2,
    /// The coordinate of the touch along the first hull's core, in cm: 0 at its center, positive towards the bow.
    pub along: f64,
    /// The coordinate of the touch along the second hull's core, in cm; 0 at a round wall.
    pub along_j: f64,
    /// Lever arm of the normal about the first body's center in cm.
    pub arm_i: f64,
    /// Lever arm of the normal about the second body's center in cm; 0 for a wall.
    pub arm_j: f64,
    /// Second derivative of the gap by the first body's heading in cm/rad², if its flank touches the inner wall, a disc
    /// or the end of a straight wall; 0 otherwise.
    pub bend: f64,
}

/// Position of a contact on a hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Feature {
    /// Towards the stern.
    Stern,
    /// Towards the bow.
    Bow,
    /// The cores cross; the hulls must move apart by −gap.
    Crossed,
    /// Anywhere along the hull: a disc or the inner wall touches it only once.
    Flank,
}

impl Feature {
    /// Both ends of a hull.
    pub const ENDS: [Self; 2] = [Self::Stern, Self::Bow];

    /// The end: −1 at the stern, +1 at the bow; `None` for a contact that is at neither.
    #[inline]
    pub fn side(self) -> Option<f64> {
        match self {
            Self::Stern => Some(-1.0),
            Self::Bow => Some(1.0),
            Self::Crossed | Self::Flank => None,
        }
    }
}

/// Cores nearer than this (cm) have no usable normal and count as crossed.
const TOUCHING_CORES: f64 = 1e-9;

/// A hull with its pose.
pub type Placed<'a> = (&'a HullPose, Hull);

/// Two hulls, with numbers from which both of their gaps follow.
struct Pair<'a> {
    a: &'a HullPose,
    b: &'a HullPose,
    hull_a: Hull,
    hull_b: Hull,
    /// From the first center to the second.
    offset: Vec2,
    /// Components of `offset` along both axes.
    offset_along_a: f64,
    offset_along_b: f64,
    /// Cosine of the angle between the axes.
    cosine: f64,
}

/// A point of each core, between which the gap is measured.
#[derive(Clone, Copy)]
struct Touch {
    /// Coordinates along the cores, from their centers.
    along_a: f64,
    along_b: f64,
    /// From the second core's point to the first's.
    separation: Vec2,
}

impl<'a> Pair<'a> {
    #[inline]
    fn new((a, hull_a): Placed<'a>, (b, hull_b): Placed<'a>) -> Self {
        let offset = b.center - a.center;
        Self {
            a,
            b,
            hull_a,
            hull_b,
            offset,
            offset_along_a: offset.dot(&a.axis),
            offset_along_b: offset.dot(&b.axis),
            cosine: a.axis.dot(&b.axis),
        }
    }

    /// The gap of a touch; `None` if its two points coincide.
    fn gap(&self, touch: &Touch) -> Option<Gap> {
        let distance = touch.separation.norm_squared().sqrt();
        if distance < TOUCHING_CORES {
            return None;
        }
        let normal = touch.separation * (1.0 / distance);
        Some(Gap {
            gap: distance - (self.hull_a.radius + self.hull_b.radius),
            normal,
            along: touch.along_a,
            along_j: touch.along_b,
            arm_i: touch.along_a * cross(self.a.axis, normal),
            arm_j: touch.along_b * cross(self.b.axis, normal),
            bend: 0.0,
        })
    }

    /// The touch at these coordinates along the two cores.
    fn touch(&self, along_a: f64, along_b: f64) -> Touch {
        Touch {
            along_a,
            along_b,
            separation: self.a.axis * along_a - self.b.axis * along_b - self.offset,
        }
    }

    /// Coordinate along core b, possibly past its ends, of the point on its line that is nearest to an end of core a.
    #[inline]
    fn end_of_a_along_b(&self, side: f64) -> f64 {
        side * self.hull_a.half_length * self.cosine - self.offset_along_b
    }

    /// The touch of an end of core a with the nearest point of core b.
    fn end_of_a(&self, side: f64) -> Touch {
        let h_b = self.hull_b.half_length;
        let nearest = self.end_of_a_along_b(side).clamp(-h_b, h_b);
        self.touch(side * self.hull_a.half_length, nearest)
    }

    /// As [`Self::end_of_a`]; `None` if the nearest point is an end of core b to which another point of core a is nearer.
    fn facing_end_of_a(&self, side: f64) -> Option<Touch> {
        let (h_a, h_b) = (self.hull_a.half_length, self.hull_b.half_length);
        let along_b = self.end_of_a_along_b(side);
        let nearest = along_b.clamp(-h_b, h_b);
        if along_b.abs() > h_b && (self.offset_along_a + nearest * self.cosine) * side < h_a {
            return None;
        }
        Some(self.touch(side * h_a, nearest))
    }

    /// The touch of an end of core b with the flank of hull a; `None` if the end lies past an end of core a.
    fn facing_end_of_b(&self, side: f64) -> Option<Touch> {
        let h_b = self.hull_b.half_length;
        let along_a = self.offset_along_a + side * h_b * self.cosine;
        (along_a.abs() <= self.hull_a.half_length).then(|| self.touch(along_a, side * h_b))
    }

    /// The touch at the bow (`side` +1) or stern (−1) of hull a. Two ends are there, one of each hull, and the nearer one
    /// counts. `None` if neither faces the other core.
    // Inlined into its callers: otherwise touches would pass through memory.
    #[inline(always)]
    fn touch_towards(&self, side: f64) -> Option<Touch> {
        let side_b = if self.cosine >= 0.0 { side } else { -side };
        match (self.facing_end_of_a(side), self.facing_end_of_b(side_b)) {
            (Some(a), Some(b)) => {
                let is_b_nearer = b.separation.norm_squared() < a.separation.norm_squared();
                Some(if is_b_nearer { b } else { a })
            }
            (at_a, at_b) => at_a.or(at_b),
        }
    }

    /// The squared distance of the cores at [`Self::touch_towards`]; infinite if neither end faces the other core.
    #[inline]
    fn squared_distance_towards(&self, side: f64) -> f64 {
        let square = |touch: Touch| touch.separation.norm_squared();
        let side_b = if self.cosine >= 0.0 { side } else { -side };
        let square_a = self.facing_end_of_a(side).map_or(f64::INFINITY, square);
        let square_b = self.facing_end_of_b(side_b).map_or(f64::INFINITY, square);
        smaller(square_a, square_b)
    }

    /// Whether the cores cross, or are too near for a normal. `squares` are the squared distances of the cores at the stern
    /// and at the bow of hull a.
    #[inline]
    fn are_crossed(&self, squares: [f64; 2]) -> bool {
        let lengths = self.hull_a.half_length + self.hull_b.half_length;
        smaller(squares[0], squares[1]) < TOUCHING_CORES * TOUCHING_CORES
            || (self.offset.norm_squared() <= lengths * lengths && self.cores_cross())
    }

    /// Whether the cores share a point.
    fn cores_cross(&self) -> bool {
        let (h_a, h_b) = (self.hull_a.half_length, self.hull_b.half_length);
        let sine = cross(self.a.axis, self.b.axis);
        let s = cross(self.offset, self.b.axis);
        let t = cross(self.offset, self.a.axis);
        // The lines meet at a + s/sine·axis_a = b + t/sine·axis_b. The cores cross if both hold that point.
        sine != 0.0 && s.abs() <= h_a * sine.abs() && t.abs() <= h_b * sine.abs()
    }
}

/// Calls `visit` with each contact of two hulls whose gap is below `margin`: at most two. The second hull must have the
/// shape of the first, or a core of any length above 0.
#[inline]
pub fn pair_gaps(first: Placed, second: Placed, margin: f64, mut visit: impl FnMut(Feature, Gap)) {
    let ((a, hull_a), (b, hull_b)) = (first, second);
    let reach = hull_a.reach() + hull_b.reach() + margin;
    let distance_squared = (b.center - a.center).norm_squared();
    if distance_squared > reach * reach {
        return;
    }
    let pair = Pair::new(first, second);
    let lengths = hull_a.half_length + hull_b.half_length;
    if distance_squared <= lengths * lengths && pair.cores_cross() {
        visit(Feature::Crossed, crossed_gap(a, hull_a, b, hull_b));
        return;
    }
    let farthest = hull_a.radius + hull_b.radius + margin;
    for (feature, side) in Feature::ENDS.into_iter().zip([-1.0, 1.0]) {
        let Some(touch) = pair.touch_towards(side) else {
            continue;
        };
        if touch.separation.norm_squared() >= farthest * farthest {
            continue;
        }
        match pair.gap(&touch) {
            Some(gap) => visit(feature, gap),
            None => {
                visit(Feature::Crossed, crossed_gap(a, hull_a, b, hull_b));
                return;
            }
        }
        // The stern and the bow of a disc are the same.
        if hull_a.half_length == 0.0 {
            return;
        }
    }
}

/// The gap of the contact at `feature` of the first hull, however wide it is.
#[inline]
pub fn pair_gap(feature: Feature, first: Placed, second: Placed) -> Gap {
    let ((a, hull_a), (b, hull_b)) = (first, second);
    let pair = Pair::new(first, second);
    let Some(side) = feature.side() else {
        return crossed_gap(a, hull_a, b, hull_b);
    };
    // If neither hull's end on this side faces the other hull any more, the distance of the first hull's end counts.
    let touch = pair
        .touch_towards(side)
        .unwrap_or_else(|| pair.end_of_a(side));
    pair.gap(&touch)
        .unwrap_or_else(|| crossed_gap(a, hull_a, b, hull_b))
}

/// One of the two touches of two hulls: its position and its gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EndTouch {
    /// The gap in cm; infinite if the touch is missing.
    pub(crate) gap: f64,
    /// The coordinates along both cores, as in [`Gap::along`] and [`Gap::along_j`].
    pub(crate) along: [f64; 2],
}

impl EndTouch {
    /// A missing touch: no end on this side of the first hull faces the other hull.
    pub(crate) const MISSING: Self = Self {
        gap: f64::INFINITY,
        along: [0.0; 2],
    };
}

impl From<&Gap> for EndTouch {
    fn from(gap: &Gap) -> Self {
        Self {
            gap: gap.gap,
            along: [gap.along, gap.along_j],
        }
    }
}

/// The touches at the stern and at the bow of the first hull. If the cores cross, both are at their crossing.
#[inline]
pub(crate) fn end_touches(first: Placed, second: Placed) -> [EndTouch; 2] {
    let ((a, hull_a), (b, hull_b)) = (first, second);
    let pair = Pair::new(first, second);
    let touches = [-1.0, 1.0].map(|side| pair.touch_towards(side));
    let squares =
        touches.map(|touch| touch.map_or(f64::INFINITY, |touch| touch.separation.norm_squared()));
    if pair.are_crossed(squares) {
        return [EndTouch::from(&crossed_gap(a, hull_a, b, hull_b)); 2];
    }
    [0, 1].map(|end| EndTouch {
        gap: squares[end].sqrt() - (hull_a.radius + hull_b.radius),
        along: touches[end].map_or([0.0; 2], |touch| [touch.along_a, touch.along_b]),
    })
}

/// The smaller of the gaps at the stern and at the bow of the first hull, in cm; infinite if no end faces the other hull.
#[inline]
pub(crate) fn smallest_gap(first: Placed, second: Placed) -> f64 {
    let ((a, hull_a), (b, hull_b)) = (first, second);
    let pair = Pair::new(first, second);
    let squares = [-1.0, 1.0].map(|side| pair.squared_distance_towards(side));
    if pair.are_crossed(squares) {
        return crossed_gap(a, hull_a, b, hull_b).gap;
    }
    smaller(squares[0], squares[1]).sqrt() - (hull_a.radius + hull_b.radius)
}

/// The gap of crossed cores, which is negative. Its depth is the least distance of an end of one core from the line of
/// the other, plus both radii.
// Not inlined, because that would slow down gaps that are not crossed. The arguments are not tuples, so that they stay in
// registers: tuples would be stored for each pair, crossed or not.
#[cold]
fn crossed_gap(a: &HullPose, hull_a: Hull, b: &HullPose, hull_b: Hull) -> Gap {
    let (h_a, h_b) = (hull_a.half_length, hull_b.half_length);
    // `p` and `q` are the points of the cores of a and b between which the gap is measured.
    let gap_between = |distance: f64, normal, p: Vec2, q: Vec2| Gap {
        gap: distance - (hull_a.radius + hull_b.radius),
        normal,
        along: (p - a.center).dot(&a.axis).clamp(-h_a, h_a),
        along_j: (q - b.center).dot(&b.axis).clamp(-h_b, h_b),
        arm_i: cross(p - a.center, normal),
        arm_j: cross(q - b.center, normal),
        bend: 0.0,
    };
    let (across_a, across_b) = (turned_left(a.axis), turned_left(b.axis));
    let end_of_a = |side: f64| {
        let p = a.end(side, h_a);
        let depth = across_b.dot(&(p - b.center));
        let q = p - across_b * depth;
        let gap = gap_between(-depth.abs(), across_b * -sign(depth), p, q);
        (depth.abs(), gap)
    };
    let end_of_b = |side: f64| {
        let q = b.end(side, h_b);
        let depth = across_a.dot(&(q - a.center));
        let p = q - across_a * depth;
        let gap = gap_between(-depth.abs(), across_a * sign(depth), p, q);
        (depth.abs(), gap)
    };
    let (mut least_depth, mut shallowest) = end_of_a(-1.0);
    for (depth, gap) in [end_of_b(-1.0), end_of_a(1.0), end_of_b(1.0)] {
        if depth < least_depth {
            (least_depth, shallowest) = (depth, gap);
        }
    }
    shallowest
}

fn sign(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}
