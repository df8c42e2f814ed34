//! Furbelow turns a 3D shape into a soft, light, cuttable object. It fills the shape with *ruffles* (strips of paper, film, felt or metal folded back and
//! forth and locked by flaps cut into the strip itself), flattens them, nests the flat strips on sheets and writes kerf-compensated G-code. The method is that of
//! Signer, Ion and Sorkine-Hornung, *Developable Metamaterials*, CHI 2021 (doi:10.1145/3411764.3445666).
//!
//! # The house
//!
//! Data flows one way. Each room takes values from rooms above it and returns one; stages are plain functions without printing, clocks, files or global
//! state. The fourth column says who a room may use besides [`geom`] and [`progress`]; `tests/architecture.rs` fails on any other arrow.
//!
//! ```text
//!  room       takes                      gives                                       uses
//!  mesh       OBJ, STL bytes             TriMesh: mm, welded, checked; taken apart   -
//!  cut        TriMesh, Plane             Outline (2D loops) and PlaneFrame           mesh
//!  ruffle     Outline                    Ruffle: topology and rest lengths           cut
//!  extrude    TriMesh or constant        Span per node: how wide the strip is        mesh cut ruffle
//!  sim        Ruffle, widths, Material   Equilibrium: where the strip rests          ruffle
//!  fit        all of these               Part: the outline, filled                   cut ruffle extrude sim
//!  design     TOML                       Design: what the user decided               config cut ruffle
//!  strip      Part                       Pieces with flaps, slits, splices, labels   drawing cut ruffle extrude sim fit
//!  drawing    (a value)                  paths with role, kerf side, piece; SVG, DXF -
//!  nest       polygons, containers       Layouts: sheets, offcuts, a roll             -
//!  toolpath   placed drawings, process   Toolpath: kerf, bridges, order, blade       drawing nest
//!  gcode      Toolpath                   Program, plot; parse, trace, planner, check toolpath
//!  preview    parts, moves               pictures: SVG, PNG; a page that plays them  drawing nest gcode cut ruffle extrude sim fit
//!  assembly   parts, pieces, layouts     sheets of paper: what to do, step by step   mesh cut ruffle extrude sim fit strip nest drawing
//!  calibrate  material, machine           test cards, and what their answers mean     drawing strip
//!  emulator   bytes and time             bytes, and what the machine did             gcode
//!  stream     Program, bytes, time       bytes, events, a journal: a board fed       gcode emulator
//!  config     TOML                       Machine, Profile, and how they pair         -
//!  job        Design                     everything above, in order, into files      all of these
//!  cli        arguments                  calls of job, text, exit codes              job design preview gcode nest config stream
//! ```
//!
//! Four values carry most of the weight. A [`ruffle::Ruffle`] holds no positions: it is the walk of the strip over integer nodes, and wherever the walk meets
//! a node again the strip is joined to itself. A [`fit::Part`] is all that later rooms need of a filled outline. A [`drawing::Drawing`] says what is cut,
//! nominally; only [`toolpath`] knows the kerf. And [`gcode::trace`] is the only interpreter of G-code: planner, check and pictures read its moves.
//!
//! # Units and frames
//!
//! mm, N, N mm, rad and f64 inside; feeds in mm/min, power as a share of 1. Names carry the unit where it is not mm. Frames: mesh (the file's axes, in mm), plane
//! (u right, v up, floor at v = 0), strip (s along, w across), sheet (x right, y up, origin bottom left). [`geom::tolerance`] holds every tolerance with its reason.
//!
//! # How to add
//!
//! * **a machine**: a file in `machines/` (`furbelow machine schema` describes it, `furbelow machine check FILE` checks it); add it to the list in
//!   `config/library.rs` to build it in. Users put theirs into their own folder and need no build.
//! * **a material**: the same with `profiles/`. Every value that was measured or copied says so in `source`.
//! * **a stage**: a folder with its door (types, `Settings`, `Error`, one function), a row in the table above and in `tests/architecture.rs`, its settings
//!   in `job/settings.rs`, its call in `job`. Long work takes a [`progress::Observer`]; what users should know comes back as [`progress::Warning`]s.

#![warn(missing_docs)]

pub mod assembly;
pub mod calibrate;
pub mod cli;
pub mod config;
pub mod cut;
pub mod design;
pub mod drawing;
pub mod emulator;
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
pub mod stream;
pub mod strip;
pub mod toolpath;
