//! FibreSections of material fibres: their description, and its numbers among the parameters.

use super::super::moments::MOMENTS;
use super::axial::axial;
use super::law::Law;
use super::wall::Wall;
use crate::lie::LieGroup;
use crate::linalg::Matrix;
use crate::tree::{ModelError, Rod, Tree, finite, positive};
use serde::Deserialize;
use std::ops::{Add, Mul, Range};

/// A material.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialDescription {
    /// Unique name.
    pub name: String,
    /// Strain energy function.
    pub law: Law,
    /// Its constants.
    pub constants: Vec<f64>,
    /// Whether a winding around the section keeps the material from stretching across its fibres.
    #[serde(default)]
    pub wound: bool,
}

/// A straight fibre along a rod; its place and area depend on the surface S(X).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FibreDescription {
    /// Index of its material.
    pub material: usize,
    /// Offset y, z from the axis: constant [m] and multiple of S.
    pub y: [f64; 2],
    /// See `y`.
    pub z: [f64; 2],
    /// Area: constant [m²], multiples of S [m] and of S².
    pub area: [f64; 3],
    /// Stretch in the reference state.
    pub stretch: f64,
    /// Of a wound material: radius of the winding and radius of the fibre, each a constant [m] and a
    /// multiple of S; the same in flat walls.
    pub winding: [f64; 4],
    /// Offset y, z of the centre of these radii, as the offset of the fibre; the same in flat walls.
    pub centre: [f64; 4],
}

/// A cross-section.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FibreSectionDescription {
    /// Fibres; their energy depends on extension and bending.
    pub fibres: Vec<FibreDescription>,
    /// Torsional rigidity by Σ G A (y² + z²) of the fibres.
    pub torsion: f64,
    /// Stiffness of shear along y and z by that of all fibres in series, (Σ A)²/Σ A/G.
    pub shear: [f64; 2],
    /// Further stiffness, the upper triangle of a symmetric matrix in the order of the strain modes,
    /// row by row [N·m² for two curvatures, N·m for one, N for none].
    pub rigidity: [f64; 21],
    /// Mass per length, with first moments: coefficients of 1, S, S² of ∫ ρ dA, then of 1, S, S², S³ of
    /// ∫ ρ y dA and ∫ ρ z dA.
    pub mass: [f64; MOMENTS],
    /// Widths that must not be negative: constant [m] and multiple of S.
    pub clearances: Vec<[f64; 2]>,
}

/// The sections of a rod whose own section is [`Section::Fibres`].
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FibreRodDescription {
    /// The rod.
    pub rod: String,
    /// Its sections.
    pub sections: Vec<FibreSectionDescription>,
    /// Which of these each Gauss point has.
    pub of_gauss: Vec<usize>,
}

/// A material: its constants are parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Material {
    pub law: Law,
    pub wound: bool,
    pub constants: Range<usize>,
}

impl Material {
    /// Whether its fibres move in curved walls, and are stretched along their circumference.
    pub fn moves(&self) -> bool {
        self.wound && self.law != Law::Linear
    }

    /// A fibre of a section with this S; one that does not move is its own centre.
    #[inline]
    pub fn fibre(&self, numbers: &[f64], s: f64) -> Fibre {
        let fibre = Fibre::new(numbers, s);
        if self.moves() { fibre } else { Fibre { ratio: 1.0, centre: [fibre.y, fibre.z], ..fibre } }
    }
}

/// Numbers that describe a fibre, in the order of [`FibreDescription`].
pub(super) const NUMBERS: usize = 16;

/// A section: the places of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FibreSection {
    /// Material of each fibre, sorted.
    pub materials: Vec<usize>,
    /// First number of its first fibre.
    pub fibres: usize,
    pub torsion: usize,
    pub shear: usize,
    pub rigidity: usize,
    pub mass: usize,
    pub clearances: Range<usize>,
}

/// For each Gauss point, pairs of its columns with their entries in a pattern.
type Pairs = Vec<Vec<(usize, usize, usize)>>;

/// A rod with its sections.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FibreRod {
    pub rod: usize,
    pub sections: Vec<FibreSection>,
    pub of_gauss: Vec<usize>,
    /// Parameter holding S at each Gauss point.
    pub radii: Vec<usize>,
    /// Whether all its fibres are linear.
    pub linear: bool,
    /// Pairs of coordinates that its linear stiffness couples, the first not after the second; without
    /// those of extension and bending if there are other fibres.
    pub pattern: Vec<(usize, usize)>,
    /// The pairs that make it.
    pub pairs: Pairs,
}

/// A fibre of a section with this S.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fibre {
    pub y: f64,
    pub z: f64,
    pub area: f64,
    pub stretch: f64,
    /// The radius of the winding over that of the fibre.
    pub ratio: f64,
    /// y and z of the centre of these.
    pub centre: [f64; 2],
}

/// Derivatives with respect to what a fibre is described by: numbers, or what is linear in virtual strains.
#[derive(Clone, Copy, Debug)]
pub(super) struct FibreDerivatives<T> {
    /// Its place, y and z.
    pub place: [T; 2],
    pub centre: [T; 2],
    pub area: T,
    pub stretch: T,
    pub ratio: T,
}

impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> FibreDerivatives<T> {
    /// Each of them as a number.
    #[inline]
    pub fn map(&self, number: impl Fn(T) -> f64) -> FibreDerivatives<f64> {
        FibreDerivatives {
            place: self.place.map(&number),
            centre: self.centre.map(&number),
            area: number(self.area),
            stretch: number(self.stretch),
            ratio: number(self.ratio),
        }
    }

    /// That with respect to S.
    #[inline]
    pub fn by_radius(&self, n: &[f64], s: f64) -> T {
        let (winding, own) = (n[8] + n[9] * s, n[10] + n[11] * s);
        let [[y, z], [centre_y, centre_z]] = [self.place, self.centre];
        y * n[1]
            + z * n[3]
            + self.area * (n[5] + 2.0 * s * n[6])
            + self.ratio * (n[9] / own - n[11] * winding / (own * own))
            + centre_y * n[13]
            + centre_z * n[15]
    }
}

impl FibreDerivatives<f64> {
    /// Adds those with respect to the numbers.
    #[inline]
    pub fn add_by_numbers(&self, n: &[f64], s: f64, out: &mut [f64]) {
        let Self { place: [y, z], centre: [centre_y, centre_z], area, stretch, ratio } = *self;
        let (winding, own) = (n[8] + n[9] * s, n[10] + n[11] * s);
        let by_winding = ratio / own;
        let by_own = -by_winding * winding / own;
        let derivatives = [
            y,
            y * s,
            z,
            z * s,
            area,
            area * s,
            area * s * s,
            stretch,
            by_winding,
            by_winding * s,
            by_own,
            by_own * s,
            centre_y,
            centre_y * s,
            centre_z,
            centre_z * s,
        ];
        out.iter_mut().zip(derivatives).for_each(|(o, d)| *o += d);
    }
}

impl Fibre {
    #[inline]
    pub fn new(n: &[f64], s: f64) -> Self {
        let (winding, own) = (n[8] + n[9] * s, n[10] + n[11] * s);
        Self {
            y: n[0] + n[1] * s,
            z: n[2] + n[3] * s,
            area: n[4] + s * (n[5] + s * n[6]),
            stretch: n[7],
            ratio: winding / own,
            centre: [n[12] + n[13] * s, n[14] + n[15] * s],
        }
    }

    /// Its place from the centre, y and z.
    #[inline]
    pub fn arm(&self) -> [f64; 2] {
        [self.y - self.centre[0], self.z - self.centre[1]]
    }

    /// Whether it stays in its place.
    #[inline]
    pub fn is_flat(&self) -> bool {
        self.ratio == 1.0 && self.arm() == [0.0; 2]
    }

    /// a and b (see `wall.rs`) under ε, θ_y and θ_z.
    #[inline]
    pub fn stretches(&self, [axial, bend_y, bend_z]: [f64; 3], length: f64) -> [f64; 2] {
        let bent = |[y, z]: [f64; 2]| (bend_y * z - bend_z * y) / length;
        [self.stretch * (1.0 + axial + bent(self.centre)), self.stretch * bent(self.arm())]
    }

    /// It under ε, θ_y and θ_z.
    #[inline]
    pub fn wall(&self, strains: [f64; 3], length: f64) -> Wall {
        let [a, b] = self.stretches(strains, length);
        Wall::new(a, b, self.ratio)
    }
}

/// Builds the materials of a model.
pub(super) fn materials<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &mut Tree<G, D, P>,
    described: &[MaterialDescription],
) -> Result<Vec<Material>, ModelError> {
    let mut built = vec![];
    for material in described {
        let field = format!("materials.{}.constants", material.name);
        finite(&field, &material.constants)?;
        let law = material.law;
        if !law.accepts(material.constants.len()) || !law.is_admissible(&material.constants) {
            let problem = format!("found {:?}, which are not those of {law:?}", material.constants);
            return Err(ModelError::new(field, problem));
        }
        let constants = tree.slot(format!("{}.constants", material.name), None, &material.constants);
        built.push(Material { law, wound: material.wound, constants });
    }
    Ok(built)
}

/// Builds the sections of a rod.
pub(super) fn rod<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &mut Tree<G, D, P>,
    described: &FibreRodDescription,
    materials: &[Material],
) -> Result<FibreRod, ModelError> {
    let name = &described.rod;
    let field = |f: &str| format!("fibres.{name}.{f}");
    let rod = tree.rod(&field("rod"), name)?;
    if tree.rods[rod].factors.is_some() {
        return Err(ModelError::new(field("rod"), "the rod has a solid section"));
    }
    let points = tree.rods[rod].gauss.len();
    let of_gauss = described.of_gauss.clone();
    if of_gauss.len() != points || of_gauss.iter().any(|i| *i >= described.sections.len()) {
        let problem =
            format!("one of {} sections is needed at each of {points} points", described.sections.len());
        return Err(ModelError::new(field("of_gauss"), problem));
    }
    let mut sections = vec![];
    for (index, section) in described.sections.iter().enumerate() {
        let mut fibres = section.fibres.clone();
        fibres.sort_by_key(|fibre| fibre.material);
        if fibres.last().is_some_and(|fibre| fibre.material >= materials.len()) {
            let problem = format!("there are {} materials", materials.len());
            return Err(ModelError::new(field("fibres"), problem));
        }
        let mut numbers = vec![];
        for fibre in &fibres {
            positive(field("stretch"), fibre.stretch)?;
            numbers.extend(fibre.y.iter().chain(&fibre.z).chain(&fibre.area));
            numbers.push(fibre.stretch);
            numbers.extend(fibre.winding);
            numbers.extend(fibre.centre);
        }
        let mut slot =
            |part: &str, unit: Option<&'static str>, values: &[f64]| -> Result<Range<usize>, ModelError> {
                finite(field(part), values)?;
                Ok(tree.slot(format!("{name}.{part}[{index}]"), unit, values))
            };
        sections.push(FibreSection {
            materials: fibres.iter().map(|fibre| fibre.material).collect(),
            fibres: slot("fibres", None, &numbers)?.start,
            torsion: slot("torsion", Some("N*m^2"), &[section.torsion])?.start,
            shear: slot("shear", None, &section.shear)?.start,
            rigidity: slot("rigidity", None, &section.rigidity)?.start,
            mass: slot("mass", None, &section.mass)?.start,
            clearances: slot("clearances", None, section.clearances.as_flattened())?,
        });
    }
    let masses = of_gauss.iter().map(|section| sections[*section].mass).collect();
    tree.rods[rod].masses = masses;
    let mut used = sections.iter().flat_map(|section: &FibreSection| &section.materials);
    let linear = used.all(|material| materials[*material].law == Law::Linear);
    let (pattern, pairs) = pattern(&tree.rods[rod], linear);
    let Rod { radius, gauss, .. } = &tree.rods[rod];
    let radii = gauss.iter().map(|gauss| radius.start + gauss.point).collect();
    Ok(FibreRod { rod, sections, of_gauss, radii, linear, pattern, pairs })
}

/// Pairs of columns of each Gauss point, `all` or without those of extension and bending, and the entries
/// of the stiffness that they make.
fn pattern(rod: &Rod, all: bool) -> (Vec<(usize, usize)>, Pairs) {
    let (mut pattern, mut seen) = (vec![], std::collections::HashMap::new());
    let mut pairs = vec![];
    for gauss in &rod.gauss {
        let mut of_point = vec![];
        for (a, (i, mode, _)) in gauss.columns.iter().enumerate() {
            let pattern_has = |other: usize| all || axial(*mode).is_none() || axial(other).is_none();
            let after = gauss.columns.iter().enumerate().filter(|(_, (j, ..))| j >= i);
            for (b, (j, ..)) in after.filter(|(_, (_, other, _))| pattern_has(*other)) {
                let entry = *seen.entry((*i, *j)).or_insert_with(|| {
                    pattern.push((*i, *j));
                    pattern.len() - 1
                });
                of_point.push((a, b, entry));
            }
        }
        pairs.push(of_point);
    }
    (pattern, pairs)
}

/// A symmetric matrix from its upper triangle.
pub(super) fn symmetric(upper: &[f64]) -> Matrix<6, 6> {
    let mut matrix = Matrix::ZERO;
    let mut upper = upper.iter();
    for i in 0..6 {
        for j in i..6 {
            let value = upper.next().copied().unwrap_or(0.0);
            matrix.0[i][j] = value;
            matrix.0[j][i] = value;
        }
    }
    matrix
}
