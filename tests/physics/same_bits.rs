//! The same seed gives the same bits on every machine: no function of its own mathematical library, no width of
//! its registers or pointers has a part in them.
//!
//! On paper: nothing. The numbers are those of an x86-64 machine, and of WebAssembly in Node.

use crate::support::busy;
use flockenv::parameters::{FlockParameters, Noise, Pool, Preset, Scheme};
use flockenv::{Flock, Result};

/// A hash (FNV-1a) of numbers.
fn fnv(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let bytes = numbers
        .into_iter()
        .flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    })
}

/// The poses and velocities of all boats.
fn numbers(flock: &Flock) -> impl Iterator<Item = f64> {
    let boats = flock.poses().iter().zip(flock.velocities());
    boats.flat_map(|(pose, velocity)| {
        let (x, v) = (pose.position, velocity.linear);
        [x.x, x.y, pose.heading, v.x, v.y, velocity.angular]
    })
}

/// A hash of the poses, velocities and order parameters of 27 boats with three leaders, which follow the
/// paper's law, after so many seconds.
fn hash(pool: Pool, bw_s: f64, noise: Noise, seconds: u32) -> Result<u64> {
    let mut flock = Flock::new(
        FlockParameters {
            n_boats: 27,
            n_leaders: 3,
            pool,
            bw_s,
            noise_scheme: noise,
            ..FlockParameters::preset(Preset::Simulation)
        },
        7,
    )?;
    flock.advance(f64::from(seconds), None)?;
    let order = flock.order_parameters(false)?;
    let order = [
        order.psi_o,
        order.phi_o,
        order.c_o,
        order.psi_v,
        order.phi_v,
        order.c_v,
    ];
    Ok(fnv(numbers(&flock).chain(order)))
}

#[test]
fn a_minute_and_ten_minutes_end_in_the_same_bits_on_every_machine() {
    let (wide, narrow) = ((Pool::WIDE, 0.31), (Pool::NARROW, 0.45));
    for ((pool, bw_s), noise, after_60_s, after_600_s) in [
        (
            wide,
            Noise::White,
            0x65dc_4632_95f3_f648,
            0xad64_6e2a_db47_0185,
        ),
        (
            wide,
            Noise::PerStep,
            0x1e37_b8ff_d6fe_682d,
            0x047e_eeea_d758_adfb,
        ),
        (
            narrow,
            Noise::White,
            0x797f_9f9e_1c76_e474,
            0x7849_4211_ef2e_1a39,
        ),
        (
            narrow,
            Noise::PerStep,
            0xb33f_83d1_22f3_4d3f,
            0x438c_2d63_92f4_8b2a,
        ),
    ] {
        let found =
            [60, 600].map(|seconds| hash(pool, bw_s, noise, seconds).expect("finite motion"));
        assert_eq!(found, [after_60_s, after_600_s], "{noise:?}: {found:#x?}");
    }
}

#[test]
fn a_stated_error_has_the_same_bits_on_every_machine() {
    let found = [Scheme::Leapfrog, Scheme::Moreau].map(|scheme| {
        let mut flock = Flock::new(busy(scheme, Noise::White), 7).expect("room");
        flock.advance(20.0, None).expect("finite motion");
        flock.set_step(0.0071).expect("in range");
        let stated = flock.advance_with_error(0.5, None).expect("finite motion");
        assert!(stated > 0.0);
        fnv(numbers(&flock).chain([stated]))
    });
    let expected = [0xf986_a072_6762_4fea, 0xe0c8_35e7_029f_80a1];
    assert_eq!(found, expected, "{found:#x?}");
}
