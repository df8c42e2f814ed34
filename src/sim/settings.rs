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
    /// What keeps sheets apart.
    pub contact: Contact,
}

/// What keeps the sheets of a strip apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// Nothing: the strip may pass through itself.
    None,
    /// A logarithmic barrier with continuous collision detection: no accepted state crosses, and sheets keep their thickness.
    Barrier,
    /// The paper's air mesh (section 4.1.3): a penalty on triangles of the void that turn inside out. Sheets under load overlap a little and may pass through each other; they have no thickness.
    AirMesh,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            residual_n: 1e-6,
            max_iterations: 400,
            max_step_mm: 100.0,
            max_turn_rad: 1.0,
            floor_mm: 0.0,
            contact: Contact::Barrier,
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

/// A place of the strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripPlace {
    /// Section, an index into [`crate::ruffle::Ruffle::sections`].
    pub section: usize,
    /// Rest length of the strip from its start to the place, mm.
    pub along_mm: f64,
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
    /// A start in which the strip passes through itself, or sheets lie on each other, and could not be laid out otherwise.
    #[error(
        "the strip starts out passing through itself in {crossings} places; where section {} ({:.1} mm along the strip) meets section {} ({:.1} mm along) near u {u_mm:.1}, v {v_mm:.1} mm it could not be pulled apart; draw it with other layers",
        first.section, first.along_mm, second.section, second.along_mm
    )]
    Crossed {
        /// Pairs of segments that cross; 0 when sheets only lie on each other.
        crossings: usize,
        /// One place of the strip that meets another.
        first: StripPlace,
        /// The other, farther along the strip.
        second: StripPlace,
        /// Where they meet, plane frame.
        u_mm: f64,
        /// Where they meet, plane frame.
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
