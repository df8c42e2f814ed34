//! `furbelow ports`: where a board may hang, what answers there, and an emulated board for other programs.

use serde_json::json;

use super::connection::{open_at, wait_until_asked};
use super::{Failure, output};
use crate::stream::{Listed, list_ports};

/// Arguments of `ports`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Open each port and say what answers there; most boards start anew when that is done
    #[arg(long)]
    ask: bool,
    /// Bits a second at which boards are asked
    #[arg(long, value_name = "BAUD", default_value_t = 115_200, requires = "ask")]
    baud: u32,
    /// Serve an emulated GRBL board on a pseudo-terminal, for any sender, until Ctrl-C
    #[cfg(unix)]
    #[arg(long, conflicts_with = "ask")]
    emulator: bool,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    #[cfg(unix)]
    if args.emulator {
        return serve(args.json);
    }
    let ports = list_ports()?;
    let answers: Option<Vec<String>> = args.ask.then(|| ports.iter().map(|port| answer(port, args.baud)).collect());
    if args.json {
        return output::json(&json!({ "ports": ports, "answers": answers }));
    }
    if ports.is_empty() {
        return output::line("no serial port found; a board on the network is tcp:HOST");
    }
    let mut rows = vec![["PORT", "STAYS THE SAME", "WHAT"].map(str::to_owned).to_vec()];
    rows.extend(ports.into_iter().map(|port| vec![port.path, port.stable.unwrap_or_default(), port.what]));
    if let Some(answers) = answers {
        rows[0].push("ANSWERS".to_owned());
        rows[1..].iter_mut().zip(answers).for_each(|(row, answer)| row.push(answer));
    }
    output::line(&output::table(&rows))
}

/// What says something at a port, or why nothing does.
fn answer(port: &Listed, baud: u32) -> String {
    let asked = || {
        let link = open_at(&port.path, baud)?;
        wait_until_asked(&link, &mut Vec::new(), false)
    };
    match asked() {
        Ok((board, status)) => format!("{} {}, {}", board.firmware.title(), board.version, status.state.word()),
        Err(failure) => failure.chain().map(ToString::to_string).collect::<Vec<String>>().join(": "),
    }
}

/// Keeps an emulated board on a pseudo-terminal.
#[cfg(unix)]
fn serve(json: bool) -> Result<(), Failure> {
    let served = crate::stream::ServedBoard::emulator().map_err(Failure::config)?;
    let path = served.path().display().to_string();
    let (stop, stopped) = std::sync::mpsc::channel();
    // A second Ctrl-C finds nobody waiting any more.
    ctrlc::set_handler(move || _ = stop.send(())).map_err(Failure::config)?;
    if json {
        output::json(&json!({ "port": path }))?;
    } else {
        output::line(&format!("an emulated GRBL 1.1 board (Ctrl-C ends it): {path}"))?;
    }
    // The handler lives as long as the program: there is no other end.
    let _ = stopped.recv();
    drop(served);
    Ok(())
}
