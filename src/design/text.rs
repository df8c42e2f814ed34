//! A design as text: written anew, and changed without losing comments.

use super::{Design, Error};
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, TableLike, Value};

impl Design {
    /// The file's text.
    pub fn to_toml(&self) -> String {
        let body = toml::to_string(self).expect("a design holds nothing TOML cannot");
        let mut document = document(&body);
        // Small tables read best in one line.
        for entries in document.iter_mut().filter_map(|(_, item)| item.as_array_of_tables_mut()) {
            for (mut key, item) in entries.iter_mut().flat_map(Table::iter_mut) {
                if let Item::Table(table) = item {
                    key.leaf_decor_mut().clear();
                    *item = Item::Value(Value::InlineTable(std::mem::take(table).into_inline_table()));
                }
            }
        }
        format!("# Made by furbelow; change what you like and run: furbelow make design.toml\n{document}")
    }

    /// The text of a design file with the values of this design in it. Only what differs from what the text says is written: comments, order and the way values are
    /// put stay as they stand.
    pub fn written_over(&self, file: &str, text: &str) -> Result<String, Error> {
        let said = document(&Design::parse(file, text)?.to_toml());
        // Both through the same writer, so that only true differences show.
        let wanted = document(&self.to_toml());
        let mut document = document(text);
        merge(document.as_table_mut(), said.as_table(), wanted.as_table());
        Ok(document.to_string())
    }
}

/// The line, from 1, on which edit `number` (from 1) of a design's text begins.
pub fn edit_line(text: &str, number: usize) -> Option<usize> {
    let document = toml_edit::Document::parse(text).ok()?;
    let span = match document.get("edit")? {
        Item::ArrayOfTables(edits) => edits.get(number.checked_sub(1)?)?.span()?,
        Item::Value(Value::Array(edits)) => edits.get(number.checked_sub(1)?)?.span()?,
        _ => return None,
    };
    Some(text[..span.start].matches('\n').count() + 1)
}

/// A text that was parsed or written as TOML before.
fn document(text: &str) -> DocumentMut {
    text.parse().expect("a design that was read or written is TOML")
}

/// Carries the differences between `said` and `wanted` over to `into`, which says the same as `said` in words of its own.
fn merge(into: &mut dyn TableLike, said: &dyn TableLike, wanted: &dyn TableLike) {
    let gone: Vec<String> = said.iter().map(|(k, _)| k.to_owned()).filter(|k| wanted.get(k).is_none()).collect();
    for key in gone {
        into.remove(&key);
    }
    for (key, new) in wanted.iter() {
        let Some(old) = said.get(key) else {
            into.insert(key, new.clone());
            continue;
        };
        if old.to_string() == new.to_string() {
            continue;
        }
        match (into.get_mut(key), old, new) {
            (Some(Item::ArrayOfTables(own)), Item::ArrayOfTables(old), Item::ArrayOfTables(new)) => {
                merge_tables(own, old, new);
            }
            (Some(Item::Value(Value::Array(own))), Item::ArrayOfTables(old), Item::ArrayOfTables(new)) => {
                merge_inline(own, old, new);
            }
            (Some(own), old, new) => match (own.as_table_like_mut(), old.as_table_like(), new.as_table_like()) {
                (Some(own), Some(old), Some(new)) => merge(own, old, new),
                _ => replace(own, new),
            },
            (None, _, new) => {
                into.insert(key, new.clone());
            }
        }
    }
}

/// The same for entries such as `[[part]]`: lists of them grow and shrink at their end.
fn merge_tables(own: &mut ArrayOfTables, old: &ArrayOfTables, new: &ArrayOfTables) {
    while own.len() > new.len() {
        own.remove(own.len() - 1);
    }
    for ((own, old), new) in own.iter_mut().zip(old).zip(new) {
        merge(own, old, new);
    }
    for added in new.iter().skip(own.len()) {
        own.push(added.clone());
    }
}

/// The same where they are put as `edit = [{ ... }, { ... }]`.
fn merge_inline(own: &mut Array, old: &ArrayOfTables, new: &ArrayOfTables) {
    while own.len() > new.len() {
        own.remove(own.len() - 1);
    }
    for ((own, old), new) in own.iter_mut().zip(old).zip(new) {
        if let Value::InlineTable(own) = own {
            merge(own, old, new);
        }
    }
    for added in new.iter().skip(own.len()) {
        own.push(added.clone().into_inline_table());
    }
}

/// Puts a value in place of another, comments round it kept.
fn replace(own: &mut Item, new: &Item) {
    match (own, new) {
        (Item::Value(own), Item::Value(new)) => {
            let decor = own.decor().clone();
            *own = new.clone();
            *own.decor_mut() = decor;
        }
        (own, new) => *own = new.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema = 1 # first\nmachine = \"m\"   # ours\nmaterial = \"p\"\n\n[mesh]\nfile = \"a.obj\"\nheight_mm = 100\n\n# the seat\n[[part]]\nname = \"A\"\nfoot = \"auto\"\n";

    #[test]
    fn only_what_changed_changes_and_comments_stay() {
        let mut design = Design::parse("d.toml", TEXT).unwrap();
        assert_eq!(design.written_over("d.toml", TEXT).unwrap(), TEXT);
        design.mesh.as_mut().unwrap().file = "../b.obj".into();
        design.machine = "k40".into();
        let expected = TEXT.replace("a.obj", "../b.obj").replace("\"m\"", "\"k40\"");
        assert_eq!(design.written_over("d.toml", TEXT).unwrap(), expected);
    }

    #[test]
    fn values_keep_the_way_they_are_put() {
        let text = "schema = 1\nmachine = \"m\"\nmaterial = \"p\"\nstock = [] # any\nmesh = { file = \"a.obj\", height_mm = 100 } # big\n\n[[part]]\nname = \"A\"\nplane = { origin_mm = [0, 0, 0], normal = [0, 0, 1] } # front\n";
        let mut design = Design::parse("d.toml", text).unwrap();
        assert_eq!(design.written_over("d.toml", text).unwrap(), text);
        design.mesh.as_mut().unwrap().file = "b.obj".into();
        design.parts[0].layers = Some(2);
        let expected = text.replace("a.obj", "b.obj") + "layers = 2\n";
        assert_eq!(design.written_over("d.toml", text).unwrap(), expected);
    }

    #[test]
    fn added_and_dropped_values_read_back() {
        let mut design = Design::parse("d.toml", TEXT).unwrap();
        design.mesh.as_mut().unwrap().height_mm = None;
        design.stock = vec!["A3".into()];
        design.parts[0].layers = Some(3);
        let text = design.written_over("d.toml", TEXT).unwrap();
        assert_eq!(Design::parse("d.toml", &text).unwrap(), design);
        assert!(text.contains("# the seat"));
    }
}
