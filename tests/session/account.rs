//! What is told of how far a job has come, against what the board has done.

use furbelow::emulator::{BoardSettings, Personality};
use furbelow::stream::{Command, Event, Outcome};

use super::bench::Bench;

fn grblhal() -> BoardSettings {
    BoardSettings { personality: Personality::GrblHal, planner_blocks: 100, rx_bytes: 1023, ..BoardSettings::default() }
}

#[test]
fn grblhal_is_followed_though_it_tells_modes_of_its_own() {
    let mut bench = Bench::ready(grblhal());
    let told = |event: &Event| matches!(event, Event::Text(text) if text.contains("G49 G98 G50 M5 M9 T0 F0 S0."));
    assert!(bench.events.iter().any(told), "{:?}", bench.events);
    bench.run(&format!("G0X10Y10\nM4S0\nG1X60S300F300\n{}X70\n", "X60\n".repeat(40)));
    assert!(bench.until(30.0, |b| b.board.position_mm().x >= 14.9));
    bench.command(Command::Stop);
    assert!(bench.until(5.0, |b| b.ending.is_some()));
    let ending = bench.ending.clone().expect("ended");
    let reached = ending.progress.reached.expect("it is followed");
    assert_eq!((&ending.outcome, ending.progress.executed, reached.line), (&Outcome::Stopped, 2, 3));
    assert!((reached.along_mm + 10.0 - bench.board.position_mm().x).abs() < 0.2, "{ending:?}");
}

#[test]
fn of_a_job_nobody_can_follow_nothing_is_said_to_be_done_that_may_not_be() {
    for settings in [grblhal(), BoardSettings::default()] {
        let mut bench = Bench::ready(settings);
        // Lines that lead to where the head stands are no blocks.
        bench.run(&format!("G30\nG0X10Y10\nM4S0\nG1X60S300F300\n{}X70\n", "X60\n".repeat(40)));
        assert!(bench.until(30.0, |b| b.board.position_mm().x >= 14.9));
        bench.command(Command::Stop);
        assert!(bench.until(5.0, |b| b.ending.is_some()));
        let progress = bench.ending.clone().expect("ended").progress;
        assert!(progress.executed < 4 && progress.reached.is_none(), "{progress:?}");
    }
}

#[test]
fn sound_jobs_end_well_however_they_end() {
    for job in [
        // A circle, and a rest where it began and ended.
        "G0X60Y50\nM4S0\nG2X60Y50I-10J0S300F1500\nG4P2\nM5S0\n",
        // Zero is laid elsewhere.
        "G0X20Y0\nG92X80Y10\nG1X81F600\n",
        // Steps from where the head stands.
        "G21G91\nG1X3F900\nY3\nG90\n",
        // Home, wherever that is.
        "G0X20Y0\nG28\n",
    ] {
        let mut bench = Bench::ready(BoardSettings::default());
        bench.run("G0X7Y8\n");
        assert!(bench.until(10.0, |b| b.ending.is_some()));
        bench.ending = None;
        bench.run(job);
        assert!(bench.until(20.0, |b| b.ending.is_some()));
        assert_eq!(bench.ending.clone().expect("ended").outcome, Outcome::Done, "{job}");
    }
}

#[test]
fn a_zero_that_was_laid_before_the_job_and_is_taken_back_in_it_is_followed() {
    for settings in [grblhal(), BoardSettings::default()] {
        let mut bench = Bench::ready(settings);
        for line in ["G92X-20Y-5", "G43.1Z2"] {
            bench.command(Command::Line(line.to_owned()));
            bench.wait(0.5);
        }
        bench.run("G92.1\nG49\nG0X20Y5\nG1X60F3000\nX20\n");
        assert!(bench.until(20.0, |b| b.ending.is_some()));
        let ending = bench.ending.clone().expect("ended");
        assert_eq!(ending.outcome, Outcome::Done, "{ending:?}");
        assert_eq!(bench.board.position_mm().xy(), furbelow::geom::P2::new(20.0, 5.0));
    }
}
