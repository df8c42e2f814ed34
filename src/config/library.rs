//! Where machines and profiles are found: built into the program, in the user's folder, or at a path; and how one builds on another.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use etcetera::BaseStrategy;
use serde::de::DeserializeOwned;

use super::check::Checker;
use super::error::{Error, Kind};
use super::machine::Machine;
use super::profile::Profile;
use super::source::{Problem, Source, nearest};
use super::tree::{Node, Value};
use super::{machine_check, profile_check, read, schema};

/// Names the folder that stands in for the platform's config folder.
pub const FOLDER_VARIABLE: &str = "FURBELOW_CONFIG_DIR";

const MACHINES: [(&str, &str); 6] = [
    ("diode-400", include_str!("../../machines/diode-400.toml")),
    ("diode-5w", include_str!("../../machines/diode-5w.toml")),
    ("k40", include_str!("../../machines/k40.toml")),
    ("pen-a3", include_str!("../../machines/pen-a3.toml")),
    ("print", include_str!("../../machines/print.toml")),
    ("roll-610", include_str!("../../machines/roll-610.toml")),
];

const PROFILES: [(&str, &str); 5] = [
    ("felt-soft-1", include_str!("../../profiles/felt-soft-1.toml")),
    ("felt-stiff-1", include_str!("../../profiles/felt-stiff-1.toml")),
    ("paper-160", include_str!("../../profiles/paper-160.toml")),
    ("paper-80", include_str!("../../profiles/paper-80.toml")),
    ("polyester-0.1", include_str!("../../profiles/polyester-0.1.toml")),
];

/// All machines and profiles there are. A user's file goes before a built-in one of the same name.
#[derive(Debug, Clone)]
pub struct Library {
    folder: Option<PathBuf>,
}

/// A machine or profile that can be asked for by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// What to ask for.
    pub name: String,
    /// Where it comes from.
    pub place: Place,
}

/// Where a file comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Part of the program.
    BuiltIn,
    /// On disk.
    File(PathBuf),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Place::BuiltIn => f.write_str("built in"),
            Place::File(path) => write!(f, "{}", path.display()),
        }
    }
}

/// What both kinds of files share.
trait Described: DeserializeOwned {
    const KIND: Kind;
    fn check(&self, checker: &mut Checker<'_>);
}

impl Described for Machine {
    const KIND: Kind = Kind::Machine;
    fn check(&self, checker: &mut Checker<'_>) {
        machine_check::check(self, checker);
    }
}

impl Described for Profile {
    const KIND: Kind = Kind::Profile;
    fn check(&self, checker: &mut Checker<'_>) {
        profile_check::check(self, checker);
    }
}

/// Where the jobs that were sent are kept: `$FURBELOW_CONFIG_DIR/jobs`, or else in the platform's folder for what programs keep of their own accord
/// (`~/.local/state/furbelow/jobs`, `%APPDATA%\\furbelow\\jobs`). `None` without a home directory.
pub fn jobs_folder() -> Option<PathBuf> {
    let given = std::env::var_os(FOLDER_VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
    let usual = || {
        let base = etcetera::choose_base_strategy().ok()?;
        Some(base.state_dir().unwrap_or_else(|| base.data_dir()).join("furbelow"))
    };
    given.or_else(usual).map(|folder| folder.join("jobs"))
}

impl Library {
    /// The built-in files and the user's: in `$FURBELOW_CONFIG_DIR`, or else in the platform's config folder
    /// (`~/.config/furbelow`, `%APPDATA%\furbelow`). The folder need not exist.
    pub fn open() -> Library {
        let given = std::env::var_os(FOLDER_VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
        // Without a home directory there is no such folder, and the built-in files still serve.
        let usual = || etcetera::choose_base_strategy().ok().map(|base| base.config_dir().join("furbelow"));
        Library { folder: given.or_else(usual) }
    }

    /// The built-in files and those in `folder`/machines and `folder`/profiles.
    pub fn with_folder(folder: impl Into<PathBuf>) -> Library {
        Library { folder: Some(folder.into()) }
    }

    /// The built-in files only.
    pub fn built_in() -> Library {
        Library { folder: None }
    }

    /// The folder in which users' own files of a kind are looked for.
    pub fn folder(&self, kind: Kind) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(kind.folder()))
    }

    /// All names of a kind, sorted. Errors: [`Error::Read`] when the user's folder is there but cannot be read.
    pub fn names(&self, kind: Kind) -> Result<Vec<Listed>, Error> {
        let mut places: BTreeMap<String, Place> =
            built_ins(kind).iter().map(|(name, _)| ((*name).to_owned(), Place::BuiltIn)).collect();
        if let Some(folder) = self.folder(kind).filter(|folder| folder.is_dir()) {
            let read_error = |source| Error::Read { path: folder.clone(), source };
            for entry in std::fs::read_dir(&folder).map_err(read_error)? {
                let path = entry.map_err(read_error)?.path();
                if let Some(name) = stem(&path).filter(|_| path.is_file()) {
                    places.insert(name.to_owned(), Place::File(path));
                }
            }
        }
        Ok(places.into_iter().map(|(name, place)| Listed { name, place }).collect())
    }

    /// The machine of that name, or in the file at that path. Errors: [`Error::Unknown`], [`Error::Read`], [`Error::Invalid`].
    pub fn machine(&self, name_or_path: &str) -> Result<Machine, Error> {
        self.load(name_or_path)
    }

    /// The profile of that name, or in the file at that path. Errors: [`Error::Unknown`], [`Error::Read`], [`Error::Invalid`].
    pub fn profile(&self, name_or_path: &str) -> Result<Profile, Error> {
        self.load(name_or_path)
    }

    /// The machine in a text, `file` being what messages call it; a path in `inherits` is looked up from the working directory.
    pub fn machine_in(&self, file: &str, text: String) -> Result<Machine, Error> {
        self.interpret(Found { key: file.to_owned(), file: file.to_owned(), text, folder: None, named: None })
    }

    /// The profile in a text, `file` being what messages call it; a path in `inherits` is looked up from the working directory.
    pub fn profile_in(&self, file: &str, text: String) -> Result<Profile, Error> {
        self.interpret(Found { key: file.to_owned(), file: file.to_owned(), text, folder: None, named: None })
    }

    /// What messages call the file of that name or path, and its text, the user's before the built-in one. Errors: [`Error::Unknown`], [`Error::Read`].
    pub(super) fn text(&self, kind: Kind, name_or_path: &str) -> Result<(String, String), Error> {
        let found = self.find(kind, name_or_path, None, &[])?;
        Ok((found.file, found.text))
    }

    /// The file of the user's that changes to `name_or_path` go to: that path, or NAME.toml in their own folder; `None` where there is no such folder.
    pub fn own_file(&self, kind: Kind, name_or_path: &str) -> Option<PathBuf> {
        if is_path(name_or_path) {
            return Some(PathBuf::from(name_or_path));
        }
        self.folder(kind).map(|folder| folder.join(format!("{name_or_path}.toml")))
    }

    fn load<T: Described>(&self, name: &str) -> Result<T, Error> {
        self.interpret(self.find(T::KIND, name, None, &[])?)
    }

    fn interpret<T: Described>(&self, found: Found) -> Result<T, Error> {
        let named = found.named.clone();
        let root = self.resolve(T::KIND, found, &mut Vec::new())?;
        let mut problems = schema::missing_keys(T::KIND, &root);
        if let Some(value) = read::read::<T>(&root, &mut problems) {
            let mut checker = Checker::new(&root);
            value.check(&mut checker);
            name_agrees(&root, named.as_deref(), &mut checker);
            problems.append(&mut checker.into_problems());
            if problems.is_empty() {
                return Ok(value);
            }
        }
        let key = |p: &Problem| (p.file.clone(), p.line, p.column, p.message.clone());
        problems.sort_by_key(key);
        // A missing key is found twice, by the schema and when the type is made.
        problems.dedup();
        Err(Error::Invalid { problems })
    }

    /// Parses a file and lays it over the one it inherits from. `chain` holds the files below it that are being resolved.
    fn resolve(&self, kind: Kind, found: Found, chain: &mut Vec<String>) -> Result<Node, Error> {
        let source = Arc::new(Source { name: found.file, text: found.text });
        let own = Node::parse(source).map_err(|problems| Error::Invalid { problems })?;
        chain.push(found.key);
        let Some(inherits) = own.get("inherits") else { return Ok(own) };
        let at_inherits = |message: String| Error::Invalid { problems: vec![inherits.origin.problem(message, None)] };
        let Value::Text(base) = &inherits.value else {
            return Err(at_inherits("`inherits` is the name of another file, a text in quotes".into()));
        };
        let base = match self.find(kind, base, found.folder.as_deref(), chain) {
            Ok(base) if chain.contains(&base.key) => {
                return Err(at_inherits(format!("a circle: {} inherits from itself through this file", base.file)));
            }
            Ok(base) => base,
            Err(error @ Error::Unknown { .. }) => return Err(at_inherits(error.to_string())),
            Err(error) => return Err(error),
        };
        let mut base = self.resolve(kind, base, chain)?;
        // A file has its own name and its own base.
        base.remove("name");
        base.remove("inherits");
        Ok(own.over(base))
    }

    /// Finds a file by name or path; `from` is the folder that relative paths start at. A name skips files of the `chain`, so that a user's
    /// k40.toml can build on the built-in k40; when only those are left, the one in the chain is returned.
    fn find(&self, kind: Kind, name: &str, from: Option<&Path>, chain: &[String]) -> Result<Found, Error> {
        if is_path(name) {
            return Found::at(from.map_or_else(|| PathBuf::from(name), |folder| folder.join(name)), None);
        }
        let own = self.folder(kind).map(|folder| folder.join(format!("{name}.toml"))).filter(|path| path.is_file());
        let own = own.map(|path| Found::at(path, Some(name.to_owned()))).transpose()?;
        let built_in = built_ins(kind).iter().find(|(known, _)| *known == name).map(|(_, text)| Found {
            key: format!("built-in {name}"),
            file: format!("built-in {}/{name}.toml", kind.folder()),
            text: (*text).to_owned(),
            folder: None,
            named: Some(name.to_owned()),
        });
        let mut candidates: Vec<Found> = own.into_iter().chain(built_in).collect();
        let fresh = candidates.iter().position(|found| !chain.contains(&found.key)).unwrap_or(0);
        if candidates.is_empty() {
            let names = self.names(kind)?;
            let near = nearest(name, names.iter().map(|listed| listed.name.as_str())).map(str::to_owned);
            return Err(Error::Unknown { kind, name: name.to_owned(), near });
        }
        Ok(candidates.swap_remove(fresh))
    }
}

/// A file that was found and read.
struct Found {
    /// The same for the same file, however it was named.
    key: String,
    /// What messages call it.
    file: String,
    text: String,
    /// Where relative paths in it start.
    folder: Option<PathBuf>,
    /// The name it is asked for by, which `name` in it must repeat.
    named: Option<String>,
}

impl Found {
    fn at(path: PathBuf, named: Option<String>) -> Result<Found, Error> {
        let text = std::fs::read_to_string(&path).map_err(|source| Error::Read { path: path.clone(), source })?;
        let key = path.canonicalize().unwrap_or_else(|_| path.clone()).display().to_string();
        let folder = path.parent().map(Path::to_owned);
        Ok(Found { key, file: path.display().to_string(), text, folder, named })
    }
}

fn name_agrees(root: &Node, named: Option<&str>, checker: &mut Checker<'_>) {
    if let (Some(named), Some(Value::Text(name))) = (named, root.get("name").map(|node| &node.value))
        && name != named
    {
        checker.problem("name", format!("the file is called {named}.toml, so its name must be \"{named}\""));
    }
}

fn built_ins(kind: Kind) -> &'static [(&'static str, &'static str)] {
    match kind {
        Kind::Machine => &MACHINES,
        Kind::Profile => &PROFILES,
    }
}

/// True for what is meant as a file's path rather than as a name.
fn is_path(name: &str) -> bool {
    name.contains(['/', '\\']) || name.ends_with(".toml")
}

fn stem(path: &Path) -> Option<&str> {
    path.file_name()?.to_str()?.strip_suffix(".toml")
}

impl Error {
    /// The problems of an invalid file, none for other errors.
    pub fn problems(&self) -> &[Problem] {
        match self {
            Error::Invalid { problems } => problems,
            _ => &[],
        }
    }
}
