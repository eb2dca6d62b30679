//! Features of a whole flock that depend neither on the order of boats nor on absolute angles, for critics that see
//! everything. All are in the frame of the target: "ahead" is along it, whichever direction it is.

use super::blocks::{PHASE, phase};
use super::entry::{ANGULAR_VELOCITY_SCALE, CLOCK, Entry, FLAG, Scale, TWICE, UNIT};
use super::view::{FlockView, Scaling};
use crate::geometry::{LapFrame, Vec2};
use crate::parameters::{FlockParameters, Target};

const SQUARE: (f64, f64) = (0.0, 4.0);
const PRODUCT: (f64, f64) = (-2.2, 2.2);
const SEVERAL: (f64, f64) = (-40.0, 40.0);

/// Means over a group of boats, in the frame of the target.
#[rustfmt::skip]
const GROUP: [Entry; 24] = [
    Entry::new("radial_position", "", Scale::Plain, (-1.1, 1.1), "mean radial position r, scaled as that of a leader"),
    Entry::new("radial_position_squared", "", Scale::Plain, (0.0, 1.21), "mean r^2"),
    Entry::new("outward", "", Scale::Plain, UNIT, "mean cosine of the LAP orientation"),
    Entry::new("outward_squared", "", Scale::Plain, FLAG, "its mean square"),
    Entry::new("ahead", "", Scale::Plain, UNIT, "mean cosine of the angle to the target's tangent: the signed order"),
    Entry::new("ahead_outward", "", Scale::Plain, UNIT, "mean product of the two"),
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

/// Sums over the normal boats, weighted by exp(-d²/2), where d is their distance from a leader in units of 6 boat
/// radii; means over the leaders.
#[rustfmt::skip]
const NEAR_LEADERS: [Entry; 4] = [
    Entry::new("near", "", Scale::Plain, SEVERAL, "mean over leaders of the sum over normal boats of the weight exp(-d^2/2), d their distance over 6 boat radii"),
    Entry::new("near_outward", "", Scale::Plain, SEVERAL, "the same of the weight times the cosine of the LAP orientation"),
    Entry::new("near_ahead", "", Scale::Plain, SEVERAL, "the same of the weight times the cosine of the angle to the target's tangent"),
    Entry::new("near_velocity_ahead", "", Scale::Plain, SEVERAL, "the same of the weight times the velocity towards the target over the preferred speed"),
];

/// Boats of the two groups: normal ones and leaders.
const GROUPS: usize = 2;

/// All features of a flock in order, each with its block.
pub fn flock_feature_entries() -> Vec<(&'static str, Entry)> {
    let blocks: [(&str, &[Entry]); 5] = [
        ("normal boats", &GROUP),
        ("leaders", &GROUP),
        ("near leaders", &NEAR_LEADERS),
        ("clock", &PHASE),
        ("clock", &CLOCK),
    ];
    let named = |(block, entries): (&'static str, &'static [Entry])| {
        entries.iter().map(move |entry| (block, *entry))
    };
    blocks.into_iter().flat_map(named).collect()
}

/// One boat in the frame of the target, scaled as observations are and within their bounds.
#[derive(Debug, Clone, Copy)]
struct Seen {
    radial: f64,
    outward: f64,
    ahead: f64,
    outward_velocity: f64,
    velocity_ahead: f64,
    spin_ahead: f64,
    polar: Vec2,
    center: Vec2,
}

/// Writes the features of one flock.
#[derive(Debug, Clone)]
pub struct FlockFeatures {
    scaling: Scaling,
    radial: (f64, f64),
    speed: f64,
    /// One over twice the square of the distance within which boats count as near a leader, in 1/cm².
    near: f64,
}

impl FlockFeatures {
    /// Number of features.
    pub const SIZE: usize = GROUPS * GROUP.len() + NEAR_LEADERS.len() + PHASE.len() + CLOCK.len();

    /// A writer for flocks with these checked parameters.
    pub fn new(parameters: &FlockParameters) -> Self {
        let entries = flock_feature_entries().into_iter();
        let length = Scale::Length.affine(parameters).0;
        Self {
            scaling: Scaling::new(entries.map(|(_, entry)| entry), parameters),
            radial: Scale::Radial.affine(parameters),
            speed: Scale::Speed.affine(parameters).0,
            near: 0.5 * length * length,
        }
    }

    /// Writes the features in the frame of a target; `elapsed` is the fraction of the episode that is over.
    pub fn observe(&self, view: &FlockView, target: Target, elapsed: f64, out: &mut [f32]) {
        let seen: Vec<_> = (0..view.poses.len())
            .map(|boat| self.seen(view, target, boat))
            .collect();
        let (leaders, normal) = seen.split_at(view.leaders);
        let mut features = Vec::with_capacity(Self::SIZE);
        features.extend(moments(normal));
        features.extend(moments(leaders));
        features.extend(self.near_leaders(leaders, normal));
        features.extend(phase(view));
        features.push(elapsed);
        self.scaling.write(&features, false, out);
    }

    fn seen(&self, view: &FlockView, target: Target, boat: usize) -> Seen {
        let (pose, velocity, hull) = (&view.poses[boat], &view.velocities[boat], &view.hulls[boat]);
        let frame = LapFrame::at(pose.position);
        let towards = target.sign();
        let orientation = frame.components(hull.axis);
        let lap_velocity = frame.components(velocity.linear) * self.speed;
        let spin = -velocity.angular / ANGULAR_VELOCITY_SCALE;
        Seen {
            radial: (pose.position.norm() * self.radial.0 + self.radial.1).clamp(-1.1, 1.1),
            outward: orientation.x,
            ahead: towards * orientation.y,
            outward_velocity: lap_velocity.x.clamp(-2.0, 2.0),
            velocity_ahead: (towards * lap_velocity.y).clamp(-2.0, 2.0),
            spin_ahead: (towards * spin).clamp(-2.0, 2.0),
            polar: frame.outward,
            center: hull.center,
        }
    }

    /// For each leader, sums values of the normal boats with the weight exp(−d²/2), where d is the scaled distance;
    /// returns the means over the leaders.
    fn near_leaders(&self, leaders: &[Seen], normal: &[Seen]) -> [f64; NEAR_LEADERS.len()] {
        let mut sums = [0.0; NEAR_LEADERS.len()];
        for leader in leaders {
            for boat in normal {
                let square = (boat.center - leader.center).norm_squared();
                let weight = libm::exp(-self.near * square);
                let values = [1.0, boat.outward, boat.ahead, boat.velocity_ahead];
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += weight * value;
                }
            }
        }
        sums.map(|sum| sum / leaders.len().max(1) as f64)
    }
}

/// Means over a group, zero for an empty one.
fn moments(group: &[Seen]) -> [f64; GROUP.len()] {
    let mut sums = [0.0; GROUP.len()];
    // cos(mθ) and sin(mθ) for m = 1, 2 and 3.
    let mut harmonics = [Vec2::zeros(); 3];
    for boat in group {
        let mut share = [0.0; 6];
        share[usize::from(boat.radial > 0.0) + 2 * heading_bin(boat.ahead)] = 1.0;
        for (sum, value) in sums.iter_mut().zip(products(boat).into_iter().chain(share)) {
            *sum += value;
        }
        let turn = boat.polar;
        let mut power = turn;
        for harmonic in &mut harmonics {
            *harmonic += power;
            power = Vec2::new(
                power.x * turn.x - power.y * turn.y,
                power.x * turn.y + power.y * turn.x,
            );
        }
    }
    let first = GROUP.len() - harmonics.len();
    for (sum, harmonic) in sums[first..].iter_mut().zip(harmonics) {
        *sum = harmonic.norm();
    }
    sums.map(|sum| sum / group.len().max(1) as f64)
}

/// A boat's numbers. Their means are the first features of its group.
fn products(boat: &Seen) -> [f64; 15] {
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
