//! Features of a whole flock, for critics that see everything. They depend neither on the numbering of the boats nor on
//! absolute angles. All are in the frame of the target: "ahead" is along the target's tangent, clockwise or not.

use super::blocks::{PHASE, phase_values};
use super::entry::{ANGULAR_VELOCITY_SCALE, CLOCK, Entry, FLAG, Scale, TWICE, UNIT};
use super::view::{FlockView, Scaling};
use crate::geometry::{LapFrame, Vec2};
use crate::parameters::{FlockParameters, Target};

/// Bounds of mean squares of velocities.
const SQUARE: (f64, f64) = (0.0, 4.0);
/// Bounds of products of radial positions and velocities.
const PRODUCT: (f64, f64) = (-2.2, 2.2);
/// Bounds of sums over several boats.
const SEVERAL: (f64, f64) = (-40.0, 40.0);

/// Means over a group of boats, in the frame of the target.
#[rustfmt::skip]
const GROUP: [Entry; 24] = [
    Entry::new("radial_position", "", Scale::Plain, (-1.1, 1.1), "mean radial position r, scaled as that of a leader"),
    Entry::new("radial_position_squared", "", Scale::Plain, (0.0, 1.21), "mean r^2"),
    Entry::new("outward", "", Scale::Plain, UNIT, "mean cosine of the LAP orientation"),
    Entry::new("outward_squared", "", Scale::Plain, FLAG, "its mean square"),
    Entry::new("ahead", "", Scale::Plain, UNIT, "mean cosine of the angle to the target's tangent: the signed order"),
    Entry::new("ahead_outward", "", Scale::Plain, UNIT, "mean product of these two cosines"),
    Entry::new("outward_velocity", "", Scale::Plain, TWICE, "mean velocity away from the center over the preferred speed"),
    Entry::new("outward_velocity_squared", "", Scale::Plain, SQUARE, "its mean square"),
    Entry::new("velocity_ahead", "", Scale::Plain, TWICE, "mean tangential velocity v towards the target over the preferred speed"),
    Entry::new("velocity_ahead_squared", "", Scale::Plain, SQUARE, "mean v^2"),
    Entry::new("spin_ahead", "", Scale::Plain, TWICE, "mean angular velocity over 2 rad/s, positive in the sense of the target's circulation"),
    Entry::new("spin_ahead_squared", "", Scale::Plain, SQUARE, "its mean square"),
    Entry::new("radial_outward", "", Scale::Plain, (-1.1, 1.1), "mean of r times the cosine of the LAP orientation"),
    Entry::new("radial_ahead", "", Scale::Plain, (-1.1, 1.1), "mean of r times the cosine of the angle to the tangent"),
    Entry::new("radial_velocity_ahead", "", Scale::Plain, PRODUCT, "mean of r*v"),
    Entry::new("against_inside", "", Scale::Plain, FLAG, "share of boats in the inner half (r <= 0) that head against the target, within 60 degrees"),
    Entry::new("against_outside", "", Scale::Plain, FLAG, "the same in the outer half"),
    Entry::new("across_inside", "", Scale::Plain, FLAG, "share in the inner half that head neither against nor along the target"),
    Entry::new("across_outside", "", Scale::Plain, FLAG, "the same in the outer half"),
    Entry::new("along_inside", "", Scale::Plain, FLAG, "share in the inner half that head along the target, within 60 degrees"),
    Entry::new("along_outside", "", Scale::Plain, FLAG, "the same in the outer half"),
    Entry::new("clumping_1", "", Scale::Plain, FLAG, "|mean exp(i*theta)| of the polar angles theta"),
    Entry::new("clumping_2", "", Scale::Plain, FLAG, "|mean exp(2i*theta)|"),
    Entry::new("clumping_3", "", Scale::Plain, FLAG, "|mean exp(3i*theta)|"),
];

/// Sums over the normal boats, weighted by exp(-d²/2), where d is the distance from a leader in units of 6 boat radii.
/// Each feature is the mean of that sum over the leaders.
#[rustfmt::skip]
const NEAR_LEADERS: [Entry; 4] = [
    Entry::new("near", "", Scale::Plain, SEVERAL, "mean over leaders of the sum over normal boats of the weight exp(-d^2/2), d their distance over 6 boat radii"),
    Entry::new("near_outward", "", Scale::Plain, SEVERAL, "the same of the weight times the cosine of the LAP orientation"),
    Entry::new("near_ahead", "", Scale::Plain, SEVERAL, "the same of the weight times the cosine of the angle to the target's tangent"),
    Entry::new("near_velocity_ahead", "", Scale::Plain, SEVERAL, "the same of the weight times the velocity towards the target over the preferred speed"),
];

/// Number of groups: normal boats, leaders.
const GROUPS: usize = 2;

/// All features of a flock in order, each with the name of its block.
pub fn flock_feature_entries() -> Vec<(&'static str, Entry)> {
    let blocks: [(&str, &[Entry]); 5] = [
        ("normal boats", &GROUP),
        ("leaders", &GROUP),
        ("near leaders", &NEAR_LEADERS),
        ("clock", &PHASE),
        ("clock", &CLOCK),
    ];
    let with_block = |(block, entries): (&'static str, &'static [Entry])| {
        entries.iter().map(move |entry| (block, *entry))
    };
    blocks.into_iter().flat_map(with_block).collect()
}

/// One boat in the frame of the target, scaled and clipped as observations are.
#[derive(Debug, Clone, Copy)]
struct ScaledBoat {
    radial: f64,
    outward: f64,
    ahead: f64,
    outward_velocity: f64,
    velocity_ahead: f64,
    spin_ahead: f64,
    /// Unit vector from the pool's center to the boat.
    outward_axis: Vec2,
    /// Center of the hull in cm.
    center: Vec2,
}

/// Writes the features of one flock.
#[derive(Debug, Clone)]
pub struct FlockFeatures {
    scaling: Scaling,
    /// Gain in 1/cm and offset of radial positions.
    radial_scale: (f64, f64),
    /// Gain of velocities, in s/cm.
    speed_gain: f64,
    /// d²/2 over the squared distance, where d is the distance in units of 6 boat radii; in 1/cm².
    half_square_gain: f64,
}

impl FlockFeatures {
    /// Number of features.
    pub const SIZE: usize = GROUPS * GROUP.len() + NEAR_LEADERS.len() + PHASE.len() + CLOCK.len();

    /// A writer for flocks with these checked parameters.
    pub fn new(parameters: &FlockParameters) -> Self {
        let entries = flock_feature_entries().into_iter();
        let length_gain = Scale::Length.affine(parameters).0;
        Self {
            scaling: Scaling::new(entries.map(|(_, entry)| entry), parameters),
            radial_scale: Scale::Radial.affine(parameters),
            speed_gain: Scale::Speed.affine(parameters).0,
            half_square_gain: 0.5 * length_gain * length_gain,
        }
    }

    /// Writes the features in the frame of a target; `elapsed` is the fraction of the episode that is over.
    pub fn observe(&self, view: &FlockView, target: Target, elapsed: f64, out: &mut [f32]) {
        let boats: Vec<_> = (0..view.poses.len())
            .map(|boat| self.scaled_boat(view, target, boat))
            .collect();
        let (leaders, normal_boats) = boats.split_at(view.leaders);
        let mut features = Vec::with_capacity(Self::SIZE);
        features.extend(group_means(normal_boats));
        features.extend(group_means(leaders));
        features.extend(self.near_leaders(leaders, normal_boats));
        features.extend(phase_values(view));
        features.push(elapsed);
        // The features are in the frame of the target already.
        let is_mirrored = false;
        self.scaling.write(&features, is_mirrored, out);
    }

    /// A boat in the frame of the target.
    fn scaled_boat(&self, view: &FlockView, target: Target, boat: usize) -> ScaledBoat {
        let (pose, velocity, hull) = (&view.poses[boat], &view.velocities[boat], &view.hulls[boat]);
        let frame = LapFrame::at(pose.position);
        let target_sign = target.sign();
        let (radial_gain, radial_offset) = self.radial_scale;
        let orientation = frame.components(hull.axis);
        let lap_velocity = frame.components(velocity.linear) * self.speed_gain;
        let spin = -velocity.angular / ANGULAR_VELOCITY_SCALE;
        ScaledBoat {
            radial: (pose.position.norm() * radial_gain + radial_offset).clamp(-1.1, 1.1),
            outward: orientation.x,
            ahead: target_sign * orientation.y,
            outward_velocity: lap_velocity.x.clamp(-2.0, 2.0),
            velocity_ahead: (target_sign * lap_velocity.y).clamp(-2.0, 2.0),
            spin_ahead: (target_sign * spin).clamp(-2.0, 2.0),
            outward_axis: frame.outward,
            center: hull.center,
        }
    }

    /// The values of [`NEAR_LEADERS`].
    fn near_leaders(
        &self,
        leaders: &[ScaledBoat],
        normal_boats: &[ScaledBoat],
    ) -> [f64; NEAR_LEADERS.len()] {
        let mut sums = [0.0; NEAR_LEADERS.len()];
        for leader in leaders {
            for boat in normal_boats {
                let square = (boat.center - leader.center).norm_squared();
                let weight = libm::exp(-self.half_square_gain * square);
                let values = [1.0, boat.outward, boat.ahead, boat.velocity_ahead];
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += weight * value;
                }
            }
        }
        sums.map(|sum| sum / leaders.len().max(1) as f64)
    }
}

/// The values of [`GROUP`]: means over a group of boats; zeros for an empty group.
fn group_means(group: &[ScaledBoat]) -> [f64; GROUP.len()] {
    let mut sums = [0.0; GROUP.len()];
    // Sums over boats of (cos mθ, sin mθ) for m = 1, 2 and 3, where θ is a boat's polar angle.
    let mut harmonics = [Vec2::zeros(); 3];
    for boat in group {
        let half = usize::from(boat.radial > 0.0);
        let mut is_in_bin = [0.0; 6];
        is_in_bin[2 * heading_bin(boat.ahead) + half] = 1.0;
        let values = moments(boat).into_iter().chain(is_in_bin);
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
        let axis = boat.outward_axis;
        let mut power = axis;
        for harmonic in &mut harmonics {
            *harmonic += power;
            // The product of complex numbers: the angle of `power` grows by θ.
            power = Vec2::new(
                power.x * axis.x - power.y * axis.y,
                power.x * axis.y + power.y * axis.x,
            );
        }
    }
    let first_harmonic = GROUP.len() - harmonics.len();
    for (sum, harmonic) in sums[first_harmonic..].iter_mut().zip(harmonics) {
        *sum = harmonic.norm();
    }
    sums.map(|sum| sum / group.len().max(1) as f64)
}

/// A boat's values, squares and products, whose means are the first features of its group.
fn moments(boat: &ScaledBoat) -> [f64; 15] {
    [
        boat.radial,
        boat.radial * boat.radial,
        boat.outward,
        boat.outward * boat.outward,
        boat.ahead,
        boat.ahead * boat.outward,
        boat.outward_velocity,
        boat.outward_velocity * boat.outward_velocity,
        boat.velocity_ahead,
        boat.velocity_ahead * boat.velocity_ahead,
        boat.spin_ahead,
        boat.spin_ahead * boat.spin_ahead,
        boat.radial * boat.outward,
        boat.radial * boat.ahead,
        boat.radial * boat.velocity_ahead,
    ]
}

/// 0 for boats that head against the target, 2 for those that head along it, within 60°; 1 for the others.
fn heading_bin(ahead: f64) -> usize {
    usize::from(ahead > -0.5) + usize::from(ahead > 0.5)
}
