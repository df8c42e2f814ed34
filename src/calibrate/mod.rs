//! Test cards: what to cut to find out how this material behaves on this machine, what to look at afterwards, and what the answers mean.
//!
//! Card frame: x right, y up, origin bottom left, mm; the card is cut from the corner of a sheet and x lies along the sheet's length.
//!
//! ```text
//! Shop --card--> Card (drawings, trials, questions) --cut, looked at--> answers --findings--> what goes into the profile
//! ```

mod answers;
mod card;
mod error;
mod hanging;
mod samples;
mod shop;

pub use answers::{Answers, Asked, Finding, findings};
pub use card::{Card, Kind, Sample, card};
pub use error::Error;
pub use hanging::flexural_rigidity_n_mm;
pub use shop::{Setting, Shop};
