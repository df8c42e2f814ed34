//! Changes a profile's text value by value, so that comments, order and the way things are put stay.

use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, Value};

use super::error::{Error, Kind};
use super::library::Library;
use super::machine::Machine;
use super::process::nearest_row;
use super::profile::{ProcessKind, ProcessRow, Profile};

/// What to change in a profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Changes {
    /// Keys with their tables before them ("joint.laser.slit_extra_mm") and values as TOML puts them; a bare word is a text. `cut.` and `engrave.` name the process
    /// row of the machine.
    pub values: Vec<(String, String)>,
    /// Where the values come from.
    pub source: String,
}

/// Where `source` of a key is written: the first entry that the key begins with.
const SOURCES: [(&str, &str); 6] = [
    ("flexural_rigidity_", "flexural_rigidity_source"),
    ("membrane_stiffness_n_per_mm", "membrane_stiffness_source"),
    ("joint.laser.", "joint.laser.source"),
    ("joint.knife.", "joint.knife.source"),
    ("splice.", "splice.source"),
    ("", "source"),
];

impl Library {
    /// The text of profile `name` with `changes` in it, and checked. It begins as the user's own file or as a copy of the built-in one. `machine` is whose process
    /// rows `cut.` and `engrave.` mean; a row it has not yet is made of the one it goes by.
    ///
    /// # Errors
    /// [`Error::Unknown`], [`Error::Read`]; [`Error::NeedsMachine`] for a process without a machine; [`Error::Invalid`] when the result is not in order.
    pub fn changed_profile(&self, name: &str, machine: Option<&Machine>, changes: &Changes) -> Result<String, Error> {
        let profile = self.profile(name)?;
        let (file, text) = self.text(Kind::Profile, name)?;
        let mut document: DocumentMut = text.parse().map_err(|source| Error::Toml { file: file.clone(), source })?;
        for (key, value) in &changes.values {
            let value = as_value(value);
            match process_key(key) {
                Some((kind, key)) => {
                    let machine = machine.ok_or_else(|| Error::NeedsMachine { key: key.to_owned() })?;
                    let row = row(&mut document, &profile, machine, kind)?;
                    put(row, key, value);
                    put(row, "source", changes.source.as_str().into());
                }
                None => {
                    put_at(&mut document, key, value, &file)?;
                    say_source(&mut document, &profile, key, &changes.source, &file)?;
                }
            }
        }
        let text = document.to_string();
        self.profile_in(&file, text.clone())?;
        Ok(text)
    }
}

/// "cut.kerf_mm" is the key of a process row.
fn process_key(key: &str) -> Option<(ProcessKind, &str)> {
    let (table, key) = key.split_once('.')?;
    match table {
        "cut" => Some((ProcessKind::Cut, key)),
        "engrave" => Some((ProcessKind::Engrave, key)),
        _ => None,
    }
}

/// What was typed, as TOML reads it; what it does not read is a text.
fn as_value(typed: &str) -> Value {
    typed.trim().parse().unwrap_or_else(|_| typed.into())
}

/// Puts a value where one was, leaving the comments around it.
fn put(table: &mut Table, key: &str, mut value: Value) {
    match table.get_mut(key) {
        Some(Item::Value(old)) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        _ => {
            table.insert(key, Item::Value(value));
        }
    }
}

/// Puts a value into the table its key names.
fn put_at(document: &mut DocumentMut, key: &str, value: Value, file: &str) -> Result<(), Error> {
    let mut words: Vec<&str> = key.split('.').collect();
    let last = words.pop().unwrap_or(key);
    let mut table = document.as_table_mut();
    for word in words {
        let fresh = || {
            let mut table = Table::new();
            table.set_implicit(true);
            Item::Table(table)
        };
        let inner = table.entry(word).or_insert_with(fresh);
        table = inner.as_table_mut().ok_or_else(|| Error::NoTable { file: file.to_owned(), key: key.to_owned() })?;
    }
    if table.get(last).is_some_and(|item| item.is_table() || item.is_array_of_tables()) {
        return Err(Error::NoTable { file: file.to_owned(), key: key.to_owned() });
    }
    put(table, last, value);
    Ok(())
}

/// Writes where a value comes from beside it, or, for values that only the whole file's source speaks of, adds it to that.
fn say_source(document: &mut DocumentMut, profile: &Profile, key: &str, source: &str, file: &str) -> Result<(), Error> {
    let (_, at) = SOURCES.iter().find(|(start, _)| key.starts_with(start)).expect("the last entry fits every key");
    if *at != "source" {
        return put_at(document, at, source.into(), file);
    }
    if key == "source" {
        return Ok(());
    }
    let said = document.get("source").and_then(Item::as_str).unwrap_or(&profile.source);
    let others = said.split("; ").filter(|part| !part.starts_with(&format!("{key} ")));
    let whole = others.map(str::to_owned).chain([format!("{key} {source}")]).collect::<Vec<_>>().join("; ");
    put_at(document, "source", whole.into(), file)
}

/// The row that was measured on this machine, made where there is none.
fn row<'a>(
    document: &'a mut DocumentMut,
    profile: &Profile,
    machine: &Machine,
    kind: ProcessKind,
) -> Result<&'a mut Table, Error> {
    if document.get("process").is_none() {
        // A list that stands here replaces the one it is inherited from, so all of that has to stand here.
        let rows: ArrayOfTables = profile.process.iter().map(written).collect();
        document.insert("process", Item::ArrayOfTables(rows));
    }
    let rows = document.get_mut("process").and_then(Item::as_array_of_tables_mut);
    let rows = rows.ok_or_else(|| Error::NoTable { file: profile.name.clone(), key: "process".into() })?;
    let text = |table: &Table, key: &str| table.get(key).and_then(Item::as_str).map(str::to_owned);
    let its = |table: &Table| {
        text(table, "measured_on").as_deref() == Some(&machine.name)
            && text(table, "operation").as_deref() == Some(kind.word())
    };
    let found = rows.iter().position(its);
    let at = match found {
        Some(at) => at,
        None => {
            rows.push(written(&first_row(profile, machine, kind)?));
            rows.len() - 1
        }
    };
    Ok(rows.get_mut(at).expect("it was found or pushed"))
}

/// A row for a machine that has none yet: what it goes by until then.
fn first_row(profile: &Profile, machine: &Machine, kind: ProcessKind) -> Result<ProcessRow, Error> {
    let trial = machine.trial(profile)?;
    let process = match kind {
        ProcessKind::Cut => Some(trial.cut),
        ProcessKind::Engrave => trial.engrave,
    };
    let missing = || Error::NoProcess {
        machine: machine.name.clone(),
        profile: profile.name.clone(),
        class: machine.tool.class,
        tools: "tool that the profile has a row for".into(),
    };
    let (process, like) = process.zip(nearest_row(machine, profile, kind)).ok_or_else(missing)?;
    Ok(ProcessRow {
        measured_on: Some(machine.name.clone()),
        reference_power_w: machine.tool.optical_power_w,
        feed_mm_per_min: (process.feed_mm_per_min * 10.0).round() / 10.0,
        power: like.power.map(|_| (process.power * 1e4).round() / 1e4),
        ..like.clone()
    })
}

fn written(row: &ProcessRow) -> Table {
    let text = toml::to_string(row).expect("a process row holds nothing TOML cannot");
    let document: DocumentMut = text.parse().expect("what was written is TOML");
    let mut table = document.as_table().clone();
    for (mut key, item) in table.iter_mut() {
        if let Item::Table(inner) = item {
            key.leaf_decor_mut().clear();
            *item = Item::Value(Value::InlineTable(std::mem::take(inner).into_inline_table()));
        }
    }
    table.decor_mut().set_prefix("\n");
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changes(values: &[(&str, &str)]) -> Changes {
        let values = values.iter().map(|(k, v)| ((*k).into(), (*v).into())).collect();
        Changes { values, source: "measured 2026-11-22 diode-400".into() }
    }

    fn changed(values: &[(&str, &str)]) -> Result<(String, Profile), Error> {
        let library = Library::built_in();
        let machine = library.machine("diode-400")?;
        let text = library.changed_profile("paper-160", Some(&machine), &changes(values))?;
        let profile = library.profile_in("paper-160.toml", text.clone())?;
        Ok((text, profile))
    }

    #[test]
    fn a_value_changes_and_every_comment_stays() {
        let (text, profile) = changed(&[("flexural_rigidity_md_n_mm", "2.34")]).unwrap();
        assert_eq!(profile.flexural_rigidity_md_n_mm, 2.34);
        assert_eq!(profile.flexural_rigidity_source.as_deref(), Some("measured 2026-11-22 diode-400"));
        assert!(text.contains("flexural_rigidity_md_n_mm = 2.34    # 2-3.5"), "{text}");
        let before = include_str!("../../profiles/paper-160.toml");
        let comments = |text: &str| text.lines().filter(|l| l.contains('#')).count();
        assert_eq!(comments(&text), comments(before));
        assert!(changed(&[]).unwrap().0 == before);
        let (text, _) = changed(&[("joint.laser.slit_extra_mm", "1.1")]).unwrap();
        assert_eq!(comments(&text), comments(before), "{text}");
    }

    #[test]
    fn a_machine_gets_a_row_of_its_own_and_then_keeps_it() {
        let (text, profile) = changed(&[("cut.kerf_mm", "0.13"), ("cut.power", "0.55")]).unwrap();
        let own: Vec<_> = profile.process.iter().filter(|r| r.measured_on.as_deref() == Some("diode-400")).collect();
        assert_eq!(own.len(), 1);
        assert_eq!((own[0].kerf_mm, own[0].power, own[0].feed_mm_per_min), (Some(0.13), Some(0.55), 1200.0));
        assert_eq!((own[0].reference_power_w, own[0].source.as_str()), (Some(10.0), "measured 2026-11-22 diode-400"));
        assert!(own[0].bridges.is_some(), "{text}");
        let machine = Library::built_in().machine("diode-400").unwrap();
        let pairing = machine.pair(&profile).unwrap();
        assert!(pairing.cut.calibrated && pairing.cut.kerf_mm == 0.13);

        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("profiles")).unwrap();
        std::fs::write(folder.path().join("profiles/paper-160.toml"), &text).unwrap();
        let library = Library::with_folder(folder.path());
        let again = library.changed_profile("paper-160", Some(&machine), &changes(&[("cut.kerf_mm", "0.14")])).unwrap();
        assert_eq!(again.matches("measured_on").count(), 1);
        assert!(again.contains("kerf_mm = 0.14"));
    }

    #[test]
    fn a_profile_that_inherits_its_rows_gets_all_of_them() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("profiles")).unwrap();
        let text = "# mine\nschema = 1\nname = \"card\"\ninherits = \"paper-160\"\n";
        std::fs::write(folder.path().join("profiles/card.toml"), text).unwrap();
        let library = Library::with_folder(folder.path());
        let machine = library.machine("k40").unwrap();
        let values =
            changes(&[("engrave.power", "0.12"), ("joint.laser.slit_extra_mm", "1.1"), ("thickness_mm", "0.2")]);
        let text = library.changed_profile("card", Some(&machine), &values).unwrap();
        let profile = library.profile_in("card.toml", text.clone()).unwrap();
        assert!(text.starts_with("# mine\n"));
        assert_eq!(profile.process.len(), library.profile("paper-160").unwrap().process.len() + 1);
        assert_eq!((profile.joint.laser.slit_extra_mm, profile.joint.laser.neck_mm), (1.1, 8.0));
        assert!(profile.source.ends_with("; thickness_mm measured 2026-11-22 diode-400"), "{}", profile.source);
    }

    #[test]
    fn a_wrong_key_a_value_out_of_range_and_a_row_without_a_machine_are_refused() {
        let message = |values: &[(&str, &str)]| changed(values).unwrap_err().to_string();
        assert!(message(&[("thicknes_mm", "0.2")]).contains("did you mean"));
        assert!(message(&[("cut.power", "1.5")]).contains("power"));
        assert!(message(&[("joint", "3")]).contains("joint"));
        let none = Library::built_in().changed_profile("paper-160", None, &changes(&[("cut.power", "0.4")]));
        assert!(matches!(none, Err(Error::NeedsMachine { .. })));
    }
}
