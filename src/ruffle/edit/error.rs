//! Why an edit is refused.

use crate::ruffle::Flaw;

/// Why a ruffle was left as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// A section that the ruffle does not have.
    #[error("there is no section {section}; the ruffle has {count}, counted from 0")]
    NoSuchSection {
        /// Asked for.
        section: usize,
        /// Number of sections.
        count: usize,
    },
    /// A joint that the ruffle does not have.
    #[error("there is no joint {joint}; the ruffle has {count}, counted from 1")]
    NoSuchJoint {
        /// Asked for.
        joint: u32,
        /// Number of joints.
        count: usize,
    },
    /// A place to which a joint cannot go.
    #[error(
        "joint {joint} cannot go to u {u_mm:.1}, v {v_mm:.1} mm: the strip would run into itself; move it less far"
    )]
    JointBlocked {
        /// The joint.
        joint: u32,
        /// Where it was to go.
        u_mm: f64,
        /// Where it was to go.
        v_mm: f64,
    },
    /// A layer that the stack does not have.
    #[error("there is no place {layer} among {count} layers, counted from 0")]
    NoSuchLayer {
        /// Asked for.
        layer: usize,
        /// Number of layers.
        count: usize,
    },
    /// The last layer cannot go.
    #[error("a ruffle keeps one layer at least; insert another before removing this one")]
    LastLayer,
    /// A ruffle that was not threaded as a stack.
    #[error("{sections} undensified sections are no stack of layers: a stack of n layers has 4 n + 1")]
    NotAStack {
        /// Sections after everything is undensified.
        sections: usize,
    },
    /// A rung on which a layer is to stand, or that is to carry other layers, is densified itself.
    #[error("section {section} belongs to a densified rung that other layers stand on; undensify it first")]
    RungDensified {
        /// A section of the rung.
        section: usize,
    },
    /// A length that is not a positive number.
    #[error("section {section} cannot be {length_mm} mm long; give it one above 0 and up to 100 m")]
    Length {
        /// Section.
        section: usize,
        /// Asked for, mm.
        length_mm: f64,
    },
    /// A segment or layer size that is not a positive number.
    #[error("{what} is {value_mm} mm; it must be above 0, and at most 100 m")]
    Size {
        /// Which.
        what: &'static str,
        /// Asked for, mm.
        value_mm: f64,
    },
    /// Segments that cannot be divided or joined any further.
    #[error("section {section} has {segments} segments; it keeps {least} at least, so they cannot be joined in pairs")]
    TooCoarse {
        /// Section.
        section: usize,
        /// Its segments.
        segments: usize,
        /// Fewest allowed.
        least: usize,
    },
    /// A section that densifying did not make.
    #[error("section {section} was not made by densifying; there is nothing to take back")]
    NotDensified {
        /// Section.
        section: usize,
    },
    /// The strip would meet itself, or its loops would be too small to draw.
    #[error(
        "section {section}: no room to redraw it near u {u_mm:.1}, v {v_mm:.1} mm; make the sections around it longer, take fewer layers, or use shorter segments"
    )]
    NoRoom {
        /// Section that was edited.
        section: usize,
        /// Where.
        u_mm: f64,
        /// Where.
        v_mm: f64,
    },
    /// A loop whose crown would crease.
    #[error(
        "the loop of section {section} would bend to a radius of {radius_mm:.1} mm; below {limit_mm:.1} mm this material creases. Make it longer, or leave it undensified"
    )]
    Crease {
        /// The loop.
        section: usize,
        /// Radius of its crown, mm.
        radius_mm: f64,
        /// Least radius, mm.
        limit_mm: f64,
    },
    /// A void that nobody reaches into.
    #[error(
        "the void inside section {section} would be {void_mm:.1} mm thick; fingers or tools need {limit_mm:.1} mm to reach its flaps. Make it longer, or leave it undensified"
    )]
    OutOfReach {
        /// The loop around the void.
        section: usize,
        /// Thickness of the void, mm.
        void_mm: f64,
        /// Least thickness, mm.
        limit_mm: f64,
    },
    /// Positions of another ruffle.
    #[error("{found} positions for {expected} nodes")]
    Positions {
        /// Positions given.
        found: usize,
        /// Nodes of the ruffle.
        expected: usize,
    },
    /// The foot's nodes are not ends of sections.
    #[error("the foot's two nodes must be ends of sections")]
    Foot,
    /// The ruffle is broken.
    #[error(transparent)]
    Flaw(#[from] Flaw),
}

impl EditError {
    /// The same error about the section that was asked for: what an edit makes of it on the way has numbers that nobody has seen.
    pub(super) fn about(mut self, asked: usize) -> EditError {
        if let EditError::NoRoom { section, .. }
        | EditError::Crease { section, .. }
        | EditError::OutOfReach { section, .. }
        | EditError::NotDensified { section } = &mut self
        {
            *section = asked;
        }
        self
    }
}
