//! Every constant of Tables 1 and 3, and one check on construction.

use super::{Noise, Pool, Scheme, Solver, Target};
use crate::error::{FlockError, Result};

/// Everything that defines a flock. Fields are public to read and to build with;
/// [`FlockParameters::check`] runs once wherever a flock is made from them.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FlockParameters {
    /// Number of boats, leaders included (Table 3: n).
    pub n_boats: usize,
    /// Number of steerable leaders, boats 0..k−1 (Table 3: k).
    pub n_leaders: usize,
    /// The water.
    pub pool: Pool,
    /// Radius of the hull's end discs in cm (Table 3: r).
    pub boat_radius_cm: f64,
    /// Half-length of the hull's core segment over its radius (Table 3: p).
    pub boat_shape: f64,
    /// Radius of gyration in cm (Table 3: ρ; the exact stadium has 4.690).
    pub gyration_radius_cm: f64,
    /// Preferred forward speed in cm/s (Table 3: v0 in fw).
    pub speed_cm_s: f64,
    /// Preferred backward speed in cm/s, positive (Table 3: −v0 in bw).
    pub reverse_speed_cm_s: f64,
    /// Convergence rate of the velocity in 1/s (eq. 8).
    pub c0: f64,
    /// Cubic damping of the angular velocity in s (eq. 9).
    pub c1: f64,
    /// Gain of the rudder in 1/(cm·s) (eq. 9).
    pub c2: f64,
    /// Weathervane stabilization of forward motion in 1/cm (eq. 9).
    pub c3: f64,
    /// Strength of the angular noise, in rad/s^1.5 (`white`) or rad/s² (`per-step`) (eq. 9).
    pub c4: f64,
    /// Duration of the forward phase in s.
    pub fw_s: f64,
    /// Duration of the drift after the forward phase in s.
    pub nop1_s: f64,
    /// Duration of the backward phase in s: the source of disorder.
    pub bw_s: f64,
    /// Duration of the drift after the backward phase in s.
    pub nop2_s: f64,
    /// Whether leaders back up in the bw phase (in the experiment their motor ran in fw only).
    pub leaders_reverse: bool,
    /// The direction that eq. (10) steers leaders to.
    pub target: Target,
    /// How a time step is taken.
    pub scheme: Scheme,
    /// What η of eq. (9) means.
    pub noise: Noise,
    /// How contacts are solved.
    pub solver: Solver,
    /// Longest substep in s (rounded to 1 ns).
    pub dt_s: f64,
    /// Overlap that the `paper` scheme accepts without a projection, in cm.
    pub overlap_tolerance_cm: f64,
    /// How well gaps hold at the end of a substep, where they are curved functions of the motion:
    /// 0 linearized once (overlaps ≤ 1e-2 cm at dt = 0.01 s); 1 and 2 re-evaluate and solve again, with
    /// the same factor, until overlaps are ≤ 1e-6 and ≤ 1e-9 cm.
    pub relinearizations: usize,
    /// Constant rudder of the normal boats, in [−1, 1]; positive turns counter-clockwise
    /// (Section 4.5's bias). 0: off.
    pub turning_bias: f64,
    /// Half-width of the uniform per-boat spread of the forward speed in cm/s (Table 1: ±5); the
    /// backward speed scales along. 0: off.
    pub speed_spread_cm_s: f64,
    /// κ of the net tangential water current −κ·(mean tangential velocity) (Section 4.5). 0: off.
    pub current_gain: f64,
    /// Cap of that current's speed in cm/s.
    pub current_cap_cm_s: f64,
}

impl FlockParameters {
    /// The most boats a flock may have: placing them takes some ten seconds.
    pub const MOST_BOATS: usize = 100_000;

    /// Half-length of the hull's core segment, h = p·r, in cm.
    pub fn half_length_cm(&self) -> f64 {
        self.boat_shape * self.boat_radius_cm
    }

    /// Checks every field; the one gate through which parameters enter a flock.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] names the first field that is out of range.
    pub fn check(&self) -> Result<()> {
        self.check_counts()?;
        self.check_pool()?;
        for (field, value) in [
            ("boat_radius_cm", self.boat_radius_cm),
            ("gyration_radius_cm", self.gyration_radius_cm),
            ("current_cap_cm_s", self.current_cap_cm_s),
        ] {
            check_range(
                field,
                value,
                f64::MIN_POSITIVE,
                LARGE,
                "a positive length or speed",
            )?;
        }
        for (field, value) in [
            ("boat_shape", self.boat_shape),
            ("speed_cm_s", self.speed_cm_s),
            ("reverse_speed_cm_s", self.reverse_speed_cm_s),
            ("c0", self.c0),
            ("c1", self.c1),
            ("c2", self.c2),
            ("c3", self.c3),
            ("c4", self.c4),
            ("fw_s", self.fw_s),
            ("nop1_s", self.nop1_s),
            ("bw_s", self.bw_s),
            ("nop2_s", self.nop2_s),
            ("overlap_tolerance_cm", self.overlap_tolerance_cm),
        ] {
            check_range(
                field,
                value,
                0.0,
                LARGE,
                "a finite number of at least 0, at most 1e6",
            )?;
        }
        self.check_effects()?;
        self.check_timing()
    }

    fn check_counts(&self) -> Result<()> {
        if self.n_boats == 0 || self.n_boats > Self::MOST_BOATS {
            let accepted = format!("1 to {}", Self::MOST_BOATS);
            return Err(FlockError::parameter("n_boats", self.n_boats, accepted));
        }
        if self.n_leaders > self.n_boats {
            let accepted = format!("0 to n_boats = {}", self.n_boats);
            return Err(FlockError::parameter("n_leaders", self.n_leaders, accepted));
        }
        if self.relinearizations > 2 {
            return Err(FlockError::parameter(
                "relinearizations",
                self.relinearizations,
                "0, 1 or 2",
            ));
        }
        Ok(())
    }

    fn check_pool(&self) -> Result<()> {
        let Pool {
            outer_radius_cm: outer,
            inner_radius_cm: inner,
        } = self.pool;
        let ok = (0.0..=LARGE).contains(&inner)
            && outer > inner
            && (outer <= LARGE || outer == f64::INFINITY);
        if ok {
            return Ok(());
        }
        Err(FlockError::parameter(
            "pool",
            format!("({outer}, {inner})"),
            "(outer_radius_cm, inner_radius_cm) with 0 <= inner < outer; an infinite outer radius is open water",
        ))
    }

    fn check_effects(&self) -> Result<()> {
        check_range(
            "turning_bias",
            self.turning_bias,
            -1.0,
            1.0,
            "a rudder in [-1, 1]",
        )?;
        let accepted = format!("0 to speed_cm_s = {}", self.speed_cm_s);
        check_range(
            "speed_spread_cm_s",
            self.speed_spread_cm_s,
            0.0,
            self.speed_cm_s,
            &accepted,
        )?;
        check_range("current_gain", self.current_gain, 0.0, 1.0, "0 (off) to 1")
    }

    fn check_timing(&self) -> Result<()> {
        if self.fw_s + self.nop1_s + self.bw_s + self.nop2_s < 1e-6 {
            return Err(FlockError::parameter(
                "fw_s + nop1_s + bw_s + nop2_s",
                self.fw_s + self.nop1_s + self.bw_s + self.nop2_s,
                "a cycle of at least 1e-6 s (a single phase may last 0 s)",
            ));
        }
        let longest = self.scheme.longest_dt_s();
        let accepted = format!(
            "1e-6 to {longest} s, where scheme {:?} is stable",
            self.scheme.name()
        );
        check_range("dt_s", self.dt_s, 1e-6, longest, &accepted)
    }
}

/// Lengths, speeds and rates beyond this (1e6 cm = 10 km) are taken for a mistake.
const LARGE: f64 = 1e6;

fn check_range(field: &'static str, value: f64, low: f64, high: f64, accepted: &str) -> Result<()> {
    // A NaN fails both comparisons.
    if value >= low && value <= high {
        return Ok(());
    }
    Err(FlockError::parameter(field, value, accepted))
}
