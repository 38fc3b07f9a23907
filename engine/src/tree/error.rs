//! Errors in descriptions.

use thiserror::Error;

/// An invalid description; the message names the field and the allowed values.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{field}: {problem}")]
pub struct ModelError {
    /// Dotted path of the offending field.
    pub field: String,
    /// One clause: what was found and what is allowed.
    pub problem: String,
}

impl ModelError {
    pub(crate) fn new(field: impl Into<String>, problem: impl Into<String>) -> Self {
        Self { field: field.into(), problem: problem.into() }
    }
}

/// Checks that `value` is finite and greater than zero.
pub(crate) fn positive(field: impl Into<String>, value: f64) -> Result<f64, ModelError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ModelError::new(field, format!("found {value}, must be a finite number greater than zero")))
    }
}

/// Checks that `value` is finite and not negative.
pub(crate) fn not_negative(field: impl Into<String>, value: f64) -> Result<f64, ModelError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ModelError::new(field, format!("found {value}, must be a finite number not below zero")))
    }
}

/// Checks that every value is finite.
pub(crate) fn finite(field: impl Into<String>, values: &[f64]) -> Result<(), ModelError> {
    match values.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(v) => Err(ModelError::new(field, format!("found {v}, must be finite"))),
    }
}
