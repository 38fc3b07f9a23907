//! The test that a corrected state lies on the branch that was predicted.

use super::options::SameBranchOptions;
use super::predictor::Predictor;
use super::vector::norm;

/// Whether the displacement `moved` over a sub-step `h` agrees with the prediction or with the
/// velocities at both ends, if it is no longer than `longest`. `work` is scratch.
///
/// On one branch with a change of contact the path is nearly two straight pieces, so the displacement
/// lies between the two tangents; a jump to another branch does not.
pub(super) fn is_same_branch<const D: usize, const P: usize>(
    options: &SameBranchOptions,
    predictor: &Predictor<D, P>,
    h: f64,
    moved: &[f64],
    [before, after]: [&[f64]; 2],
    longest: f64,
    work: &mut [f64],
) -> bool {
    predictor.displacement(h, work);
    let (mut displacement_error, mut velocity_error, mut displacement) = (0.0, 0.0, 0.0);
    let (mut mean_error, mut change, mut reach, mut speed) = (0.0, 0.0, 0.0, 0.0);
    let predicted = predictor.velocity(h).zip(&*work);
    for ((m, (a, b)), (v, d)) in moved.iter().zip(before.iter().zip(after)).zip(predicted) {
        displacement_error += (m - d).powi(2);
        displacement += m.powi(2);
        velocity_error += (b - v).powi(2);
        speed += v.powi(2);
        mean_error += (m - 0.5 * h * (a + b)).powi(2);
        change += (h * (b - a)).powi(2);
        reach += (0.5 * h * (a.abs() + b.abs())).powi(2);
    }
    let as_predicted = displacement_error.sqrt() <= options.displacement_error * displacement.sqrt()
        && velocity_error.sqrt() <= options.velocity_error * speed.sqrt();
    let allowed = options.mean_velocity_error * change.sqrt()
        + options.relative_error * reach.sqrt()
        + options.absolute_error;
    let between_tangents = change.sqrt() <= options.max_velocity_change
        && mean_error.sqrt() <= allowed
        && norm(after).is_finite()
        && displacement.sqrt() <= longest;
    as_predicted || between_tangents
}
