//! What a solve is asked for, and why it may be refused.

use crate::ruffle::Node;

/// Accuracy and limits of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Unbalanced force at which a solve has converged, N. A millionth of a newton is a thousandth of the weight of one node of a paper strip.
    pub residual_n: f64,
    /// Newton steps after which it gives up.
    pub max_iterations: usize,
    /// Farthest a node may move in one step, mm: in a tall stack small turns add up.
    pub max_step_mm: f64,
    /// Farthest a segment may turn in one step, rad: beyond it the quadratic model means nothing.
    pub max_turn_rad: f64,
    /// Height of the floor, plane frame, mm; minus infinity for none.
    pub floor_mm: f64,
    /// Whether sheets keep each other out. Without it strips may pass through themselves.
    pub contact: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            residual_n: 1e-6,
            max_iterations: 400,
            max_step_mm: 100.0,
            max_turn_rad: 1.0,
            floor_mm: 0.0,
            contact: true,
        }
    }
}

/// What holds the ruffle, besides the floor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Supports {
    /// Nodes that do not move at all.
    pub pinned: Vec<Node>,
    /// Nodes that move up and down only.
    pub upright: Vec<Node>,
}

/// Why a solve could not start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// An array does not match the ruffle.
    #[error("{what}: {found}, where the ruffle has {expected}")]
    Count {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Nodes of the ruffle.
        expected: usize,
    },
    /// A width, length or stiffness that is not a positive number.
    #[error("{what} {index} is {value}; it must be a positive number")]
    NotPositive {
        /// Which quantity.
        what: &'static str,
        /// Which one.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A start position or a force that is not a number.
    #[error("the position or force given for node {node} is not finite")]
    NotFinite {
        /// The node.
        node: usize,
    },
    /// A start in which the strip passes through itself, or sheets lie on each other.
    #[error(
        "the strip starts out passing through itself in {crossings} places, first where segments {first} and {second} meet near u {u_mm:.1}, v {v_mm:.1} mm; draw it with other layers"
    )]
    Crossed {
        /// Pairs of segments that cross; 0 when sheets only lie on each other.
        crossings: usize,
        /// A segment, in strip order.
        first: usize,
        /// Another.
        second: usize,
        /// Where they meet.
        u_mm: f64,
        /// Where they meet.
        v_mm: f64,
    },
    /// A plate that would pull, or weighs nothing that is a number.
    #[error("the plate's load is {load_n} N; it must be zero or more")]
    PlateLoad {
        /// The load, N.
        load_n: f64,
    },
    /// The ordering of unknowns failed.
    #[error("could not order {unknowns} unknowns: {status}")]
    Ordering {
        /// Number of unknowns.
        unknowns: usize,
        /// What the ordering said.
        status: String,
    },
}
