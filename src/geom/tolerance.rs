//! Every tolerance of the geometry, in mm, with the reason for its size.

/// Points closer than this are one point. A GRBL axis at 80 steps/mm moves in 0.0125 mm steps and G-code carries three decimals,
/// so a thousandth of the last printed digit cannot be told apart by anything downstream, and it is far above f64 round-off at 10 m (2e-12).
pub const SAME_POINT_MM: f64 = 1e-6;

/// Chords that stand in for arcs in pictures, areas and polygon tests stay this close to the arc: a tenth of the narrowest laser kerf.
pub const FLATTEN_MM: f64 = 0.01;

/// Two runs of cut geometry are allowed to overrun a limit by this much before it is called broken: half of the last G-code digit.
pub const LIMIT_SLACK_MM: f64 = 5e-4;
