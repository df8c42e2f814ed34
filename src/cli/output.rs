//! Text and JSON on stdout, written so that a closed pipe is an error value and not a panic.

use std::io::{Read, Write};

use serde::Serialize;

use super::Failure;
use crate::config::{Kind, Library};

/// Writes one JSON object and a newline.
pub(super) fn json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(Failure::config)?;
    line(&text)
}

/// Writes a text and a newline.
pub(super) fn line(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{text}")?;
    stdout.flush()?;
    Ok(())
}

/// Lines up columns; the last one is left ragged. The first row is the heading.
pub(super) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|c| c.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// A row of a table of two columns.
pub(super) fn fact(name: &str, value: impl Into<String>) -> Vec<String> {
    vec![name.to_owned(), value.into()]
}

/// What to do before a job, as a list to tick off; `None` when there is nothing to do.
pub(super) fn checklist_text(steps: &[String]) -> Option<String> {
    let lines: Vec<_> = steps.iter().map(|step| format!("  [ ] {step}")).collect();
    (!lines.is_empty()).then(|| format!("\nbefore every job:\n{}", lines.join("\n")))
}

/// Writes that list.
pub(super) fn checklist(steps: &[String]) -> Result<(), Failure> {
    checklist_text(steps).map_or(Ok(()), |text| line(&text))
}

/// Says where a user's own files go.
pub(super) fn own_folder(library: &Library, kind: Kind) -> Result<(), Failure> {
    match library.folder(kind) {
        Some(folder) => line(&format!("\nyour own: NAME.toml in {}, or give a path", folder.display())),
        None => line("\nyour own: give the path of a .toml file"),
    }
}

/// "1 sheet", "3 sheets".
pub(super) fn count(n: usize, noun: &str) -> String {
    if n == 1 { format!("1 {noun}") } else { format!("{n} {noun}s") }
}

/// A share of 1 as people say it: 0.35 is 35 %.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", number(share * 100.0))
}

/// A file's text, or stdin's for `-`, with the name messages call it by.
pub(super) fn read_argument(argument: &str) -> Result<Option<(&'static str, String)>, Failure> {
    if argument != "-" {
        return Ok(None);
    }
    let mut text = String::new();
    std::io::stdin().lock().read_to_string(&mut text)?;
    Ok(Some(("<stdin>", text)))
}

/// A number without trailing zeros: 297, 0.15.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".to_owned(),
        short => short.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_and_lines_end_clean() {
        let rows = [vec!["NAME".into(), "W".into()], vec!["µ".into(), "10".into()], vec!["k40".into(), String::new()]];
        assert_eq!(table(&rows), "NAME  W\nµ     10\nk40");
    }

    #[test]
    fn numbers_drop_what_says_nothing() {
        assert_eq!([297.0, 0.15, -0.0004, 100.0].map(number), ["297", "0.15", "0", "100"]);
    }
}
