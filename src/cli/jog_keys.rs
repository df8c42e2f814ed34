//! Jogging by keys: arrows move by a step, other keys change the step, home, and set work zero.

use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

use console::{Key, Term};

use super::connection::{EVENT_WAIT, machine_failure};
use super::talk::{OnInterrupt, Talk};
use super::{Failure, jog};
use crate::config::Machine;
use crate::stream::{Command, Event, State, Trouble};

/// What an arrow moves, mm.
const STEPS_MM: [f64; 4] = [0.1, 1.0, 10.0, 50.0];

/// The step to begin with: 10 mm.
const FIRST_STEP: usize = 2;

/// How long to wait for the board before looking for keys again.
const KEY_WAIT: Duration = Duration::from_millis(20);

const HELP: &str = "arrows move, + and - change the step, 0 goes to work zero, z makes this work zero, h homes, u unlocks, space stops, q leaves";

/// What a key asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Act {
    /// One step along x or y.
    Move([f64; 2]),
    Step(usize),
    GoToZero,
    Zero,
    Home,
    Unlock,
    Stop,
    Quit,
}

/// Jogs until the user has enough.
pub(super) fn run(mut talk: Talk, machine: &Machine, feed_mm_per_min: f64) -> Result<(), Failure> {
    let term = Term::stdout();
    term.write_line(HELP)?;
    let keys = read_keys(&term);
    talk.on_interrupt(OnInterrupt::CancelJog);
    let mut step = FIRST_STEP;
    let mut zeroed = false;
    let mut shown = String::new();
    loop {
        let line = format!("{}   step {} mm", talk.place(), STEPS_MM[step]);
        if line != shown {
            term.clear_line()?;
            term.write_str(&line)?;
            shown = line;
        }
        match talk.next(KEY_WAIT) {
            Some(Event::Trouble(trouble @ (Trouble::Link(_) | Trouble::Silent(_)))) => {
                return Err(machine_failure(trouble));
            }
            Some(Event::Trouble(trouble)) => say(&term, &mut shown, &trouble.to_string())?,
            Some(Event::Denied(reason)) => say(&term, &mut shown, reason)?,
            Some(Event::Message(message)) => say(&term, &mut shown, &message)?,
            Some(Event::Answered { error: Some(code), .. }) => say(&term, &mut shown, &talk.explained(code))?,
            Some(_) | None => {}
        }
        let (pressed, ended) = pressed(&keys);
        let act = match next_act(pressed.iter().filter_map(|key| act(key, step))) {
            _ if ended || talk.interrupted() => Act::Quit,
            Some(act) => act,
            None => continue,
        };
        match act {
            Act::Quit => break,
            Act::Step(next) => step = next,
            Act::Stop => talk.command(Command::JogCancel),
            _ if !matches!(talk.status.state, State::Idle | State::Alarm) => {}
            Act::Move(way) => {
                let [dx_mm, dy_mm] = jog::clamped(&talk, machine, way);
                if dx_mm == 0.0 && dy_mm == 0.0 {
                    say(&term, &mut shown, "the machine's travel ends here")?;
                } else if let Err(failure) = start(&mut talk, Command::Jog { dx_mm, dy_mm, feed_mm_per_min }) {
                    say(&term, &mut shown, &failure.source.to_string())?;
                }
            }
            Act::GoToZero => {
                talk.command(Command::JogTo { x_mm: Some(0.0), y_mm: Some(0.0), feed_mm_per_min });
            }
            Act::Zero => {
                jog::zero_here(&mut talk)?;
                zeroed = true;
                say(&term, &mut shown, "work zero is here")?;
            }
            Act::Home => home(&mut talk, &term, &mut shown)?,
            Act::Unlock => talk.command(Command::Unlock),
        }
    }
    talk.command(Command::JogCancel);
    talk.wait_for_rest()?;
    say(&term, &mut shown, &talk.place())?;
    let away = talk.status.work_mm.is_some_and(|[x, y, _]| x.hypot(y) > 0.05);
    if !talk.homes() && (zeroed || away) {
        // A board that restarts when its port is opened takes where the head stands for machine zero.
        term.write_line(
            "without switches many boards forget the position when the port is opened again: leave the head at the sheet's corner and say `furbelow jog --zero` there before you send",
        )?;
    }
    if talk.interrupted() {
        talk.leave_stopped();
    }
    Ok(())
}

/// Gives a jog and waits until the board has taken it, so that the next key finds it moving.
fn start(talk: &mut Talk, command: Command) -> Result<(), Failure> {
    talk.insist(command)?;
    // One report tells that it moves, or that it is there already.
    while !matches!(talk.next(EVENT_WAIT), Some(Event::Status(..)) | None) {}
    Ok(())
}

/// Seeks the switches; keys wait meanwhile, Ctrl-C breaks it off.
fn home(talk: &mut Talk, term: &Term, shown: &mut String) -> Result<(), Failure> {
    if !talk.homes() {
        return say(term, shown, "this machine has no homing switches ($22=0): z sets work zero");
    }
    say(term, shown, "homing; Ctrl-C breaks it off")?;
    talk.on_interrupt(OnInterrupt::Reset);
    if let Err(failure) = talk.insist(Command::Home) {
        say(term, shown, &failure.source.to_string())?;
    }
    talk.on_interrupt(OnInterrupt::CancelJog);
    Ok(())
}

fn say(term: &Term, shown: &mut String, text: &str) -> Result<(), Failure> {
    term.clear_line()?;
    term.write_line(text)?;
    shown.clear();
    Ok(())
}

/// Keys as they are pressed; ends with the terminal, or with Ctrl-C.
fn read_keys(term: &Term) -> Receiver<Key> {
    let (pressed, keys) = mpsc::channel();
    let term = term.clone();
    std::thread::spawn(move || {
        while let Ok(key) = term.read_key() {
            if pressed.send(key).is_err() {
                break;
            }
        }
    });
    keys
}

/// Keys since the last look, and whether there will be no more.
fn pressed(keys: &Receiver<Key>) -> (Vec<Key>, bool) {
    let mut pressed = Vec::new();
    loop {
        match keys.try_recv() {
            Ok(key) => pressed.push(key),
            Err(end) => return (pressed, end == mpsc::TryRecvError::Disconnected),
        }
    }
}

/// What to do of what was asked since the last look. A key held down repeats faster than the machine moves: one move of a row is made, so that
/// the head stops when the key is let go, and anything else goes first.
fn next_act(asked: impl Iterator<Item = Act>) -> Option<Act> {
    let mut last = None;
    for act in asked {
        match act {
            Act::Move(_) => last = Some(act),
            other => return Some(other),
        }
    }
    last
}

fn act(key: &Key, step: usize) -> Option<Act> {
    let by = STEPS_MM[step];
    Some(match key {
        Key::ArrowLeft => Act::Move([-by, 0.0]),
        Key::ArrowRight => Act::Move([by, 0.0]),
        Key::ArrowUp => Act::Move([0.0, by]),
        Key::ArrowDown => Act::Move([0.0, -by]),
        Key::PageUp | Key::Char('+' | '=') => Act::Step((step + 1).min(STEPS_MM.len() - 1)),
        Key::PageDown | Key::Char('-') => Act::Step(step.saturating_sub(1)),
        Key::Char('0') => Act::GoToZero,
        Key::Char('z') => Act::Zero,
        Key::Char('h') => Act::Home,
        Key::Char('u') => Act::Unlock,
        Key::Char(' ') | Key::Escape => Act::Stop,
        Key::Char('q') => Act::Quit,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_move_by_the_step_and_the_step_stays_in_its_list() {
        assert_eq!(act(&Key::ArrowLeft, 1), Some(Act::Move([-1.0, 0.0])));
        assert_eq!(act(&Key::ArrowUp, 3), Some(Act::Move([0.0, 50.0])));
        assert_eq!(act(&Key::Char('+'), 3), Some(Act::Step(3)));
        assert_eq!(act(&Key::Char('-'), 0), Some(Act::Step(0)));
        assert_eq!(act(&Key::Char('x'), 2), None);
    }

    #[test]
    fn a_key_held_down_makes_one_move_at_a_time_and_a_stop_goes_first() {
        let moves = || (1..9).map(|k| Act::Move([f64::from(k), 0.0]));
        assert_eq!(next_act(moves()), Some(Act::Move([8.0, 0.0])));
        assert_eq!(next_act(moves().chain([Act::Stop])), Some(Act::Stop));
        assert_eq!(next_act(std::iter::empty()), None);
    }
}
