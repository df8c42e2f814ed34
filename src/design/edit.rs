//! Changing a design file's text without losing its comments.

use super::{Design, Error};
use toml_edit::{DocumentMut, Item, Table};

impl Design {
    /// The text of a design file with the values of this design in it: comments, order and everything that did not change stay as they stand.
    pub fn written_over(&self, file: &str, text: &str) -> Result<String, Error> {
        let syntax = |e: toml_edit::TomlError| Error::Syntax { file: file.into(), message: e.to_string() };
        let mut document: DocumentMut = text.parse().map_err(syntax)?;
        let wanted: DocumentMut = self.to_toml().parse().map_err(syntax)?;
        merge(document.as_table_mut(), wanted.as_table());
        Ok(document.to_string())
    }
}

/// Sets what differs, adds what is missing, drops what is no longer there.
fn merge(into: &mut Table, wanted: &Table) {
    let gone: Vec<String> = into.iter().map(|(k, _)| k.to_owned()).filter(|k| !wanted.contains_key(k)).collect();
    for key in gone {
        into.remove(&key);
    }
    for (key, new) in wanted {
        match (into.get_mut(key), new) {
            (Some(Item::Table(old)), Item::Table(new)) => merge(old, new),
            (Some(Item::ArrayOfTables(old)), Item::ArrayOfTables(new)) if old.len() == new.len() => {
                for (old, new) in old.iter_mut().zip(new) {
                    merge(old, new);
                }
            }
            (Some(Item::Value(old)), Item::Value(new)) => {
                if !same(old, new) {
                    let decor = old.decor().clone();
                    *old = new.clone();
                    *old.decor_mut() = decor;
                }
            }
            (Some(old), new) => *old = new.clone(),
            (None, new) => {
                into.insert(key, new.clone());
            }
        }
    }
}

/// Equal values, however they are written.
fn same(a: &toml_edit::Value, b: &toml_edit::Value) -> bool {
    let plain = |v: &toml_edit::Value| {
        let text = format!("value = {}", v.clone().decorated("", ""));
        toml::from_str::<toml::Table>(&text).ok().and_then(|mut table| table.remove("value"))
    };
    let number = |v: Option<toml::Value>| match v {
        Some(toml::Value::Integer(i)) => Some(toml::Value::Float(i as f64)),
        other => other,
    };
    number(plain(a)) == number(plain(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema = 1 # first\nmachine = \"m\"   # ours\nmaterial = \"p\"\n\n[mesh]\nfile = \"a.obj\"\nheight_mm = 100\n\n# the seat\n[[part]]\nname = \"A\"\nfoot = \"auto\"\n";

    #[test]
    fn only_what_changed_changes_and_comments_stay() {
        let mut design = Design::parse("d.toml", TEXT).unwrap();
        assert_eq!(design.written_over("d.toml", TEXT).unwrap(), TEXT);
        design.mesh.file = "../b.obj".into();
        design.machine = "k40".into();
        let expected = TEXT.replace("a.obj", "../b.obj").replace("\"m\"", "\"k40\"");
        assert_eq!(design.written_over("d.toml", TEXT).unwrap(), expected);
    }

    #[test]
    fn added_and_dropped_values_read_back() {
        let mut design = Design::parse("d.toml", TEXT).unwrap();
        design.mesh.height_mm = None;
        design.stock = vec!["A3".into()];
        design.parts[0].layers = Some(3);
        let text = design.written_over("d.toml", TEXT).unwrap();
        assert_eq!(Design::parse("d.toml", &text).unwrap(), design);
        assert!(text.contains("# the seat"));
    }
}
