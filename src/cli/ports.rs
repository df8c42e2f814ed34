//! `furbelow ports`: where a board may hang.

use serde_json::json;

use super::{Failure, output};
use crate::stream::list_ports;

/// Arguments of `ports`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let ports = list_ports()?;
    if args.json {
        return output::json(&json!({ "ports": ports }));
    }
    if ports.is_empty() {
        return output::line("no serial port found; a board on the network is tcp:HOST");
    }
    let mut rows = vec![["PORT", "STAYS THE SAME", "WHAT"].map(str::to_owned).to_vec()];
    rows.extend(ports.into_iter().map(|port| vec![port.path, port.stable.unwrap_or_default(), port.what]));
    output::line(&output::table(&rows))
}
