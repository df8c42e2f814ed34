//! Furbelow turns a 3D shape into a soft, light, cuttable object.

#![warn(missing_docs)]

pub mod cli;
pub mod config;
pub mod cut;
pub mod design;
pub mod drawing;
pub mod extrude;
pub mod fit;
pub mod gcode;
pub mod geom;
pub mod job;
pub mod mesh;
pub mod nest;
pub mod preview;
pub mod progress;
pub mod ruffle;
pub mod sim;
pub mod strip;
pub mod toolpath;
