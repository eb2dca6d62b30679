//! Every constant of Tables 1 and 3, declared once: name, type, default, unit, range, source and meaning. The struct,
//! its check, the bindings and the documentation follow from this table.

use super::field::{Range, declare_fields};
use super::{Disc, Noise, Pool, Scheme, Solver, Target, Targets, Value, Wall, obstacles};
use crate::error::{FlockError, Result};

declare_fields! {
    /// Everything that defines a flock, by default the preset `simulation`. Fields are public, to read and to
    /// construct; [`FlockParameters::check`] runs once whenever a flock is made from them.
    pub struct FlockParameters;

    /// Number of boats, leaders included (Table 3: n).
    n_boats: usize = 20, "", Range::Within(1.0, Self::MOST_BOATS as f64, "1 to 100000"), "Table 3 (20 to 50)";
    /// Number of steerable leaders, boats 0..k-1 (Table 3: k).
    n_leaders: usize = 0, "", Range::Dependent("0 to n_boats"), "Table 3 (0 or 0.2 n)";
    /// The water: "wide" (radii 180 and 97 cm, the free space of Section 2.2), "narrow" (90 and 48.5 cm, Table 1
    /// as printed) or (outer_radius_cm, inner_radius_cm); inner 0: no obstacle, outer infinite: open water.
    pool: Pool = Pool::WIDE, "cm", Range::Dependent("0 <= inner < outer"), "Section 2.2 (room for 500 boats)";
    /// Radius of the hull's end discs (Table 3: r).
    boat_radius_cm: f64 = 5.0, "cm", Range::Positive, "Table 3";
    /// Half-length of the hull's core segment over its radius (Table 3: p).
    boat_shape: f64 = 0.5, "", Range::NonNegative, "Table 3";
    /// Radius of gyration (Table 3: ρ; the exact stadium has 4.690 cm); scaled with the hull unless it is
    /// given.
    gyration_radius_cm: f64 = 4.74, "cm", Range::Positive, "Table 3";
    /// Preferred forward speed (Table 3: v0 in fw).
    speed_cm_s: f64 = 15.0, "cm/s", Range::NonNegative, "Table 3";
    /// Preferred backward speed, positive (Table 3: -v0 in bw).
    reverse_speed_cm_s: f64 = 15.0, "cm/s", Range::NonNegative, "Table 3";
    /// Convergence rate of the velocity (eq. 8).
    c0: f64 = 1.0, "1/s", Range::NonNegative, "Table 3";
    /// Cubic damping of the angular velocity (eq. 9).
    c1: f64 = 1.0, "s", Range::NonNegative, "Table 3";
    /// Gain of the rudder (eq. 9).
    c2: f64 = 0.1, "1/(cm·s)", Range::NonNegative, "Table 3";
    /// Weathervane stabilization of forward motion (eq. 9).
    c3: f64 = 1.0, "1/cm", Range::NonNegative, "Table 3";
    /// Strength of the angular noise (eq. 9): in rad/s^1.5 if the noise is "white", in rad/s² if it is "per-step".
    c4: f64 = 0.1, "rad/s^1.5 or rad/s²", Range::NonNegative, "Table 3";
    /// Duration of the forward phase (Section 2.1).
    fw_s: f64 = 2.0, "s", Range::NonNegative, "Table 1";
    /// Duration of the drift after the forward phase.
    nop1_s: f64 = 1.0, "s", Range::NonNegative, "Table 1";
    /// Duration of the backward phase: the source of disorder.
    bw_s: f64 = 0.3, "s", Range::NonNegative, "near the critical noise";
    /// Duration of the drift after the backward phase.
    nop2_s: f64 = 1.0, "s", Range::NonNegative, "Table 1";
    /// Whether leaders back up in the bw phase (in the experiment their motor ran in fw only).
    leaders_reverse: bool = true, "", Range::Any, "eq. (8), the same for all";
    /// Direction that eq. (10) steers leaders to: "cw" (LAP orientation +π/2) or "ccw" (-π/2), or a list with one per
    /// leader. Of a list, leader 0's is the reference direction of the flock's signed order.
    target: Targets = Targets::One(Target::Clockwise), "", Range::Any, "chosen";
    /// How a time step is taken: "leapfrog" (second order), "moreau" (first order) or "paper" (the appendix taken
    /// literally).
    scheme: Scheme = Scheme::Leapfrog, "", Range::Any, "chosen";
    /// What η of eq. (9) means: "white" (increment c4·sqrt(dt)·N(0, 1)) or "per-step" (c4·dt·N(0, 1)).
    noise_scheme: Noise = Noise::White, "", Range::Any, "chosen";
    /// How contacts are solved: "block-pivoting" (exact), or for comparison "gauss-seidel" or "clarabel".
    solver: Solver = Solver::BlockPivoting, "", Range::Any, "chosen";
    /// Longest substep, rounded to 1 ns.
    dt_s: f64 = 0.02, "s", Range::Dependent("1e-6 to 1, to 0.1 for the schemes moreau and paper"), "chosen";
    /// Overlap that the paper scheme accepts without a projection.
    overlap_tolerance_cm: f64 = 0.01, "cm", Range::NonNegative, "chosen";
    /// Deepest overlap that a substep may leave. Contacts that leave more are solved again from the gaps at the
    /// substep's end; if that fails, the substep is halved. Infinite: gaps are linearized once. The paper scheme leaves
    /// up to overlap_tolerance_cm.
    tolerance_cm: f64 = 1e-4, "cm", Range::Dependent("1e-10 or more, in a large pool 4e-15 of its outer radius; infinite: off"), "chosen";
    /// Constant rudder of the normal boats, positive turns counter-clockwise (Section 4.5); 0: off.
    turning_bias: f64 = 0.0, "", Range::Within(-1.0, 1.0, "a rudder in [-1, 1]"), "Section 4.5, off";
    /// Half-width of the uniform spread of the boats' forward speeds (Table 1: 5 cm/s); backward speeds scale along;
    /// 0: off.
    speed_spread_cm_s: f64 = 0.0, "cm/s", Range::Dependent("0 to speed_cm_s"), "Section 4.5, off";
    /// κ of the net tangential water current -κ·(mean tangential velocity) (Section 4.5); 0: off.
    current_gain: f64 = 0.0, "", Range::Within(0.0, 1.0, "0 (off) to 1"), "Section 4.5, off";
    /// Cap of that current's speed (Section 4.5).
    current_cap_cm_s: f64 = 5.0, "cm/s", Range::Positive, "Section 4.5 (3 to 5)";
    /// Discs that stand in the water, one row (x_cm, y_cm, radius_cm) per disc; none: off. They may reach over the
    /// pool's walls and overlap each other.
    discs: Vec<Disc> = Vec::new(), "cm", Range::Dependent("up to 1000 rows (x_cm, y_cm, radius_cm) with a part in the water"), "chosen, off";
    /// Straight walls without thickness in the water, one row (x0_cm, y0_cm, x1_cm, y1_cm) per wall with its two ends;
    /// none: off. They may reach over the pool's walls and cross each other.
    walls: Vec<Wall> = Vec::new(), "cm", Range::Dependent("up to 1000 rows (x0_cm, y0_cm, x1_cm, y1_cm) with a part in the water"), "chosen, off";
    /// Leaders' preferred speeds as a multiple of the normal boats' (Section 2.6: "similar"). The strength of their
    /// rudder is c2.
    leader_speed_factor: f64 = 1.0, "", Range::Within(0.0, 10.0, "0 to 10"), "Section 2.6 (similar speed and power)";
    /// Time constant with which the water current, from rest, exponentially approaches the current that `current_gain`
    /// sets; 0: it follows at once.
    current_relaxation_s: f64 = 0.0, "s", Range::NonNegative, "Section 4.5, off";
}

impl FlockParameters {
    /// The most boats a flock may have: placing them takes some ten seconds.
    pub const MOST_BOATS: usize = 100_000;

    /// The least overlap in cm that contacts can be solved to.
    const SMALLEST_TOLERANCE_CM: f64 = 1e-10;

    /// The values in the order of [`Self::FIELDS`].
    pub fn values(&self) -> Vec<Value> {
        let fields = Self::FIELDS.iter();
        fields.map(|field| (field.get)(self)).collect()
    }

    /// Half-length of the hull's core segment, h = p·r, in cm.
    pub fn half_length_cm(&self) -> f64 {
        self.boat_shape * self.boat_radius_cm
    }

    /// Deepest overlap in cm that a substep may leave: by `tolerance_cm`, and in the paper's scheme also by its own
    /// tolerance.
    pub fn allowed_overlap_cm(&self) -> f64 {
        if self.scheme == Scheme::Paper {
            self.tolerance_cm.max(self.overlap_tolerance_cm)
        } else {
            self.tolerance_cm
        }
    }

    /// Whether other parameters have the same pool and the same obstacles.
    pub(crate) fn has_same_water(&self, other: &Self) -> bool {
        (self.pool, &self.discs, &self.walls) == (other.pool, &other.discs, &other.walls)
    }

    /// Name of an obstacle in messages: the discs are numbered first, then the walls.
    pub(crate) fn obstacle_name(&self, number: usize) -> String {
        match number.checked_sub(self.discs.len()) {
            None => format!("disc {number}"),
            Some(wall) => format!("wall {wall}"),
        }
    }

    /// Checks every field; all parameters of a flock pass this check.
    ///
    /// # Errors
    /// [`FlockError::Parameter`] names a field that is out of range.
    pub fn check(&self) -> Result<()> {
        Self::FIELDS
            .iter()
            .try_for_each(|field| field.check(self))?;
        self.check_leaders()?;
        self.check_pool()?;
        obstacles::check(&self.discs, self.pool)?;
        obstacles::check(&self.walls, self.pool)?;
        self.check_spread()?;
        self.check_tolerance()?;
        self.check_timing()
    }

    /// Refuses a tolerance that overlaps cannot reach: coordinates are rounded, and contacts are solved to 1e-10 cm/s.
    fn check_tolerance(&self) -> Result<()> {
        let outer = self.pool.outer_radius_cm;
        let largest_coordinate = if outer.is_finite() { outer } else { 0.0 };
        let rounding = 16.0 * f64::EPSILON * largest_coordinate;
        let reachable = Self::SMALLEST_TOLERANCE_CM.max(rounding);
        let accepted = format!(
            "{reachable:e} cm or more, which double precision holds in this pool, or infinity: gaps are linearized once"
        );
        let is_reachable = self.tolerance_cm >= reachable;
        FlockError::unless(is_reachable, "tolerance_cm", self.tolerance_cm, accepted)
    }

    fn check_leaders(&self) -> Result<()> {
        let accepted = format!("0 to n_boats = {}", self.n_boats);
        let are_boats = self.n_leaders <= self.n_boats;
        FlockError::unless(are_boats, "n_leaders", self.n_leaders, accepted)?;
        self.target.check(self.n_leaders)
    }

    fn check_pool(&self) -> Result<()> {
        let (outer, inner) = (self.pool.outer_radius_cm, self.pool.inner_radius_cm);
        let is_pool = (0.0..=Range::LARGE).contains(&inner)
            && outer > inner
            && (outer <= Range::LARGE || outer == f64::INFINITY);
        let accepted = "(outer_radius_cm, inner_radius_cm) with 0 <= inner < outer; an infinite outer radius is open \
                        water";
        FlockError::unless(is_pool, "pool", format!("({outer}, {inner})"), accepted)
    }

    fn check_spread(&self) -> Result<()> {
        let spread = self.speed_spread_cm_s;
        let accepted = format!("0 to speed_cm_s = {}", self.speed_cm_s);
        let is_spread = (0.0..=self.speed_cm_s).contains(&spread);
        FlockError::unless(is_spread, "speed_spread_cm_s", spread, accepted)
    }

    fn check_timing(&self) -> Result<()> {
        let cycle_s = self.fw_s + self.nop1_s + self.bw_s + self.nop2_s;
        let accepted = "a cycle of at least 1e-6 s (a single phase may last 0 s)";
        let cycle = "fw_s + nop1_s + bw_s + nop2_s";
        FlockError::unless(cycle_s >= 1e-6, cycle, cycle_s, accepted)?;
        let (longest, scheme) = (self.scheme.longest_dt_s(), self.scheme.name());
        let accepted = format!("1e-6 to {longest} s, the stable range of scheme {scheme:?}");
        let is_stable = (1e-6..=longest).contains(&self.dt_s);
        FlockError::unless(is_stable, "dt_s", self.dt_s, accepted)
    }
}
