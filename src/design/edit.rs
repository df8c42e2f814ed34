//! Changing a design file's text without losing its comments.

use super::{Design, Error};
use toml_edit::{DocumentMut, Item, TableLike};

impl Design {
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
            (Some(Item::ArrayOfTables(own)), Item::ArrayOfTables(old), Item::ArrayOfTables(new))
                if own.len() == new.len() =>
            {
                for ((own, old), new) in own.iter_mut().zip(old).zip(new) {
                    merge(own, old, new);
                }
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
        design.mesh.file = "../b.obj".into();
        design.machine = "k40".into();
        let expected = TEXT.replace("a.obj", "../b.obj").replace("\"m\"", "\"k40\"");
        assert_eq!(design.written_over("d.toml", TEXT).unwrap(), expected);
    }

    #[test]
    fn values_keep_the_way_they_are_put() {
        let text = "schema = 1\nmachine = \"m\"\nmaterial = \"p\"\nstock = [] # any\nmesh = { file = \"a.obj\", height_mm = 100 } # big\n\n[[part]]\nname = \"A\"\nplane = { origin_mm = [0, 0, 0], normal = [0, 0, 1] } # front\n";
        let mut design = Design::parse("d.toml", text).unwrap();
        assert_eq!(design.written_over("d.toml", text).unwrap(), text);
        design.mesh.file = "b.obj".into();
        design.parts[0].layers = Some(2);
        let expected = text.replace("a.obj", "b.obj") + "layers = 2\n";
        assert_eq!(design.written_over("d.toml", text).unwrap(), expected);
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
