//! What the value checks of machines and profiles share: a list of problems, each told at the place of the value.

use super::source::Problem;
use super::tree::Node;

/// The one version of the file formats.
pub(super) const SCHEMA: u32 = 1;

/// Collects what is wrong with the values of one file.
pub(super) struct Checker<'a> {
    root: &'a Node,
    problems: Vec<Problem>,
}

impl<'a> Checker<'a> {
    pub fn new(root: &'a Node) -> Checker<'a> {
        Checker { root, problems: Vec::new() }
    }

    pub fn into_problems(self) -> Vec<Problem> {
        self.problems
    }

    /// A problem at the value of `path` ("process.2.power"), or at the nearest table around it.
    pub fn problem(&mut self, path: &str, message: impl Into<String>) {
        self.problems.push(self.root.nearest(path).origin.problem(message, None));
    }

    /// A problem unless `holds`.
    pub fn require(&mut self, holds: bool, path: &str, message: &str) {
        if !holds {
            self.problem(path, message);
        }
    }

    /// A measure above 0.
    pub fn positive(&mut self, path: &str, value: f64) {
        self.require(value > 0.0, path, &format!("`{}` is {value}, it must be above 0", key(path)));
    }

    /// A measure above 0 that may be absent.
    pub fn positive_if_given(&mut self, path: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.positive(path, value);
        }
    }

    /// Every number of a list above 0.
    pub fn all_positive(&mut self, path: &str, values: &[f64]) {
        for (index, value) in values.iter().enumerate() {
            let holds = *value > 0.0;
            let message = format!("`{}` holds {value}, all must be above 0", key(path));
            self.require(holds, &format!("{path}.{index}"), &message);
        }
    }

    /// A measure of at least `least`.
    pub fn at_least(&mut self, path: &str, value: f64, least: f64) {
        self.require(value >= least, path, &format!("`{}` is {value}, it must be at least {least}", key(path)));
    }

    /// A measure from `least` to `most`.
    pub fn within(&mut self, path: &str, value: f64, least: f64, most: f64) {
        let message = format!("`{}` is {value}, it must lie from {least} to {most}", key(path));
        self.require((least..=most).contains(&value), path, &message);
    }

    /// A share of full power: above 0, at most 1.
    pub fn power(&mut self, path: &str, value: f64) {
        let message = format!("`{}` is {value}, it must lie above 0 and at most 1 (1 is full power)", key(path));
        self.require(value > 0.0 && value <= 1.0, path, &message);
    }

    /// A text that says something.
    pub fn text(&mut self, path: &str, value: &str) {
        self.require(!value.trim().is_empty(), path, &format!("`{}` is empty", key(path)));
    }

    /// A name that can be a file's name on every system.
    pub fn name(&mut self, path: &str, value: &str) {
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '-' | '_' | '.');
        let holds = value.chars().all(plain) && value.starts_with(|c: char| c.is_ascii_alphanumeric());
        let message = format!("\"{value}\" is no name: use small letters, digits, `-`, `_` and `.`");
        self.require(holds && !value.ends_with(".toml"), path, &message);
    }

    /// The format's version.
    pub fn schema(&mut self, value: u32) {
        let message = format!("this file is of format {value}; this program reads format {SCHEMA}");
        self.require(value == SCHEMA, "schema", &message);
    }
}

/// The last key of a path.
fn key(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}
