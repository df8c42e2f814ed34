//! `furbelow calibrate`: test cards, and what they tell about a material on a machine.

use std::io::{BufRead, IsTerminal, Write};
use std::path::PathBuf;

use serde_json::json;

use super::make::quoted;
use super::output::{checklist_text, json, line};
use super::profile_set::save;
use super::today::today;
use super::{Exit, Failure};
use crate::calibrate::{Answers, Kind};
use crate::config::Library;
use crate::job;

/// What to find out.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Everything a new material needs on one A5 card, in less than five minutes: power, kerf, joint, lettering, stiffness
    Start(Args),
    /// How wide the cut is
    Kerf(Args),
    /// Which power and feed cut cleanly
    Power(Args),
    /// How long the slits of the joint have to be
    Joint(Args),
    /// How stiff the sheet is, from how a strip of it hangs
    Stiffness(Args),
}

/// Arguments of every card.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Machine to measure on (see `furbelow machine list`), or a path
    #[arg(short, long)]
    machine: String,
    /// Material to measure (see `furbelow profile list`), or a path
    #[arg(short = 'p', long, alias = "profile")]
    material: String,
    /// Folder for the card's files
    #[arg(short, long, value_name = "DIR", default_value = "calibrate")]
    out: PathBuf,
    /// The card is cut: ask what came of it, and write that into the profile
    #[arg(long)]
    ask: bool,
    /// An answer, such as gap=1.65, instead of being asked; may be given several times
    #[arg(long, value_name = "KEY=VALUE", conflicts_with = "ask")]
    answer: Vec<String>,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    let (kind, args) = match command {
        Command::Start(args) => (Kind::Start, args),
        Command::Kerf(args) => (Kind::Kerf, args),
        Command::Power(args) => (Kind::Power, args),
        Command::Joint(args) => (Kind::Joint, args),
        Command::Stiffness(args) => (Kind::Stiffness, args),
    };
    let library = Library::open();
    let test = job::test_card(kind, &args.machine, &args.material, &library)?;
    if args.ask {
        let answers = ask(&test)?;
        return learn(kind, &args, &answers, &library);
    }
    if !args.answer.is_empty() {
        let pair = |text: &String| match text.split_once('=') {
            Some((key, value)) => Ok((key.trim().to_owned(), value.trim().to_owned())),
            None => Err(Failure::config(format!("`{text}` answers nothing; write it as key=value, such as gap=1.65"))),
        };
        let answers = Answers(args.answer.iter().map(pair).collect::<Result<_, _>>()?);
        return learn(kind, &args, &answers, &library);
    }
    write(kind, &args, &test)
}

/// Writes the card's files and says what to do with them.
fn write(kind: Kind, args: &Args, test: &job::TestCard) -> Result<(), Failure> {
    let failed = |path: &std::path::Path| {
        let path = path.display().to_string();
        move |e: std::io::Error| Failure::config(format!("{path}: {e}"))
    };
    std::fs::create_dir_all(&args.out).map_err(failed(&args.out))?;
    for (name, bytes) in &test.files {
        let path = args.out.join(name);
        let mut file = tempfile::NamedTempFile::new_in(&args.out).map_err(failed(&path))?;
        file.write_all(bytes).map_err(failed(&path))?;
        file.persist(&path).map_err(|e| failed(&path)(e.error))?;
    }
    if args.json {
        let questions: Vec<_> =
            test.card.questions.iter().map(|asked| json!({ "key": asked.key(), "question": asked.text() })).collect();
        let files: Vec<_> = test.files.iter().map(|(name, _)| args.out.join(name)).collect();
        return json(&json!({ "card": kind.word(), "files": files, "time_s": test.time_s, "questions": questions }));
    }
    let program = args.out.join(&test.program);
    line(&format!(
        "wrote {} files to {}: a card of {} x {} mm, {} on {}",
        test.files.len(),
        args.out.display(),
        test.card.width_mm,
        test.card.height_mm,
        test.time(),
        args.machine,
    ))?;
    if let Some(list) = checklist_text(&test.setup) {
        line(&list)?;
    }
    line(&format!(
        "\ncut it:        furbelow send {} -m {} --port PORT\nthen tell it:  furbelow calibrate {} -m {} -p {} --ask",
        quoted(&program),
        args.machine,
        kind.word(),
        args.machine,
        args.material,
    ))
}

/// Puts the questions and reads a line for each; an empty one leaves things as they are.
fn ask(test: &job::TestCard) -> Result<Answers, Failure> {
    let mut lines = std::io::stdin().lock().lines();
    let talks = std::io::stdin().is_terminal();
    let mut answers = Answers::default();
    for asked in &test.card.questions {
        eprint!("{}{}: ", asked.text(), if talks { "\n  (Enter: not measured)" } else { "" });
        std::io::stderr().flush()?;
        let Some(answer) = lines.next().transpose()? else { break };
        if !talks {
            eprintln!("{answer}");
        }
        answers.0.push((asked.key().to_owned(), answer));
    }
    Ok(answers)
}

/// Writes what was found into the user's own profile.
fn learn(kind: Kind, args: &Args, answers: &Answers, library: &Library) -> Result<(), Failure> {
    let machine = library.machine(&args.machine)?;
    let source = format!("measured {} {}", today(), machine.name);
    let learnt = job::learnt(kind, &args.machine, &args.material, answers, &source, library)?;
    if learnt.changes.values.is_empty() {
        return Err(Failure {
            exit: Exit::Refused,
            source: "nothing was measured, so nothing was changed; if no square fell out or no slit held, try `calibrate power` or `calibrate joint`".into(),
        });
    }
    let path = save(library, &args.material, Some(&machine), &learnt.changes)?;
    if args.json {
        let values: serde_json::Map<_, _> = learnt.changes.values.iter().map(|(k, v)| (k.clone(), json!(v))).collect();
        return json(&json!({ "wrote": path, "source": source, "values": values }));
    }
    for told in &learnt.told {
        line(told)?;
    }
    line(&format!("\nwrote {}", quoted(&path)))
}
