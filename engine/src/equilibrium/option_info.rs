//! Name, documentation and range of an option.

use std::fmt;

/// An interval of numbers, closed at its upper end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether the lower end is excluded.
    pub open: bool,
}

impl Interval {
    /// All numbers above `low`.
    pub(super) const fn above(low: f64) -> Self {
        Self { low, high: f64::MAX, open: true }
    }

    /// All numbers from `low` on.
    pub(super) const fn from(low: f64) -> Self {
        Self { low, high: f64::MAX, open: false }
    }

    /// The interval up to `high`.
    pub(super) const fn to(self, high: f64) -> Self {
        Self { high, ..self }
    }

    /// Whether it contains `value`.
    pub fn contains(&self, value: f64) -> bool {
        (value > self.low || (value == self.low && !self.open)) && value <= self.high
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.open {
            true => write!(f, "above {} and at most {}", self.low, self.high),
            false => write!(f, "from {} to {}", self.low, self.high),
        }
    }
}

/// A type of number that an option may have.
pub(super) trait OptionValue: Copy {
    const INTEGER: bool;
    fn to_f64(self) -> f64;
    fn from_f64(value: f64) -> Self;
}

impl OptionValue for f64 {
    const INTEGER: bool = false;
    fn to_f64(self) -> f64 {
        self
    }
    fn from_f64(value: f64) -> Self {
        value
    }
}

impl OptionValue for usize {
    const INTEGER: bool = true;
    fn to_f64(self) -> f64 {
        self as f64
    }
    fn from_f64(value: f64) -> Self {
        value as usize
    }
}

/// Name, meaning and range of an option.
#[derive(Clone, Copy, Debug)]
pub struct OptionInfo {
    /// Name of its field.
    pub name: &'static str,
    /// Its documentation.
    pub doc: &'static str,
    /// Range of its values.
    pub interval: Interval,
    /// Whether it is a whole number.
    pub integer: bool,
}

impl OptionInfo {
    pub(super) fn check(&self, value: f64) -> Result<(), OptionError> {
        if self.interval.contains(value) && !(self.integer && value.fract() != 0.0) {
            return Ok(());
        }
        let whole = if self.integer { "a whole number " } else { "" };
        Err(OptionError(format!("{} is {value}: it must be {whole}{}", self.name, self.interval)))
    }
}

/// An option that is unknown or out of range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OptionError(String);

impl OptionError {
    pub(super) fn unknown(name: &str, known: &[OptionInfo]) -> Self {
        let names: Vec<&str> = known.iter().map(|info| info.name).collect();
        Self(format!("no solver option is named {name} (there are: {})", names.join(", ")))
    }
}

impl fmt::Display for OptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for OptionError {}
