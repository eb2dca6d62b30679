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
            0x4bb9_b34b_4243_cd57,
            0xc9aa_b80b_f643_c3ac,
        ),
        (
            wide,
            Noise::PerStep,
            0xe555_82b3_ec15_3dfc,
            0xf90e_d7e3_3e0a_c01f,
        ),
        (
            narrow,
            Noise::White,
            0x8ccd_1617_0848_6c51,
            0xd6a8_d5bf_07a4_48c5,
        ),
        (
            narrow,
            Noise::PerStep,
            0xf90d_bdfb_f5f3_4a7b,
            0xa080_18ed_3069_c90b,
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
    let expected = [0x7986_8034_62e8_72a1, 0x1545_205f_57c0_c5a5];
    assert_eq!(found, expected, "{found:#x?}");
}
