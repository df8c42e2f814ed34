//! `furbelow home`: drives to the homing switches, or unlocks a machine after an alarm.

use serde_json::json;

use super::connection::{Where, failed, refused};
use super::talk::{Answer, OnInterrupt, Talk};
use super::{Failure, output};
use crate::stream::{Command, State};

/// Arguments of `home`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    at: Where,
    /// Do not seek the switches: unlock after an alarm, when you are sure that the head stands where the board thinks ($X). A board that answers
    /// nothing is reset, which ends whatever it is doing
    #[arg(long)]
    unlock: bool,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let machine = args.at.machine()?;
    let mut talk = Talk::open_with(&args.at.port, machine.controller.baud, args.unlock)?;
    if args.unlock {
        unlock(&mut talk)?;
    } else if !home(&mut talk, &machine.name)? {
        eprintln!("homing was broken off: the position is lost; home again");
        talk.leave_stopped();
    }
    talk.wait_for_rest()?;
    if args.json {
        let mut object = talk.place_json();
        object["homed"] = json!(!args.unlock);
        return output::json(&object);
    }
    output::line(&format!("{}: {}", if args.unlock { "unlocked" } else { "homed" }, talk.place()))
}

/// Seeks the switches; false when the user has broken it off.
pub(super) fn home(talk: &mut Talk, machine: &str) -> Result<bool, Failure> {
    if !talk.homes() {
        return Err(refused(format!(
            "{machine}'s board has no homing switches ($22=0): move the head to the sheet's corner with `furbelow jog`, then make that work zero with `furbelow jog --zero`"
        )));
    }
    talk.on_interrupt(OnInterrupt::Reset);
    let answer = talk.insist(Command::Home)?;
    talk.on_interrupt(OnInterrupt::Leave);
    Ok(answer != Answer::Interrupted)
}

fn unlock(talk: &mut Talk) -> Result<(), Failure> {
    if talk.status.state == State::Sleep {
        // It swallows lines until it starts anew.
        talk.reset()?;
        talk.wait_for_rest()?;
    }
    match talk.status.state {
        State::Alarm => talk.insist(Command::Unlock).map(drop)?,
        State::Idle => {}
        state => {
            return Err(failed(format!(
                "the machine is not locked but in {}: there is nothing to unlock",
                state.word()
            )));
        }
    }
    eprintln!(
        "the board keeps the position it had: if the head was moved, or steps were lost in a reset while moving, home it or zero it again"
    );
    Ok(())
}
