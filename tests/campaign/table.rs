//! What came of all runs, as a table for people.

use std::collections::BTreeMap;

use super::play::{Kin, Kind, Run};

/// The table in Markdown: a row for every fault and board.
pub fn table(runs: &[Run]) -> String {
    let mut text = String::from(
        "| fault | board | runs | what came of it | behind, lines | astray, mm | lit late, ms | cut twice, mm |\n|---|---|---|---|---|---|---|---|\n",
    );
    for kind in Kind::ALL {
        for kin in Kin::ALL {
            let those: Vec<&Run> = runs.iter().filter(|run| run.kind == kind && run.kin == kin).collect();
            if those.is_empty() {
                continue;
            }
            let mut outcomes: BTreeMap<&str, usize> = BTreeMap::new();
            for run in &those {
                let outcome = if run.escaped { "**done, and not as planned**" } else { run.outcome.as_str() };
                *outcomes.entry(outcome).or_default() += 1;
            }
            let mut outcomes: Vec<(&str, usize)> = outcomes.into_iter().collect();
            outcomes.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
            let outcomes: Vec<String> = outcomes.iter().map(|(what, count)| format!("{what} {count}")).collect();
            let most = |value: fn(&Run) -> f64| those.iter().map(|run| value(run)).fold(0.0, f64::max);
            let twice = those.iter().filter_map(|run| run.twice_mm).reduce(f64::max);
            text += &format!(
                "| {} | {} | {} | {} | {} | {:.2} | {:.0} | {} |\n",
                kind.title(),
                kin.title(),
                those.len(),
                outcomes.join(", "),
                those.iter().map(|run| run.behind).max().unwrap_or(0),
                most(|run| run.stray_mm),
                1e3 * most(|run| run.lit_late_s),
                twice.map_or("-".to_owned(), |mm| format!("{mm:.2}")),
            );
        }
    }
    text
}
