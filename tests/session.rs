//! A session against the emulated board, both on virtual time: nothing is lost or doubled unnoticed, and the beam goes out.

#[path = "session/account.rs"]
mod account;
#[path = "session/bench.rs"]
mod bench;
#[path = "session/burn.rs"]
mod burn;
#[path = "session/kin.rs"]
mod kin;
#[path = "session/measured.rs"]
mod measured;
