//! Law: every eye tells the colors apart, and a page has the palette for light ground and for dark.

use flockenv::draw::palette::{
    CLOCKWISE, COUNTER_CLOCKWISE, PALETTE, RADIAL, Rgb, Swatch, style_sheet, tint,
};
use flockenv::geometry::Pose;

/// Machado, Oliveira and Fernandes (2009), full severity, on linear RGB: protanopia, deuteranopia, tritanopia.
const EYES: [[[f64; 3]; 3]; 4] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [
        [0.152_286, 1.052_583, -0.204_868],
        [0.114_503, 0.786_281, 0.099_216],
        [-0.003_882, -0.048_116, 1.051_998],
    ],
    [
        [0.367_322, 0.860_646, -0.227_968],
        [0.280_085, 0.672_501, 0.047_413],
        [-0.011_820, 0.042_940, 0.968_881],
    ],
    [
        [1.255_528, -0.076_749, -0.178_779],
        [-0.078_411, 0.930_809, 0.147_602],
        [0.004_733, 0.691_367, 0.303_900],
    ],
];

fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
}

/// A part of an sRGB color on a linear scale.
fn linear(part: u8) -> f64 {
    let share = f64::from(part) / 255.0;
    if share <= 0.04045 {
        share / 12.92
    } else {
        libm::pow((share + 0.055) / 1.055, 2.4)
    }
}

/// CIE 1976 L*a*b* of a color as an eye sees it.
fn lab(Rgb(r, g, b): Rgb, eye: [[f64; 3]; 3]) -> [f64; 3] {
    let seen = times(eye, [r, g, b].map(linear)).map(|each| each.clamp(0.0, 1.0));
    let [x, y, z] = times(
        [
            [0.4124, 0.3576, 0.1805],
            [0.2126, 0.7152, 0.0722],
            [0.0193, 0.1192, 0.9505],
        ],
        seen,
    );
    let f = |t: f64| {
        if t > 0.008_856 {
            libm::cbrt(t)
        } else {
            7.787 * t + 16.0 / 116.0
        }
    };
    let [x, y, z] = [f(x / 0.9505), f(y), f(z / 1.089)];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn named(name: &str) -> Swatch {
    *PALETTE.iter().find(|each| each.name == name).unwrap()
}

fn assert_apart(names: &[&str]) {
    let swatches: Vec<Swatch> = names.iter().map(|name| named(name)).collect();
    for eye in EYES {
        for of in [|each: Swatch| each.light, |each: Swatch| each.dark] {
            let seen: Vec<_> = swatches.iter().map(|&each| lab(of(each), eye)).collect();
            for (k, one) in seen.iter().enumerate() {
                for other in &seen[..k] {
                    let squares = one.iter().zip(other).map(|(a, b)| (a - b) * (a - b));
                    let distance = squares.sum::<f64>().sqrt();
                    assert!(distance > 17.0, "{distance} with {eye:?}");
                }
            }
        }
    }
}

#[test]
fn every_eye_tells_directions_and_rings_apart() {
    assert_apart(&[
        "clockwise",
        "counter-clockwise",
        "radial",
        "leader",
        "opponent",
    ]);
}

#[test]
fn every_eye_tells_policies_and_other_runs_apart() {
    assert_apart(&[
        "paper-law",
        "damped-law",
        "tuned-law",
        "learned",
        "run-1",
        "run-2",
    ]);
}

/// Relative luminance as WCAG 2 defines it.
fn luminance(Rgb(r, g, b): Rgb) -> f64 {
    let [r, g, b] = [r, g, b].map(linear);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[test]
fn boats_and_rings_stand_out_from_dark_water() {
    let water = luminance(named("water").dark);
    for name in [
        "clockwise",
        "counter-clockwise",
        "radial",
        "leader",
        "opponent",
        "force",
    ] {
        let contrast = (luminance(named(name).dark) + 0.05) / (water + 0.05);
        assert!(contrast >= 3.0, "{name}: {contrast}");
    }
}

#[test]
fn a_tint_is_that_of_the_heading_in_the_local_frame() {
    // East of the center: south is clockwise, east outward.
    let at = |degrees: f64| tint(&Pose::new(70.0, 0.0, degrees.to_radians()));
    assert_eq!([-90.0, -31.0, -149.0].map(at), [CLOCKWISE; 3]);
    assert_eq!([90.0, 31.0, 149.0].map(at), [COUNTER_CLOCKWISE; 3]);
    assert_eq!([0.0, 29.0, -29.0, 180.0].map(at), [RADIAL; 4]);
}

#[test]
fn a_style_sheet_has_every_color_twice() {
    let sheet = style_sheet();
    for each in PALETTE {
        assert_eq!(sheet.matches(&format!("--{}:#", each.name)).count(), 2);
    }
    assert!(sheet.contains("--clockwise:#0072b2;") && sheet.contains("--clockwise:#3d9bd6;"));
}
