//! Machines and profiles: TOML files as checked, typed values.
//!
//! A [`Machine`] is a cutter as its owner set it up; safety limits live only there. A [`Profile`] is a sheet material: stiffness, stock,
//! joint, which tools may touch it, and the settings that worked. Both are found by name or path in a [`Library`], may build on another
//! file with `inherits`, and are refused with file, line and column of *everything* that is wrong. [`Machine::pair`] says whether and how a
//! machine cuts a material.
//!
//! ```text
//! text -> tree (values with places) -> over its base -> typed value -> checked -> Machine, Profile
//! ```

mod check;
mod error;
mod joint;
mod library;
mod machine;
mod machine_check;
mod making;
mod process;
mod profile;
mod profile_check;
mod read;
mod schema;
mod set;
mod source;
mod tree;

pub use error::{Error, Kind};
pub use joint::{Dashes, Holes, Joint, Joints};
pub use library::{FOLDER_VARIABLE, Library, Listed, Place, jobs_folder};
pub use machine::{
    AirCode, AirCodes, Axis, Backing, Controller, Corner, Dialect, Hold, KeepOut, Lift, Machine, Roll, Servo, Tool,
    ToolClass, WorkArea,
};
pub use making::{JointKind, LabelKind, LabelsByTool, Making, SpliceKind, VisibleFace};
pub use process::{Pairing, Process};
pub use profile::{
    Air, Allowed, Blade, Bridges, Grain, ProcessKind, ProcessRow, Profile, Splice, Stock, StockGrain, Verdict,
};
pub use schema::schema;
pub use set::Changes;
pub use source::Problem;

#[cfg(test)]
mod tests;
