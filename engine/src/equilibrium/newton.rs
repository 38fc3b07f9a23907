//! Chord steps: Newton steps with a tangent that is not evaluated again.

use super::options::NewtonOptions;
use super::system::System;
use crate::lie::LieGroup;

/// Chord steps with the current factor, while each leaves little of the residual and few are left.
///
/// The residual was `before` ahead of the last step and is `size` now; returns the fraction of it that the
/// last step left. `step` is scratch.
pub(super) fn chord_steps<G: LieGroup<D, P>, const D: usize, const P: usize>(
    system: &mut System<G, D, P>,
    options: &NewtonOptions,
    step: &mut [f64],
    size: &mut f64,
    before: f64,
    tolerance: f64,
) -> f64 {
    let left = options.max_chords_left as i32;
    let mut contraction = *size / before;
    while *size > tolerance
        && contraction < options.chord_contraction
        && *size * contraction.powi(left) <= tolerance
    {
        system.newton_step(step);
        system.advance(step);
        let before = std::mem::replace(size, system.evaluate());
        contraction = *size / before;
    }
    contraction
}
