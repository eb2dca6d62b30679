//! Order parameters of Section 3.2, in the LAP frame.

use crate::error::{FlockError, Result};
use crate::geometry::{HullPose, LapFrame, Pose, Vec2, Velocity};
use crate::parameters::Target;
use std::f64::consts::FRAC_PI_2;

/// Alignment of a set of boats at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct OrderParameters {
    /// Ψ_o = |mean o_i| in [0, 1] (eq. 1).
    pub psi_o: f64,
    /// φ_o = arg mean o_i in (−π, π]: 0 jammed outward, +π/2 clockwise (eq. 3).
    pub phi_o: f64,
    /// C_o: mean of o_i·o_j over unordered pairs in [−1, 1] (eq. 2, where the printed sum counts
    /// pairs twice); NaN for a single boat.
    pub c_o: f64,
    /// Ψ_v = |mean v_i| in cm/s (eq. 4).
    pub psi_v: f64,
    /// φ_v = arg mean v_i in (−π, π] (eq. 6).
    pub phi_v: f64,
    /// C_v: mean of v_i·v_j over unordered pairs in cm²/s² (eq. 5); NaN for a single boat.
    pub c_v: f64,
}

impl OrderParameters {
    /// Order parameters of boats with these poses and velocities (two slices of equal length).
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if there is no boat.
    pub fn from_poses(poses: &[Pose], velocities: &[Velocity]) -> Result<Self> {
        let mut hulls = Vec::with_capacity(poses.len());
        HullPose::replace_all(&mut hulls, poses);
        Self::from_hulls(&hulls, velocities)
    }

    /// Order parameters of boats with these hulls and velocities (two slices of equal length).
    ///
    /// # Errors
    /// [`FlockError::Parameter`] if there is no boat.
    pub(crate) fn from_hulls(hulls: &[HullPose], velocities: &[Velocity]) -> Result<Self> {
        let accepted = "order parameters need at least one normal boat; pass include_leaders=True";
        FlockError::unless(!hulls.is_empty(), "n_boats - n_leaders", 0, accepted)?;
        let (mut orientations, mut motions) = (VectorSum::default(), VectorSum::default());
        for (hull, velocity) in hulls.iter().zip(velocities) {
            let frame = LapFrame::at(hull.center);
            orientations.add(frame.components(hull.axis));
            motions.add(frame.components(velocity.linear));
        }
        let [psi_o, phi_o, c_o] = orientations.mean();
        let [psi_v, phi_v, c_v] = motions.mean();
        Ok(Self {
            psi_o,
            phi_o,
            c_o,
            psi_v,
            phi_v,
            c_v,
        })
    }

    /// Signed order towards a target, Ψ_o·cos(φ_o − φ_target) in [−1, 1]: the reward.
    pub fn signed_order(&self, target: Target) -> f64 {
        self.psi_o * libm::cos(self.phi_o - target.sign() * FRAC_PI_2)
    }

    /// m = Ψ_o·sin φ_o: ±1 for rotation in order, 0 for a jam.
    pub fn rotation(&self) -> f64 {
        self.psi_o * libm::sin(self.phi_o)
    }

    /// Ψ_o·cos φ_o, the mean of cos φ over the boats: 1 in a jam, near 0 for streams along the pool. Two opposed streams
    /// also give 0 here, and they cancel in m.
    pub fn outward(&self) -> f64 {
        self.psi_o * libm::cos(self.phi_o)
    }
}

/// Sums over vectors.
#[derive(Default)]
struct VectorSum {
    count: f64,
    sum: Vec2,
    squares: f64,
}

impl VectorSum {
    fn add(&mut self, vector: Vec2) {
        self.count += 1.0;
        self.sum += vector;
        self.squares += vector.norm_squared();
    }

    /// Length and angle of the mean vector, and the mean of the dot products of pairs.
    fn mean(&self) -> [f64; 3] {
        let mean = self.sum / self.count;
        // Σ_{i<j} v_i·v_j = (|Σv|² − Σ|v|²)/2; 0/0 for one boat.
        let pairs = (self.sum.norm_squared() - self.squares) / (self.count * (self.count - 1.0));
        [mean.norm(), libm::atan2(mean.y, mean.x), pairs]
    }
}
