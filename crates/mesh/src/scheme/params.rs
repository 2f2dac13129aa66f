//! Parameters of schemes: a table for menus and commands, and values that travel with a plan.
//!
//! ```text
//!   Info.params   [Param { key: "w", domain: Number { 0 .. 0.125, 0.0625 } }]      loop weights=warren
//!   Params        [None]  ── of ──>  [0.0625, 0, 0]  ── Tags ──>  rules
//! ```
//!
//! What was not set has the default, so a document names only what its author chose. Cost: nothing worth counting.

use super::Info;

/// The most parameters that a scheme has.
pub const MOST_PARAMS: usize = 3;

/// A parameter.
#[derive(Debug, PartialEq)]
pub struct Param {
    /// What it is called in commands and links; permanent.
    pub key: &'static str,
    /// What people read beside its slider or buttons.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// What it can be.
    pub domain: Domain,
}

/// What a parameter can be.
#[derive(Debug, PartialEq)]
pub enum Domain {
    /// A number.
    Number {
        /// The least.
        low: f64,
        /// The greatest.
        high: f64,
        /// Unless set.
        default: f64,
    },
    /// A whole number.
    Whole {
        /// The least.
        low: u32,
        /// The greatest.
        high: u32,
        /// Unless set.
        default: u32,
    },
    /// One of these words, by number; the first unless set.
    Choice(&'static [&'static str]),
}

impl Domain {
    /// The value unless set.
    pub fn default(&self) -> f64 {
        match self {
            Domain::Number { default, .. } => *default,
            Domain::Whole { default, .. } => f64::from(*default),
            Domain::Choice(_) => 0.0,
        }
    }

    /// Whether `value` is one.
    pub fn holds(&self, value: f64) -> bool {
        match self {
            Domain::Number { low, high, .. } => (*low..=*high).contains(&value),
            Domain::Whole { low, high, .. } => {
                (f64::from(*low)..=f64::from(*high)).contains(&value) && value.fract() == 0.0
            }
            Domain::Choice(words) => value >= 0.0 && value < words.len() as f64 && value.fract() == 0.0,
        }
    }
}

/// The parameters that were set, in the order of [`Info::params`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Params([Option<f64>; MOST_PARAMS]);

impl Params {
    /// Sets parameter `at` of a scheme, its default as if nothing was set; false if there is none or it cannot be that.
    pub fn set(&mut self, info: &Info, at: usize, value: f64) -> bool {
        let param = info.params.get(at).filter(|p| p.domain.holds(value));
        if let (Some(param), Some(slot)) = (param, self.0.get_mut(at)) {
            *slot = (value != param.domain.default()).then_some(value);
        }
        param.is_some()
    }

    /// What parameter `at` was set to, if to another value than its default.
    pub fn get(&self, at: usize) -> Option<f64> {
        self.0.get(at).copied().flatten()
    }

    /// All values of a scheme's parameters, defaults where nothing was set; zeros after the last.
    pub fn of(&self, info: &Info) -> [f64; MOST_PARAMS] {
        let mut values = [0.0; MOST_PARAMS];
        for ((value, set), param) in values.iter_mut().zip(self.0).zip(info.params) {
            *value = set.filter(|v| param.domain.holds(*v)).unwrap_or(param.domain.default());
        }
        values
    }
}
