//! The emulated board against what GRBL 1.1h was measured to do.

#[path = "emulator/beam.rs"]
mod beam;
#[path = "emulator/bench.rs"]
mod bench;
#[path = "emulator/faults.rs"]
mod faults;
#[path = "emulator/kin.rs"]
mod kin;
#[path = "emulator/memory.rs"]
mod memory;
#[path = "emulator/probing.rs"]
mod probing;
#[path = "emulator/states.rs"]
mod states;
#[path = "emulator/transcript.rs"]
mod transcript;
#[path = "emulator/truth.rs"]
mod truth;
