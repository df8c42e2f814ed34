//! A sender killed at random moments leaves a journal that can be read, and loses nothing it had written.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::Duration;

use furbelow::stream::{Board, Head, Journal, Mark, Note, Progress, Reached, Standing};

/// Kills.
const KILLS: u64 = 200;

/// Says to the writer below where to write.
const FOLDER: &str = "FURBELOW_TEST_JOURNAL";

/// A fast place for many small files: it is the kills that are tried, not the disk.
fn scratch() -> tempfile::TempDir {
    let memory = std::path::Path::new("/dev/shm");
    let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    folder.expect("a folder")
}

/// No test by itself: started by the one below it writes notes until it is killed, and says which it has written.
#[test]
fn the_writer_that_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let head = Head::new("job.nc", "diode-400", "emulator", &Board::default());
    let lines = (0..200).map(|k| Ok(format!("G1X{k}")));
    let (mut recorder, _) = Journal::at(folder).begin(head, lines, None).expect("begun");
    for n in 0.. {
        let reached = Some(Reached { line: n + 1, along_mm: 0.5 });
        let progress = Progress { sent: n + 30, acked: n + 15, executed: n, reached };
        let mark = if n % 50 == 49 { Mark::Trouble } else { Mark::Progress };
        recorder.note(&Note::new(mark, n as f64, progress)).expect("noted");
        println!("noted {n}");
    }
}

#[test]
fn a_sender_killed_at_any_moment_leaves_a_journal_that_tells_all_it_had_written() {
    let folder = scratch();
    let journal = Journal::at(folder.path().join("jobs"));
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    let (mut begun, mut most) = (0, 0);
    for kill in 0..KILLS {
        let mut writer = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "the_writer_that_is_killed", "--nocapture"])
            .env(FOLDER, journal.folder())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("runs");
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let mut told = BufReader::new(writer.stdout.take().expect("piped")).lines();
        // Some are killed before they have begun, most in the middle of their notes.
        let wait_for_it = kill % 8 != 0;
        let mut last = None;
        if wait_for_it {
            let first = told.find(|line| line.as_ref().is_ok_and(|line| line.ends_with("noted 0")));
            assert!(first.is_some(), "it begins");
            last = Some(0);
        }
        std::thread::sleep(Duration::from_micros(random % 12_000));
        writer.kill().expect("killed");
        writer.wait().expect("gone");
        let noted = told.map_while(Result::ok).filter_map(|line| line.rsplit_once("noted ")?.1.parse::<usize>().ok());
        last = noted.last().or(last);
        let records = journal.records().expect("it can be read");
        let unborn = journal.stillborn().expect("it can be read");
        begun += records.len();
        if let Some(last) = last {
            let record = records.last().expect("it began");
            assert_eq!(record.standing, Standing::Interrupted);
            let executed = record.progress().executed;
            assert!(executed >= last, "kill {kill}: {last} were noted, {executed} are told");
            assert!(record.program().is_ok() && record.head.lines == 200);
            most = most.max(executed);
        }
        for number in records.iter().map(|record| record.number).chain(unborn) {
            journal.remove(number).expect("removed");
        }
    }
    println!("{KILLS} kills, {begun} jobs had begun, up to {most} notes each");
    assert!(begun as u64 >= KILLS * 7 / 8 && most > 500, "{begun} {most}");
}
