//! Dispatch over planar and spatial models.

use flexor_engine::Data;
use flexor_engine::lie::{SE2, SE3};
use flexor_engine::model::{Description, Model, ModelError, Structure};

/// A model of either group.
pub enum AnyModel {
    Planar(Box<Model<SE2, 3, 2>>),
    Spatial(Box<Model<SE3, 6, 3>>),
}

/// Runs the same code on a planar or a spatial model.
macro_rules! on_model {
    ($any:expr, $model:ident => $body:expr) => {
        match $any {
            $crate::dispatch::AnyModel::Planar($model) => $body,
            $crate::dispatch::AnyModel::Spatial($model) => $body,
        }
    };
}
pub(crate) use on_model;

impl AnyModel {
    pub fn new(description: &Description) -> Result<Self, ModelError> {
        Ok(if description.planar {
            Self::Planar(Box::new(Model::new(description)?))
        } else {
            Self::Spatial(Box::new(Model::new(description)?))
        })
    }

    pub fn has_structure_of(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Planar(one), Self::Planar(other)) => one.has_structure_of(other),
            (Self::Spatial(one), Self::Spatial(other)) => one.has_structure_of(other),
            _ => false,
        }
    }

    pub fn structure(&self, description: &Description) -> Structure {
        on_model!(self, model => Structure::new(model, description))
    }
}

/// The evaluation of a single state.
pub struct State {
    pub energy: f64,
    pub residual: Vec<f64>,
    pub tangent: Vec<f64>,
    pub lengths: Vec<f64>,
    pub volumes: Vec<f64>,
    pub forces: ElementForces,
    pub tendons: Tendons,
    /// −1 for a material that nothing is made of.
    pub stretch_frames: Vec<[i64; 2]>,
    pub frames: Vec<[[f64; 4]; 4]>,
    pub spheres: Vec<[f64; 4]>,
    pub contacts: Vec<ContactForce>,
}

/// Tensions and sums of normal forces.
pub struct ElementForces {
    pub springs: Vec<f64>,
    pub loops: Vec<f64>,
    pub obstacles: Vec<f64>,
}

/// What tendons do, one after another.
pub struct Tendons {
    pub lengths: Vec<f64>,
    pub tensions: Vec<f64>,
    /// By each coordinate.
    pub arms: Vec<f64>,
    /// Places along each, branch by branch.
    pub paths: Vec<Vec<Vec<[f64; 3]>>>,
}

/// A contact force.
pub struct ContactForce {
    pub first: usize,
    /// −1 − i for contact with obstacle i.
    pub second: i64,
    pub cone: bool,
    pub force: [f64; 3],
    pub point: [f64; 3],
    pub depth: f64,
    /// NaN except on an elastic foundation.
    pub pressure: f64,
}

impl AnyModel {
    /// Evaluates one state of one design.
    pub fn state(&self, parameters: &[f64], q: &[f64], load: &[f64]) -> State {
        on_model!(self, model => {
            let mut data = Data::new(model);
            data.set_parameters(model, parameters);
            data.evaluate(model, q, load);
            let mut volumes = vec![0.0; model.pressure_count()];
            data.volumes(model, q, &mut volumes);
            let mut forces = ElementForces {
                springs: vec![0.0; model.spring_count()],
                loops: vec![0.0; model.loop_count()],
                obstacles: vec![0.0; model.obstacle_count()],
            };
            data.spring_tensions(model, &mut forces.springs);
            data.loop_tensions(model, &mut forces.loops);
            data.obstacle_forces(model, &mut forces.obstacles);
            State {
                volumes,
                forces,
                tendons: Tendons {
                    lengths: data.tendon_lengths(model),
                    tensions: data.tendon_tensions(model, load),
                    arms: data.tendon_arms(model),
                    paths: data.tendon_paths(model).iter().map(|tendon| {
                        tendon.iter().map(|branch| branch.iter().map(|p| spatial(&p.0)).collect()).collect()
                    }).collect(),
                },
                energy: data.energy(),
                residual: data.residual().to_vec(),
                tangent: data.tangent().to_vec(),
                lengths: data.actuator_lengths(model, q),
                stretch_frames: data.stretch_frames(model, q).iter().map(|f| f.map(|f| f.map_or(-1, |f| f as i64))).collect(),
                frames: data.homogeneous_frames(),
                spheres: data.spheres(model).map(|(p, r)| { let [x, y, z] = spatial(&p.0); [x, y, z, r] }).collect(),
                contacts: data.contact_forces(model).iter().map(|t| ContactForce {
                    first: t.first,
                    second: t.nearest.map_or_else(|| -1 - t.obstacle.unwrap_or(0) as i64, |i| i as i64),
                    cone: t.cone,
                    force: spatial(&t.force.0),
                    point: spatial(&t.point.0),
                    depth: t.depth,
                    pressure: t.pressure.unwrap_or(f64::NAN),
                }).collect(),
            }
        })
    }
}

/// A planar (x, z) or spatial (x, y, z) point in space.
fn spatial(p: &[f64]) -> [f64; 3] {
    match p {
        [x, z] => [*x, 0.0, *z],
        _ => [p[0], p[1], p[2]],
    }
}
