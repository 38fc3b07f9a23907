//! Numerical tolerances that are not options of a solve.
//!
//! They separate rounding from mechanics and are relative to the quantities that they are compared with,
//! so that no model needs other values. Tolerances of a solve are in
//! [`ContinuationOptions`](crate::equilibrium::ContinuationOptions).

/// Rounding of a residual, or of n ε for a sum of n terms, in units of ε times the size of its terms.
pub(crate) const ROUNDING_FACTOR: f64 = 8.0;
/// Largest rounding of a residual, as a fraction of the forces: beyond it no equilibrium is resolved.
pub(crate) const MAX_ROUNDING: f64 = 1e-2;

/// Dimensionless eigenvalues of the tangent within this of zero count as zero.
pub(crate) const ZERO_EIGENVALUE: f64 = 1e-8;
/// Dimensionless eigenvalue below which a state may drift before its residual grows.
pub(crate) const DRIFT_EIGENVALUE: f64 = 1e-6;
/// Imaginary parts of eigenvalues below this fraction of the matrix's norm count as zero: rounding splits
/// equal real eigenvalues into complex pairs.
pub(crate) const REAL_EIGENVALUE: f64 = 1e-6;
/// Largest dimensionless stiffness of a neutral motion in units of the residual.
pub(crate) const OF_RESIDUAL: f64 = 10.0;
/// How much dimensionless eigenvalues of the tangent may change per displacement (norm over all coordinates), as a
/// multiple of its largest diagonal entry: large forces change it faster.
pub(crate) const TANGENT_RATE: f64 = 2.0;
/// Ratio of pivots below which a matrix that is not symmetric counts as singular for derivatives.
pub(crate) const SINGULAR_PIVOTS: f64 = 1e-9;

/// Stiffness of an angle, relative to the stiffest angle of its component, below which it is not elastic.
pub(crate) const MIN_ELASTIC_STIFFNESS: f64 = 1e-10;
/// Smallest energy of a coordinate that is not elastic, relative to the largest of its component.
pub(crate) const MIN_ENERGY: f64 = 1e-6;
/// Rotation [rad] after which a coordinate that is not elastic has diverged.
pub(crate) const MAX_ROTATION: f64 = 1e3;
/// Displacement, in lengths of the longest body or spring, after which such a coordinate has diverged.
pub(crate) const MAX_DISPLACEMENT: f64 = 3e3;

/// Distance from switching on or off below which a force has one-sided derivatives, relative to a contact's
/// radii or to the length of a round cone's axis.
pub(crate) const SWITCHING_DISTANCE: f64 = 1e-7;
/// Distance below which two points count as coincident, relative to a rest length or to a sum of radii.
pub(crate) const COINCIDENT: f64 = 1e-6;
/// Relative difference below which two contact forces of joined round cones are that of their common
/// sphere.
pub(crate) const SAME_FORCE: f64 = 1e-9;

/// A condition of a tie depends on others if less than this part of its gradient is independent of theirs.
pub(crate) const DEPENDENT: f64 = 1e-8;
/// One that depended on others before is independent again if more than this part of its gradient is: where
/// ties are not quite closed, what follows from others is so only nearly.
pub(crate) const INDEPENDENT: f64 = 1e-2;
/// Singular values of the dimensionless gradients of ties up to this count as zero.
pub(crate) const RANK: f64 = 1e-7;
/// The same at a state a little away from the one in question.
pub(crate) const RANK_NEARBY: f64 = 5e-7;
/// Largest violation of such a condition: of lengths relative to that of the longest body, of angles in
/// radians.
pub(crate) const REDUNDANT_GAP: f64 = 1e-6;

/// Largest component of the rotation of a placement [rad]: of a larger one, rounding leaves no angle.
pub(crate) const MAX_PLACEMENT_ROTATION: f64 = 1e6;
/// Largest difference of the norm of a unit vector from one.
pub(crate) const UNIT_NORM: f64 = 1e-9;
/// Two vectors are parallel if cos² of the angle between them differs from one by less.
pub(crate) const PARALLEL: f64 = 1e-12;
