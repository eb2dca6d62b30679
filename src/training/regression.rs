//! Ridge regression with a fixed order of summation, so that its bits are the same on every machine.

use crate::environment::observation::LEAN_FEATURES;

/// Number of weights: one for each lean feature, then the bias.
pub(super) const SIZE: usize = LEAN_FEATURES + 1;

/// Features, weights, or a row of a matrix.
pub(super) type Features = [f64; SIZE];
pub(super) type Matrix = [Features; SIZE];

/// The scalar product, summed from the first entry to the last.
pub(super) fn dot(a: &Features, b: &Features) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

/// Matrix times vector.
pub(super) fn product(matrix: &Matrix, x: &Features) -> Features {
    std::array::from_fn(|row| dot(&matrix[row], x))
}

/// Adds factor·x xᵀ to a matrix.
pub(super) fn add_square(matrix: &mut Matrix, factor: f64, x: &Features) {
    for (row, a) in matrix.iter_mut().zip(x) {
        for (sum, b) in row.iter_mut().zip(x) {
            *sum += factor * a * b;
        }
    }
}

/// The solution of (A + λ I) x = b for a positive semidefinite A, where λ is `fraction` times the mean of A's diagonal.
///
/// The matrix is factorized by Cholesky's method; forward and backward substitution follow.
pub(super) fn solve_ridge(matrix: &Matrix, fraction: f64, b: &Features) -> Features {
    let trace = (0..SIZE).fold(0.0, |sum, k| sum + matrix[k][k]);
    // The small number keeps λ above 0 if A is 0.
    let lambda = fraction * trace / SIZE as f64 + f64::MIN_POSITIVE.sqrt();
    let mut factor = [[0.0; SIZE]; SIZE];
    for row in 0..SIZE {
        for column in 0..=row {
            let damping = if row == column { lambda } else { 0.0 };
            let remainder = (0..column).fold(matrix[row][column] + damping, |remainder, k| {
                remainder - factor[row][k] * factor[column][k]
            });
            factor[row][column] = if row == column {
                remainder.sqrt()
            } else {
                remainder / factor[column][column]
            };
        }
    }
    let mut x = *b;
    for row in 0..SIZE {
        let remainder = (0..row).fold(x[row], |sum, k| sum - factor[row][k] * x[k]);
        x[row] = remainder / factor[row][row];
    }
    for row in (0..SIZE).rev() {
        let remainder = (row + 1..SIZE).fold(x[row], |sum, k| sum - factor[k][row] * x[k]);
        x[row] = remainder / factor[row][row];
    }
    x
}
