//! Small scenes to check laws on, and what is measured of them.

use flockenv::flock::State;
use flockenv::geometry::{Gap, Pose, Vec2, Velocity, cross};
use flockenv::parameters::{Disc, Noise, Pool, Preset, Scheme, Wall};
use flockenv::{Flock, FlockError, FlockParameters};
use proptest::prop_assert;
use proptest::strategy::Strategy;
use proptest::test_runner::TestCaseError;
use proptest::test_runner::{Config as ProptestConfig, RngSeed};
use std::fmt::Debug;

/// All schemes.
pub const SCHEMES: [Scheme; 3] = [Scheme::Leapfrog, Scheme::Moreau, Scheme::Paper];
/// The schemes that solve contacts on velocities.
pub const VELOCITY_SCHEMES: [Scheme; 2] = [Scheme::Leapfrog, Scheme::Moreau];
/// Gaps linearized once, and the tolerances of results to publish and of references.
pub const TOLERANCES: [f64; 3] = [f64::INFINITY, 1e-6, 1e-9];
/// Both meanings of η.
pub const NOISES: [Noise; 2] = [Noise::White, Noise::PerStep];
/// No walls at all.
pub const OPEN_WATER: Pool = disc(f64::INFINITY);

/// Half-length h of the default hull's core, its radius r and its radius of gyration ρ, in cm.
pub const H: f64 = 2.5;
pub const R: f64 = 5.0;
pub const RHO: f64 = 4.74;

/// So many draws of a property test, the same ones every time. PROPTEST_CASES and PROPTEST_RNG_SEED in
/// the environment select more and for others.
pub fn cases(count: u32) -> ProptestConfig {
    let given = ProptestConfig::default();
    ProptestConfig {
        cases: std::env::var("PROPTEST_CASES").map_or(count, |_| given.cases),
        rng_seed: match given.rng_seed {
            RngSeed::Random => RngSeed::Fixed(2011),
            fixed @ RngSeed::Fixed(_) => fixed,
        },
        failure_persistence: None,
        ..given
    }
}

/// A disc of water without an obstacle.
pub const fn disc(outer_radius_cm: f64) -> Pool {
    annulus(outer_radius_cm, 0.0)
}

/// A ring of water between two walls.
pub const fn annulus(outer_radius_cm: f64, inner_radius_cm: f64) -> Pool {
    Pool {
        outer_radius_cm,
        inner_radius_cm,
    }
}

/// Parameters with something changed.
pub fn changed(
    mut parameters: FlockParameters,
    change: impl FnOnce(&mut FlockParameters),
) -> FlockParameters {
    change(&mut parameters);
    parameters
}

/// Table 3 without noise, engines always forward, open water.
pub fn driven(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        pool: OPEN_WATER,
        n_boats: 1,
        c4: 0.0,
        fw_s: 1.0,
        nop1_s: 0.0,
        bw_s: 0.0,
        nop2_s: 0.0,
        scheme,
        ..FlockParameters::preset(Preset::Simulation)
    }
}

/// As [`driven`], but engines always backward.
pub fn backing(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        fw_s: 0.0,
        bw_s: 1.0,
        ..driven(scheme)
    }
}

/// No forces but those of contacts, which are linear in the motion, open water.
pub fn inert(scheme: Scheme) -> FlockParameters {
    FlockParameters {
        speed_cm_s: 0.0,
        reverse_speed_cm_s: 0.0,
        c0: 0.0,
        c1: 0.0,
        c2: 0.0,
        c3: 0.0,
        overlap_tolerance_cm: 0.0,
        tolerance_cm: f64::INFINITY,
        ..driven(scheme)
    }
}

/// A crowded scene with leaders, noise and contacts; phases switch off the grid of dt.
pub fn busy(scheme: Scheme, noise: Noise) -> FlockParameters {
    FlockParameters {
        n_boats: 27,
        n_leaders: 3,
        pool: Pool::NARROW,
        scheme,
        noise_scheme: noise,
        fw_s: 0.713,
        nop1_s: 0.2,
        bw_s: 0.305,
        nop2_s: 0.1,
        ..FlockParameters::preset(Preset::Simulation)
    }
}

/// A flock of boats with these poses [cm, cm, rad] and velocities [cm/s, cm/s, rad/s].
pub fn flock_of(p: &FlockParameters, states: &[([f64; 3], [f64; 3])]) -> Flock {
    seeded_flock_of(p, states, 1)
}

/// The same with a seed for all that is drawn.
pub fn seeded_flock_of(p: &FlockParameters, states: &[([f64; 3], [f64; 3])], seed: u64) -> Flock {
    let p = changed(p.clone(), |p| p.n_boats = states.len());
    let mut flock = Flock::new(p, seed).expect("the pool holds the flock");
    let (poses, velocities) = poses_and_velocities(states);
    flock
        .set_state(&poses, &velocities, 0.0, false)
        .expect("a state without overlap");
    flock
}

/// A flock in any state, overlapping or not, also where random placement finds no room.
pub fn crowded(p: &FlockParameters, states: &[([f64; 3], [f64; 3])]) -> Flock {
    let p = changed(p.clone(), |p| p.n_boats = states.len());
    let (poses, velocities) = poses_and_velocities(states);
    let state = State {
        poses,
        velocities,
        time_s: 0.0,
        allow_overlap: true,
    };
    Flock::from_state(p, 1, &state).expect("a finite state")
}

fn poses_and_velocities(states: &[([f64; 3], [f64; 3])]) -> (Vec<Pose>, Vec<Velocity>) {
    let state = |([x, y, a], [u, v, w]): &([f64; 3], [f64; 3])| {
        (Pose::new(*x, *y, *a), Velocity::new(*u, *v, *w))
    };
    states.iter().map(state).unzip()
}

/// A flock placed at random in which each boat has a velocity of its own.
pub fn set_off(
    p: FlockParameters,
    seed: u64,
    velocity: impl Fn(usize, &Pose) -> Velocity,
) -> Flock {
    let mut flock = Flock::new(p, seed).expect("the pool holds the flock");
    let poses = flock.poses().to_vec();
    let boats = poses.iter().enumerate();
    let velocities: Vec<_> = boats.map(|(boat, pose)| velocity(boat, pose)).collect();
    flock
        .set_state(&poses, &velocities, 0.0, false)
        .expect("as placed");
    flock
}

/// Takes `count` full substeps.
pub fn take_substeps(flock: &mut Flock, count: usize) {
    let dt = flock.parameters().dt_s;
    flock
        .advance(dt * count as f64, None)
        .expect("finite motion");
}

/// ½·Σ(|v|² + ρ²ω²).
pub fn kinetic_energy(flock: &Flock) -> f64 {
    let rho = flock.parameters().gyration_radius_cm;
    0.5 * flock
        .velocities()
        .iter()
        .map(|v| v.linear.norm_squared() + (rho * v.angular).powi(2))
        .sum::<f64>()
}

/// Σv.
pub fn momentum(flock: &Flock) -> Vec2 {
    flock.velocities().iter().map(|v| v.linear).sum()
}

/// Σ(x × v + ρ²ω), about the origin.
pub fn angular_momentum(flock: &Flock) -> f64 {
    let rho = flock.parameters().gyration_radius_cm;
    flock
        .poses()
        .iter()
        .zip(flock.velocities())
        .map(|(p, v)| cross(p.position, v.linear) + rho * rho * v.angular)
        .sum()
}

/// The largest difference of two sets of poses, headings weighted with ρ, in cm.
pub fn farthest_apart(a: &[Pose], b: &[Pose]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| {
            (a.position - b.position)
                .norm()
                .max(RHO * (a.heading - b.heading).abs())
        })
        .fold(0.0, f64::max)
}

/// The bits of all poses and velocities: equal only if every number is.
pub fn bits(flock: &Flock) -> Vec<u64> {
    let poses = flock
        .poses()
        .iter()
        .flat_map(|p| [p.position.x, p.position.y, p.heading]);
    let velocities = flock
        .velocities()
        .iter()
        .flat_map(|v| [v.linear.x, v.linear.y, v.angular]);
    poses.chain(velocities).map(f64::to_bits).collect()
}

/// The ends of a core segment, stern first.
pub fn core(pose: &Pose, half_length: f64) -> (Vec2, Vec2) {
    let axis = Vec2::new(pose.heading.cos(), pose.heading.sin()) * half_length;
    (pose.position - axis, pose.position + axis)
}

/// Distance between two core segments, straight from the definition: zero if they cross, else the
/// least of the four distances from an end to the other segment.
pub fn core_distance(a: &Pose, b: &Pose, half_length: f64) -> f64 {
    segment_distance(core(a, half_length), core(b, half_length))
}

/// Distance between two segments, given by their ends.
pub fn segment_distance((a0, a1): (Vec2, Vec2), (b0, b1): (Vec2, Vec2)) -> f64 {
    let side = |p: Vec2, q: Vec2, x: Vec2| cross(q - p, x - p);
    let crosses =
        side(a0, a1, b0) * side(a0, a1, b1) < 0.0 && side(b0, b1, a0) * side(b0, b1, a1) < 0.0;
    if crosses {
        return 0.0;
    }
    let to_segment = |x: Vec2, p: Vec2, q: Vec2| {
        let along = q - p;
        let length = along.norm_squared();
        let t = if length > 0.0 {
            ((x - p).dot(&along) / length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (x - p - along * t).norm()
    };
    to_segment(a0, b0, b1)
        .min(to_segment(a1, b0, b1))
        .min(to_segment(b0, a0, a1))
        .min(to_segment(b1, a0, a1))
}

/// The deepest overlap of a flock's hulls with each other and with the walls, in cm; 0 for none.
pub fn deepest_overlap(flock: &Flock) -> f64 {
    let p = flock.parameters();
    let (h, r) = (p.half_length_cm(), p.boat_radius_cm);
    let center = |pose: &Pose| Pose::new(0.0, 0.0, pose.heading);
    let mut least = f64::INFINITY;
    for (i, a) in flock.poses().iter().enumerate() {
        for b in &flock.poses()[..i] {
            if (a.position - b.position).norm() < 2.0 * (h + r) {
                least = least.min(core_distance(a, b, h) - 2.0 * r);
            }
        }
        let axis = Vec2::new(a.heading.cos(), a.heading.sin()) * h;
        for end in [a.position - axis, a.position + axis] {
            least = least.min(p.pool.outer_radius_cm - r - end.norm());
        }
        if p.pool.has_inner_wall() {
            // A point is a core of half-length 0; the hull is moved so that the obstacle is at 0.
            let point = Pose::new(-a.position.x, -a.position.y, 0.0);
            let t = point.position.dot(&axis) / (h * h).max(f64::MIN_POSITIVE);
            let nearest = center(a).position + axis * t.clamp(-1.0, 1.0);
            least = least.min((point.position - nearest).norm() - r - p.pool.inner_radius_cm);
        }
        for disc in &p.discs {
            let center = Vec2::new(disc.x_cm, disc.y_cm);
            let distance = segment_distance(core(a, h), (center, center));
            least = least.min(distance - r - disc.radius_cm);
        }
        for wall in &p.walls {
            least = least.min(segment_distance(core(a, h), wall_ends(wall)) - r);
        }
    }
    (-least).max(0.0)
}

/// The two ends of a wall.
pub fn wall_ends(wall: &Wall) -> (Vec2, Vec2) {
    (
        Vec2::new(wall.x0_cm, wall.y0_cm),
        Vec2::new(wall.x1_cm, wall.y1_cm),
    )
}

/// A wall from one point to another.
pub fn wall((x0_cm, y0_cm): (f64, f64), (x1_cm, y1_cm): (f64, f64)) -> Wall {
    Wall {
        x0_cm,
        y0_cm,
        x1_cm,
        y1_cm,
    }
}

/// A disc about a point.
pub fn disc_at(x_cm: f64, y_cm: f64, radius_cm: f64) -> Disc {
    Disc {
        x_cm,
        y_cm,
        radius_cm,
    }
}

/// A pose at most so far from the center in x and y, and turned by at most so much.
pub fn pose(reach_cm: f64, turn: f64) -> impl Strategy<Value = Pose> {
    let place = || -reach_cm..reach_cm;
    (place(), place(), -turn..turn).prop_map(|(x, y, a)| Pose::new(x, y, a))
}

/// A pose moved by a step in x (0), in y (1) or in its heading (2).
pub fn displaced(pose: &Pose, direction: usize, step: f64) -> Pose {
    let mut numbers = [pose.position.x, pose.position.y, pose.heading];
    numbers[direction] += step;
    Pose::new(numbers[0], numbers[1], numbers[2])
}

/// Whether two numbers of order 1 to 100 are equal but for rounding.
pub fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

/// Fails unless a number is as near to the expected one as it should be.
#[track_caller]
pub fn assert_near(found: f64, expected: f64, tolerance: f64, what: impl Debug) {
    let error = (found - expected).abs();
    assert!(error < tolerance, "{what:?}: {found}, not {expected}");
}

/// Fails unless a velocity [cm/s, cm/s, rad/s] is the expected one, but for the rounding of poses that touch:
/// about 1e-14 cm, over dt = 0.02 s.
#[track_caller]
pub fn assert_velocity(found: &Velocity, expected: [f64; 3], what: impl Debug) {
    let found = [found.linear.x, found.linear.y, found.angular];
    let worst = (0..3)
        .map(|i| (found[i] - expected[i]).abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-11, "{what:?}: {found:?}, not {expected:?}");
}

/// Fails unless all contact problems so far were solved exactly.
#[track_caller]
pub fn assert_solved(flock: &Flock) {
    let statistics = flock.statistics();
    assert!(statistics.worst_residual_cm_s <= 1e-10, "{statistics:?}");
    assert_eq!(statistics.unsolved, 0, "{statistics:?}");
}

/// The time that velocities belong to: leapfrog has them half a substep earlier.
pub fn time_of_velocities(scheme: Scheme, time_s: f64, dt_s: f64) -> f64 {
    match scheme {
        Scheme::Leapfrog => time_s - 0.5 * dt_s,
        Scheme::Moreau | Scheme::Paper => time_s,
    }
}

/// How long the kick of a run's first substep lasts: until the time that its velocities belong to.
pub fn first_kick_s(scheme: Scheme, dt_s: f64) -> f64 {
    time_of_velocities(scheme, dt_s, dt_s)
}

/// The name of the field that a refusal names.
pub fn refused_field<T: Debug>(result: Result<T, FlockError>) -> &'static str {
    match result {
        Err(FlockError::Parameter { field, .. } | FlockError::Shape { field, .. }) => field,
        other => panic!("accepted or another error: {other:?}"),
    }
}

/// The parameters of Table 3, with leapfrog and white noise.
pub fn table_3() -> FlockParameters {
    FlockParameters::preset(Preset::Simulation)
}

/// Velocities of up to 20 cm/s in each direction and 5 rad/s.
pub fn velocity() -> impl Strategy<Value = Velocity> {
    let linear = || -20.0..20.0_f64;
    (linear(), linear(), -5.0..5.0_f64).prop_map(|(x, y, turn)| Velocity::new(x, y, turn))
}

/// Checks that the second derivative of a gap, given after a time in s, is the stated one. Where the touch passes an end,
/// it has none.
pub fn same_curve(at: impl Fn(f64) -> Gap, stated: f64) -> Result<(), TestCaseError> {
    let step = 3e-4;
    let [behind, gap, ahead] = [-step, 0.0, step].map(at);
    let ends = |gap: &Gap| [gap.along, gap.along_j].map(|along| along.abs() < H);
    if ends(&behind) != ends(&gap) || ends(&ahead) != ends(&gap) {
        return Ok(());
    }
    let measured = (ahead.gap - 2.0 * gap.gap + behind.gap) / (step * step);
    let allowed = 1e-3 * (100.0 + stated.abs());
    prop_assert!(
        (measured - stated).abs() < allowed,
        "{measured} {stated} {gap:?}"
    );
    Ok(())
}
