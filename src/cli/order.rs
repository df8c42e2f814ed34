//! The shape a command is given, and what goes over its values.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::Failure;
use super::output::read_argument;
use crate::design::{self, built_in};
use crate::job::{Order, Overrides};

/// A shape and how to fill it.
#[derive(Debug, clap::Args)]
pub(super) struct Shape {
    /// The shape: .obj, .stl, a design .toml, `-` for a design on stdin, or paper-default, paper-wide, paper-dense
    shape: PathBuf,
    /// Machine to cut on (see `furbelow machine list`), or a path
    #[arg(short, long)]
    machine: Option<String>,
    /// Material to cut (see `furbelow profile list`), or a path
    #[arg(short = 'p', long, alias = "profile")]
    material: Option<String>,
    /// Sheets to cut from: A4, A3, or WxH in mm, with @N for how many there are; several in order of preference
    #[arg(long, value_name = "A4|A3|WxH[@N]", value_delimiter = ',')]
    stock: Vec<String>,
    /// Cut from a roll of this width instead of sheets
    #[arg(long, value_name = "MM", conflicts_with = "stock")]
    roll: Option<f64>,
    /// Scale the shape to this height
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    height_mm: Option<f64>,
    /// Axis of the shape's file that points up [default: y for .obj, z for .stl]
    #[arg(long)]
    up: Option<Up>,
    /// Number of layers [default: from the outline]
    #[arg(long, value_name = "N")]
    layers: Option<usize>,
    /// How the bottom stands [default: auto, free where it stands by itself]
    #[arg(long)]
    foot: Option<Foot>,
    /// Paper that assembly sheets and patterns are printed on [default: a4]
    #[arg(long)]
    paper: Option<Paper>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Up {
    X,
    Y,
    Z,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Foot {
    Auto,
    Free,
    Pinned,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Paper {
    A4,
    Letter,
}

impl Shape {
    /// The order it makes.
    pub fn order(&self) -> Result<Order, Failure> {
        let overrides = self.overrides();
        let name = self.shape.to_str().unwrap_or_default();
        if let Some((file, text)) = read_argument(name)? {
            return Ok(Order::from_text(file, text, Path::new("."), &overrides)?);
        }
        if self.design_file().is_some() {
            return Ok(Order::from_file(&self.shape, &overrides)?);
        }
        let named = |value: &Option<String>, what: &str, list: &str| match value {
            Some(_) => Ok(()),
            None => Err(Failure::config(format!("--{what} is missing; `furbelow {list} list` shows what there is"))),
        };
        named(&self.machine, "machine", "machine")?;
        named(&self.material, "material", "profile")?;
        if built_in(name).is_some() && !self.shape.exists() {
            return Ok(Order::built_in(name, &overrides)?);
        }
        Ok(Order::from_mesh(&self.shape, &overrides)?)
    }

    /// The design file, when the shape is one.
    pub fn design_file(&self) -> Option<&Path> {
        self.shape.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")).then_some(&self.shape)
    }

    fn overrides(&self) -> Overrides {
        Overrides {
            machine: self.machine.clone(),
            material: self.material.clone(),
            stock: self.roll.map_or_else(|| self.stock.clone(), |width_mm| vec![format!("roll {width_mm}")]),
            height_mm: self.height_mm,
            up: self.up.map(|up| match up {
                Up::X => design::Up::X,
                Up::Y => design::Up::Y,
                Up::Z => design::Up::Z,
            }),
            layers: self.layers,
            foot: self.foot.map(|foot| match foot {
                Foot::Auto => design::Foot::Auto,
                Foot::Free => design::Foot::Free,
                Foot::Pinned => design::Foot::Pinned,
            }),
            paper: self.paper.map(|paper| match paper {
                Paper::A4 => design::Paper::A4,
                Paper::Letter => design::Paper::Letter,
            }),
        }
    }
}
