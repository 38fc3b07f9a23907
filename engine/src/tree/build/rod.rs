//! Rods: bases at Gauss points, Magnus steps between sample points.

use super::super::description::{RodDescription, Section};
use super::super::{
    GaussPoint, MagnusStep, ModelError, Motion, Rod, SectionEntry, StrainColumn, Tree, finite, not_negative,
    positive,
};
use crate::lie::LieGroup;
use crate::section;
use crate::strain::{Basis, Intervals, Mode, gauss_legendre};

/// Collocation points of the 4th-order (Zanna) step on [0, 1].
const ZANNA: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Tree<G, D, P> {
    /// Adds the rod's coordinates, parameters and frames; returns its tip frame.
    pub(super) fn add_rod(
        &mut self,
        name: &str,
        rod: &RodDescription,
        base_frame: usize,
        body: usize,
    ) -> Result<usize, ModelError> {
        let field = |f: &str| format!("{name}.{f}");
        let x = check(name, rod)?;
        let first_dof = self.dof;
        let mut modes: Vec<(Mode, usize, Basis, usize)> = vec![];
        let mut angular = vec![];
        for strain in &rod.strain {
            let axis = G::axis(strain.mode).ok_or_else(|| {
                ModelError::new(field("strain"), format!("a planar rod has no mode {}", strain.mode.name()))
            })?;
            if modes.iter().any(|(mode, ..)| *mode == strain.mode) {
                return Err(ModelError::new(
                    field("strain"),
                    format!("mode {} is given twice", strain.mode.name()),
                ));
            }
            let basis = Basis { kind: strain.basis, order: strain.order, elements: rod.elements };
            let needed = basis.gauss_points_needed();
            if rod.gauss_points < needed {
                let found = rod.gauss_points;
                let problem =
                    format!("found {found}, the basis of {} needs at least {needed}", strain.mode.name());
                return Err(ModelError::new(field("gauss_points"), problem));
            }
            modes.push((strain.mode, axis, basis, self.dof));
            for i in 0..basis.len() {
                self.coordinates.push(format!("{name}.{}[{i}]", strain.mode.name()));
                angular.push(strain.mode.is_angular());
            }
            self.dof += basis.len();
        }

        let mut one = |f: &str, unit: &'static str, value: f64| self.slot(field(f), unit, &[value]).start;
        let length = one("length", "m", rod.length);
        let young_modulus = one("young_modulus", "Pa", rod.young_modulus);
        let shear_modulus = one("shear_modulus", "Pa", rod.shear_modulus);
        let density = one("density", "kg/m^3", rod.density);
        let radius = self.slot(field("radius"), "m", &rod.radius);
        let slope = self.slot(field("slope"), "m", &rod.slope);
        let reference_strain = self.slot(field("reference_strain"), None, &rod.reference_strain);

        let rule = gauss_legendre(rod.gauss_points);
        let mut gauss = vec![];
        let intervals = Intervals { elements: rod.elements, tip: rod.tip_intervals };
        for i in 0..intervals.len() {
            for (m, (t, w)) in rule.iter().enumerate() {
                let (element, at) = (intervals.element(i), intervals.at(i, *t));
                let mut columns = vec![];
                for (mode, _, basis, start) in &modes {
                    columns.extend(
                        basis.evaluate(element, at).into_iter().map(|(i, v)| (start + i, mode.index(), v)),
                    );
                }
                let point = i * (rod.gauss_points + 1) + 1 + m;
                gauss.push(GaussPoint { point, weight: w / intervals.count(i), columns });
            }
        }
        let entries = self.section_entries(&gauss);

        let rod_index = self.rods.len();
        let mut frame = base_frame;
        for k in 1..x.len() {
            let (a, h) = (x[k - 1], x[k] - x[k - 1]);
            let element = intervals.element((k - 1) / (rod.gauss_points + 1));
            let start = self.strain_columns.len();
            for (_, axis, basis, first) in &modes {
                let columns = step_values(basis, element, [a, h], rod.magnus_order);
                let column = |(i, phi)| StrainColumn { dof: first + i, axis: *axis, phi };
                self.strain_columns.extend(columns.into_iter().map(column));
            }
            self.steps.push(MagnusStep { rod: rod_index, h, columns: start..self.strain_columns.len() });
            frame =
                self.push_frame(frame, body, Motion::Strain(self.steps.len() - 1), format!("{name}[{k}]"));
        }
        let factors = section::factors(rod.section)
            .map(|factors| self.slot(format!("{name}.section_factors"), "1", &factors).start);
        self.rods.push(Rod {
            factors,
            reference_strain,
            dofs: first_dof..self.dof,
            x,
            gauss,
            entries,
            magnus_order: rod.magnus_order,
            length,
            radius,
            slope,
            young_modulus,
            shear_modulus,
            density,
            masses: vec![],
            angular,
        });
        Ok(frame)
    }

    /// The terms `w φ_i φ_j` of K, coordinates of one mode with one another only.
    fn section_entries(&mut self, gauss: &[GaussPoint]) -> Vec<SectionEntry> {
        let mut entries = vec![];
        let mut seen = std::collections::HashMap::new();
        for (g, point) in gauss.iter().enumerate() {
            for (i, mode, v) in &point.columns {
                for (j, _, w) in point.columns.iter().filter(|(j, other, _)| other == mode && j >= i) {
                    let entry = *seen.entry((*i, *j)).or_insert_with(|| {
                        self.stiffness_pattern.push((*i, *j));
                        self.stiffness_pattern.len() - 1
                    });
                    entries.push(SectionEntry { gauss: g, mode: *mode, entry, value: point.weight * v * w });
                }
            }
        }
        entries
    }
}

/// The value of each basis function at the collocation points of a Magnus step over `[a, a + h]`.
///
/// A step requires the mean of the strain, and at order 4 also its first moment, which its collocation
/// points give exactly up to degree 1 and 2, respectively. For piecewise functions of higher degree
/// the error would not decrease with finer elements, as a step is a fixed fraction of an element. Their
/// values are therefore those of the linear function with the same mean and first moment.
fn step_values(basis: &Basis, element: usize, [a, h]: [f64; 2], order: usize) -> Vec<(usize, [f64; 2])> {
    let at = |t: f64| basis.evaluate(element, a + t * h);
    let points = if order == 4 { ZANNA } else { [0.5; 2] };
    let degree = basis.degree();
    if !basis.is_piecewise() || degree < order.min(3) {
        let [first, second] = points.map(at);
        return first.into_iter().zip(second).map(|((i, v), (_, w))| (i, [v, w])).collect();
    }
    let mut values: Vec<(usize, [f64; 2])> = at(0.5).into_iter().map(|(i, _)| (i, [0.0; 2])).collect();
    for (t, weight) in gauss_legendre(degree.div_ceil(2) + 1) {
        // The line through a mean and a first moment, ∫ (t − ½) φ = (slope)/12.
        let share = points.map(|point| weight * (1.0 + 12.0 * (t - 0.5) * (point - 0.5)));
        for ((_, value), (_, phi)) in values.iter_mut().zip(at(t)) {
            value[0] += share[0] * phi;
            value[1] += share[1] * phi;
        }
    }
    values
}

/// Checks the rod's numbers; returns its sample points.
fn check(name: &str, rod: &RodDescription) -> Result<Vec<f64>, ModelError> {
    let field = |f: &str| format!("{name}.{f}");
    positive(field("length"), rod.length)?;
    positive(field("young_modulus"), rod.young_modulus)?;
    positive(field("shear_modulus"), rod.shear_modulus)?;
    not_negative(field("density"), rod.density)?;
    finite(field("reference_strain"), &rod.reference_strain)?;
    if let Section::Elliptic { ratio } | Section::Rectangular { ratio } = rod.section {
        positive(field("section.ratio"), ratio)?;
    }
    if rod.magnus_order != 2 && rod.magnus_order != 4 {
        let found = rod.magnus_order;
        return Err(ModelError::new(field("magnus_order"), format!("found {found}, must be 2 or 4")));
    }
    if rod.strain.is_empty() {
        return Err(ModelError::new(field("strain"), "a rod needs at least one strain mode"));
    }
    for (what, found) in
        [("elements", rod.elements), ("tip_intervals", rod.tip_intervals), ("gauss_points", rod.gauss_points)]
    {
        if !(1..=1000).contains(&found) {
            return Err(ModelError::new(field(what), format!("found {found}, must be from 1 to 1000")));
        }
    }
    let intervals = Intervals { elements: rod.elements, tip: rod.tip_intervals };
    let x = intervals.sample_points(rod.gauss_points);
    for (what, values) in [("radius", &rod.radius), ("slope", &rod.slope)] {
        if values.len() != x.len() {
            let problem = format!("found {} values, the rod has {} sample points", values.len(), x.len());
            return Err(ModelError::new(field(what), problem));
        }
    }
    for radius in &rod.radius {
        positive(field("radius"), *radius)?;
    }
    finite(field("slope"), &rod.slope)?;
    Ok(x)
}
