//! Solutions of the equations of motion by other means: Runge–Kutta, and roots by bisection.

use flockenv::FlockParameters;

/// Classical Runge–Kutta of order 4 over `steps` steps; `rate(state, time)`.
pub fn runge_kutta<const N: usize>(
    start: [f64; N],
    (from, to): (f64, f64),
    steps: usize,
    rate: impl Fn(&[f64; N], f64) -> [f64; N],
) -> [f64; N] {
    let dt = (to - from) / steps as f64;
    let shifted = |y: &[f64; N], k: &[f64; N], f: f64| std::array::from_fn(|i| y[i] + f * k[i]);
    (0..steps).fold(start, |y, step| {
        let t = from + step as f64 * dt;
        let k1 = rate(&y, t);
        let k2 = rate(&shifted(&y, &k1, 0.5 * dt), t + 0.5 * dt);
        let k3 = rate(&shifted(&y, &k2, 0.5 * dt), t + 0.5 * dt);
        let k4 = rate(&shifted(&y, &k3, dt), t + dt);
        std::array::from_fn(|i| y[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    })
}

/// Eqs (8) and (9) of a lone boat with a preferred speed and a rudder, in the current that it makes itself: d/dt of
/// [x, y, α, ẋ, ẏ, α̇].
pub fn equations_of_motion(p: &FlockParameters, speed: f64, rudder: f64, y: &[f64; 6]) -> [f64; 6] {
    let [px, py, heading, vx, vy, spin] = *y;
    let far = px.hypot(py);
    let (tx, ty) = (-py / far, px / far);
    let current = -p.current_gain * (vx * tx + vy * ty);
    let current = current.clamp(-p.current_cap_cm_s, p.current_cap_cm_s);
    let (rx, ry) = (vx - current * tx, vy - current * ty);
    let (sin, cos) = heading.sin_cos();
    let along = cos * rx + sin * ry;
    let turning = -p.c1 * spin.powi(3) + (p.c2 * rudder - p.c3 * spin) * along;
    let accelerations = [speed * cos - rx, speed * sin - ry].map(|lag| p.c0 * lag);
    [vx, vy, spin, accelerations[0], accelerations[1], turning]
}

/// The root of a function that changes sign in an interval, by bisection to rounding.
pub fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(high) > 0.0;
    assert!(f(low) * f(high) <= 0.0, "no sign change");
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == rising {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}
