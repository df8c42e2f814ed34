//! Furbelow turns a 3D shape into a soft, light, cuttable object.

#![warn(missing_docs)]

pub mod cli;
pub mod config;
pub mod cut;
pub mod drawing;
pub mod extrude;
pub mod gcode;
pub mod geom;
pub mod mesh;
pub mod nest;
pub mod preview;
pub mod progress;
pub mod ruffle;
pub mod sim;
pub mod toolpath;
