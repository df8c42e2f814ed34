//! What `furbelow machine` and `furbelow profile` have in common: their subcommands.

/// What to do with files of one kind.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Name all there are
    List {
        /// One JSON object on stdout
        #[arg(long)]
        json: bool,
    },
    /// Show what is known about one, and from where
    Show {
        /// A name from the list, or the path of a .toml file
        name: String,
        /// One JSON object on stdout
        #[arg(long)]
        json: bool,
    },
    /// Check a file: says OK, or everything that is wrong
    Check {
        /// A .toml file, `-` for stdin, or a name from the list
        file: String,
    },
    /// Print the JSON schema of these files, for editors
    Schema,
}
