//! The hull of a boat: a segment swept by a disc (Section 5.1, figure 13).

use super::{Pose, Vec2, Velocity};
use crate::parameters::FlockParameters;
use wide::{f64x4, u64x4};

/// The shape that all boats of a flock share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hull {
    /// Radius of the swept disc in cm.
    pub radius: f64,
    /// Half-length of the core segment in cm; 0 makes the hull a disc.
    pub half_length: f64,
}

impl Hull {
    /// The hull of checked parameters.
    pub fn new(parameters: &FlockParameters) -> Self {
        Self {
            radius: parameters.boat_radius_cm,
            half_length: parameters.half_length_cm(),
        }
    }

    /// The hull's lengths in cm that pictures need, by name.
    pub fn lengths(&self) -> [(&'static str, f64); 2] {
        [
            ("hull_radius_cm", self.radius),
            ("hull_half_length_cm", self.half_length),
        ]
    }

    /// Distance from the center to the farthest point of the hull.
    pub fn reach(&self) -> f64 {
        self.radius + self.half_length
    }

    /// Upper bound in cm/s of the speed of the core's points at this velocity. No gap of the hull changes faster, since
    /// the hull is its core widened by a fixed radius.
    #[inline]
    pub(crate) fn speed(&self, velocity: &Velocity) -> f64 {
        velocity.linear.norm_squared().sqrt() + self.half_length * velocity.angular.abs()
    }

    /// Area in cm².
    pub(crate) fn area(&self) -> f64 {
        (std::f64::consts::PI * self.radius + 4.0 * self.half_length) * self.radius
    }

    /// Radius of gyration of a hull of uniform density, in cm: r/√2 for a disc.
    pub fn gyration_radius(&self) -> f64 {
        let (r, h) = (self.radius, self.half_length);
        // Two half-discs, separated by 2h, and the rectangle between them.
        let discs = std::f64::consts::PI * (0.5 * r * r + h * h) + 8.0 / 3.0 * h * r;
        let rectangle = 4.0 / 3.0 * h * (h * h + r * r) / r;
        (r * r * (discs + rectangle) / self.area()).sqrt()
    }
}

/// Radius of gyration in cm after the hull is resized. It scales with that of a hull of uniform density. If the new size
/// is invalid, the radius of gyration stays as it is.
pub fn resized_gyration_radius_cm(
    parameters: &FlockParameters,
    boat_radius_cm: f64,
    boat_shape: f64,
) -> f64 {
    let resized_hull = Hull {
        radius: boat_radius_cm,
        half_length: boat_shape * boat_radius_cm,
    };
    let ratio = resized_hull.gyration_radius() / Hull::new(parameters).gyration_radius();
    if ratio.is_finite() && ratio > 0.0 {
        ratio * parameters.gyration_radius_cm
    } else {
        parameters.gyration_radius_cm
    }
}

/// A pose with its direction vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HullPose {
    /// Center of the hull.
    pub center: Vec2,
    /// Unit vector along the heading.
    pub axis: Vec2,
}

impl HullPose {
    /// The hull at a pose.
    #[inline]
    pub fn new(pose: &Pose) -> Self {
        let (sin, cos) = sin_cos(f64x4::splat(pose.heading));
        Self {
            center: pose.position,
            axis: Vec2::new(cos.as_array()[0], sin.as_array()[0]),
        }
    }

    /// Replaces `hulls` by the hulls at these poses, equal to the bit to those of [`Self::new`].
    pub fn replace_all(hulls: &mut Vec<Self>, poses: &[Pose]) {
        hulls.clear();
        let (groups, remaining) = poses.as_chunks::<4>();
        for group in groups {
            let (sin, cos) = sin_cos(f64x4::new(group.each_ref().map(|pose| pose.heading)));
            let (sin, cos) = (sin.to_array(), cos.to_array());
            hulls.extend_from_slice(&std::array::from_fn::<_, 4, _>(|lane| Self {
                center: group[lane].position,
                axis: Vec2::new(cos[lane], sin[lane]),
            }));
        }
        hulls.extend(remaining.iter().map(Self::new));
    }

    /// Replaces the hulls of the listed boats by those at their poses, equal to the bit to those of [`Self::new`].
    pub(crate) fn replace_some(hulls: &mut [Self], poses: &[Pose], boats: &[u32]) {
        for group in boats.chunks(4) {
            // If the last group is incomplete, its last boat fills the other lanes.
            let boat_in_lane = |lane: usize| group[lane.min(group.len() - 1)] as usize;
            let headings = std::array::from_fn(|lane| poses[boat_in_lane(lane)].heading);
            let (sin, cos) = sin_cos(f64x4::new(headings));
            let (sin, cos) = (sin.to_array(), cos.to_array());
            for (lane, &boat) in group.iter().enumerate() {
                hulls[boat as usize] = Self {
                    center: poses[boat as usize].position,
                    axis: Vec2::new(cos[lane], sin[lane]),
                };
            }
        }
    }

    /// The end of the core segment at the bow (`side` +1) or stern (−1).
    #[inline]
    pub fn end(&self, side: f64, half_length: f64) -> Vec2 {
        self.center + self.axis * (side * half_length)
    }
}

/// Sine and cosine with errors of about 1e-16. They are the same on every machine, since they do not use the system's
/// mathematical library. The polynomials on [−π/4, π/4] are those of Cephes (Moshier 1989).
#[inline]
fn sin_cos(angle: f64x4) -> (f64x4, f64x4) {
    let number = f64x4::splat;
    // Adding this constant rounds to an integer, which is then in the lowest bits. Subtracting the constant gives that
    // integer as a float.
    let rounding = number(6_755_399_441_055_744.0);
    let shifted = angle * number(std::f64::consts::FRAC_2_PI) + rounding;
    let quarters = shifted - rounding;
    // π/2 is split into parts whose integer multiples are exact.
    let x = angle
        - quarters * number(1.570_796_310_901_641_8)
        - quarters * number(1.589_325_471_229_585_7e-8)
        - quarters * number(6.123_233_995_736_766e-17);
    let z = x * x;
    let sin = number(1.589_623_015_765_465_6e-10);
    let sin = sin * z - number(2.505_074_776_285_780_7e-8);
    let sin = sin * z + number(2.755_731_362_138_572_2e-6);
    let sin = sin * z - number(1.984_126_982_958_954e-4);
    let sin = sin * z + number(8.333_333_333_322_118e-3);
    let sin = sin * z - number(1.666_666_666_666_663e-1);
    let sin = x + x * z * sin;
    let cos = number(-1.135_853_652_138_768_2e-11);
    let cos = cos * z + number(2.087_570_084_197_473e-9);
    let cos = cos * z - number(2.755_731_417_929_674e-7);
    let cos = cos * z + number(2.480_158_728_885_170_4e-5);
    let cos = cos * z - number(1.388_888_888_887_305_6e-3);
    let cos = cos * z + number(4.166_666_666_666_659_5e-2);
    let cos = number(1.0) - number(0.5) * z + z * z * cos;
    // Odd quarters swap sine and cosine. The second and third flip the sine's sign, the first and second the cosine's.
    let quarter_bits = shifted.to_bits();
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let (one, two) = (u64x4::splat(1), u64x4::splat(2));
    let swap = (u64x4::splat(0) - (quarter_bits & one)) & (sin ^ cos);
    let sin_sign = (quarter_bits & two) << 62_u32;
    let cos_sign = ((quarter_bits + one) & two) << 62_u32;
    (
        f64x4::from_bits(sin ^ swap ^ sin_sign),
        f64x4::from_bits(cos ^ swap ^ cos_sign),
    )
}
