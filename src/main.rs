//! The `furbelow` program: reads the command line, runs one command, tells failures on stderr and by the exit code.

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use furbelow::cli::{Cli, Failure};
use tracing_subscriber::EnvFilter;

fn main() -> ExitCode {
    log_to_stderr();
    // clap itself prints help and usage errors, and ends with 0 or 2.
    let cli = Cli::parse();
    tracing::debug!(?cli, "asked for");
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        // `furbelow ... | head`: the reader has seen enough.
        Err(failure) if failure.is_broken_pipe() => ExitCode::SUCCESS,
        Err(failure) => {
            tell(&failure);
            failure.exit.into()
        }
    }
}

/// The failure and its causes on stderr, one line each. Each cause is told once, though errors often repeat theirs.
fn tell(failure: &Failure) {
    let mut told = String::new();
    for error in failure.chain() {
        let message = error.to_string();
        if told.is_empty() {
            told = message;
        } else if !told.contains(&message) {
            told = format!("{told}: {message}");
        }
    }
    // Nobody is left to tell when stderr is gone too.
    let _ = std::io::Write::write_all(&mut std::io::stderr(), format!("furbelow: {told}\n").as_bytes());
}

/// Diagnostics for developers, only when RUST_LOG asks for them.
fn log_to_stderr() {
    let colour = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty());
    tracing_subscriber::fmt()
        .with_env_filter(EnvFilter::from_default_env())
        .with_writer(std::io::stderr)
        .with_ansi(colour)
        .init();
}
