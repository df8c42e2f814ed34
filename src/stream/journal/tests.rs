//! The journal on a real disk.

use super::*;
use crate::stream::{Board, Ending, Outcome, Progress, Reached, Trouble};

fn begun(journal: &Journal) -> Recorder {
    let head = Head::new("job/sheets/sheet-01.nc", "diode-400", "/dev/ttyUSB0", &Board::default());
    let lines = ["G21G90", "M4S0", "G0X1", "G1X2S100F600"].map(|line| Ok(line.to_owned()));
    journal.begin(head, lines.into_iter(), None).unwrap().0
}

fn scratch() -> (tempfile::TempDir, Journal) {
    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::at(folder.path().join("jobs"));
    (folder, journal)
}

fn progress(executed: usize) -> Progress {
    let reached = Some(Reached { line: executed + 1, along_mm: 0.125 });
    Progress { sent: executed + 20, acked: executed + 10, executed, reached }
}

fn ending(outcome: Outcome) -> Ending {
    Ending { outcome, progress: progress(30), maybe: 50, position_kept: true, beam_off: true }
}

#[test]
fn what_was_noted_is_read_back_and_the_program_is_a_copy() {
    let (_folder, journal) = scratch();
    assert!(journal.records().unwrap().is_empty(), "a journal that is not there is empty");
    let mut recorder = begun(&journal);
    recorder.note(&Note::new(Mark::Progress, 1.2345, progress(7))).unwrap();
    let running = journal.record(1).unwrap();
    assert_eq!((running.standing, running.progress()), (Standing::Running, progress(7)));
    assert!(matches!(journal.remove(1), Err(JournalError::Running { number: 1 })));
    recorder.note(&Note::of_ending(2.0, &ending(Outcome::Stopped))).unwrap();
    drop(recorder);
    let record = journal.record(1).unwrap();
    assert_eq!((record.standing, record.maybe(), record.position_kept()), (Standing::Stopped, 50, true));
    assert_eq!((record.head.lines, record.head.machine.as_str()), (4, "diode-400"));
    assert_eq!(fs::read_to_string(record.program().unwrap()).unwrap(), "G21G90\nM4S0\nG0X1\nG1X2S100F600\n");
    assert!(record.message().unwrap().contains("lines up to 30"));
    assert_eq!(begun(&journal).number(), 2);
    record.resumed(2).unwrap();
    let record = journal.record(1).unwrap();
    assert_eq!((record.standing, record.resumed_by(), record.maybe()), (Standing::Resumed, Some(2), 50));
    journal.remove(1).unwrap();
    assert!(matches!(journal.record(1), Err(JournalError::NoSuchJob { .. })));
}

#[test]
fn a_sender_that_is_gone_without_a_word_leaves_an_interrupted_job() {
    let (_folder, journal) = scratch();
    let mut recorder = begun(&journal);
    recorder.note(&Note::new(Mark::Progress, 1.0, progress(3))).unwrap();
    drop(recorder);
    let record = journal.record(1).unwrap();
    assert_eq!((record.standing, record.maybe()), (Standing::Interrupted, 23));
    // What power loss leaves of a last line, and of a folder.
    let log = journal.folder().join("0001/log");
    let whole = fs::read(&log).unwrap();
    fs::write(&log, [whole.as_slice(), b"{\"mark\":\"progr\0\0\xff"].concat()).unwrap();
    assert_eq!(journal.record(1).unwrap(), record);
    record.resumed(9).unwrap();
    assert_eq!(journal.record(1).unwrap().resumed_by(), Some(9), "a torn line hides none that follows");
    fs::create_dir(journal.folder().join("0007")).unwrap();
    assert_eq!((journal.records().unwrap().len(), journal.stillborn().unwrap()), (1, vec![7]));
}

#[test]
fn a_job_that_cannot_be_taken_up_leaves_nothing_to_go_on_with() {
    let (_folder, journal) = scratch();
    drop(begun(&journal));
    let before = journal.record(1).unwrap();
    let log = journal.folder().join("0001/log");
    let noted = fs::read(&log).unwrap();
    fs::remove_file(&log).unwrap();
    let head = || Head::new("job/sheets/sheet-01.nc", "diode-400", "/dev/ttyUSB0", &Board::default());
    let begin = |line: std::io::Result<String>| journal.begin(head(), [line].into_iter(), Some(&before));
    assert!(begin(Ok("G0X1".to_owned())).is_err(), "the job before cannot be told");
    fs::write(&log, noted).unwrap();
    assert!(begin(Err(std::io::Error::other("the file is gone"))).is_err());
    assert_eq!((journal.records().unwrap(), journal.stillborn().unwrap()), (vec![before.clone()], vec![]));
    assert!(begin(Ok("G0X1".to_owned())).is_ok());
    assert_eq!(journal.record(1).unwrap().resumed_by(), Some(2));
}

#[test]
fn a_job_of_which_nothing_is_left_is_done() {
    let (_folder, journal) = scratch();
    let mut recorder = begun(&journal);
    recorder.note(&Note::of_ending(2.0, &ending(Outcome::Stopped))).unwrap();
    drop(recorder);
    journal.record(1).unwrap().finished().unwrap();
    let record = journal.record(1).unwrap();
    assert_eq!((record.standing, record.progress()), (Standing::Done, progress(30)));
    assert_eq!(record.message(), Some("nothing was left to cut"));
}

#[test]
fn trouble_that_may_have_spoilt_something_marks_the_job() {
    let (_folder, journal) = scratch();
    let mut recorder = begun(&journal);
    let trouble = Trouble::OffPlan { off_mm: 1.5, line: 12 };
    recorder.note(&Note::of_trouble(1.0, &trouble, progress(10))).unwrap();
    recorder.note(&Note::of_ending(1.1, &ending(Outcome::Failed(trouble)))).unwrap();
    drop(recorder);
    assert_eq!(journal.record(1).unwrap().standing, Standing::Damaged);
    let mut recorder = begun(&journal);
    recorder.note(&Note::of_ending(1.1, &ending(Outcome::Failed(Trouble::Silent(2.0))))).unwrap();
    drop(recorder);
    let record = journal.record(2).unwrap();
    assert_eq!((record.standing, record.position_lost()), (Standing::Failed, false));
    let mut recorder = begun(&journal);
    let lost = Ending { position_kept: false, ..ending(Outcome::Stopped) };
    recorder.note(&Note::of_ending(1.1, &lost)).unwrap();
    drop(recorder);
    let record = journal.record(3).unwrap();
    assert!(record.position_lost());
    record.resumed(4).unwrap();
    assert!(journal.record(3).unwrap().position_lost(), "that another went on with it changes nothing");
}

#[test]
fn a_long_job_takes_no_more_room_than_a_short_one_and_forgets_nothing_that_matters() {
    let (_folder, journal) = scratch();
    let mut recorder = begun(&journal);
    recorder.note(&Note::of_trouble(0.5, &Trouble::Locked, progress(1))).unwrap();
    for n in 0..5000 {
        recorder.note(&Note::new(Mark::Progress, n as f64, progress(n))).unwrap();
        if n % 500 == 0 {
            assert!(fs::metadata(journal.folder().join("0001/log")).unwrap().len() < 70_000);
            assert_eq!(journal.record(1).unwrap().progress(), progress(n));
        }
    }
    let record = journal.record(1).unwrap();
    assert_eq!((record.notes[0].mark, record.notes[1].mark), (Mark::Begun, Mark::Trouble));
}

#[test]
fn a_copy_that_was_changed_is_not_sent_again() {
    let (_folder, journal) = scratch();
    drop(begun(&journal));
    fs::write(journal.folder().join("0001/program.nc"), "G0X400\n").unwrap();
    let error = journal.record(1).unwrap().program().unwrap_err().to_string();
    assert!(error.contains("no longer what was sent"), "{error}");
    assert!(journal.record(1).unwrap().is_other_board(&Board { settings: [(30, 255.0)].into(), ..Board::default() }));
}
