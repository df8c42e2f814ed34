//! Writes lines and remembers what they leave in effect, so that words are written only when they change.

use super::arcs::{Piece, pieces, rounded};
use super::emit::{Dialect, ToolWords};
use super::program::{Line, Word, round3};
use crate::geom::P2;
use crate::toolpath::{Air, Contour};

/// Lines written so far and the modal state they leave; `None` is unknown to the reader of the file.
pub(super) struct Writer {
    dialect: Dialect,
    pub(super) lines: Vec<Line>,
    at: Option<P2>,
    motion: Option<f64>,
    power_s: f64,
    feed: Option<f64>,
    /// 3 or 4 while a laser's mode is said.
    mode: Option<f64>,
    depth_mm: f64,
    /// A pen or a blade is on the sheet.
    down: bool,
    /// M word of the air that is on.
    air: Option<u8>,
    /// Whether air was ever switched on.
    pub(super) air_used: bool,
}

impl Writer {
    /// Nothing written; position, motion and feed unknown.
    pub(super) fn new(dialect: Dialect) -> Writer {
        Writer {
            dialect,
            lines: Vec::new(),
            at: None,
            motion: None,
            power_s: 0.0,
            feed: None,
            mode: None,
            depth_mm: 0.0,
            down: true,
            air: None,
            air_used: false,
        }
    }

    pub(super) fn comment(&mut self, text: &str) {
        self.lines.push(Line::comment(text));
    }

    pub(super) fn words(&mut self, words: &[(char, f64)]) {
        self.lines.push(Line::of(words.iter().map(|(letter, value)| Word::new(*letter, *value))));
    }

    /// Travels to a contour with the tool off and runs along it.
    pub(super) fn run(&mut self, contour: &Contour) {
        let start = rounded(contour.path.vertices[0].point);
        if self.at != Some(start) || self.depth_mm != contour.depth_mm {
            self.travel(contour.way.iter().copied().chain([start]));
        }
        self.blow(contour.air);
        self.begin(contour);
        let power_s = match self.dialect.tool {
            ToolWords::Laser { .. } => Some(round3(contour.power * self.dialect.max_s)),
            ToolWords::Servo { .. } | ToolWords::Lift { .. } => None,
        };
        let mut at = start;
        for segment in contour.path.segments() {
            for piece in pieces(&segment, at) {
                let (g, to, centre) = match piece {
                    Piece::Line { to } => (1.0, to, Vec::new()),
                    Piece::Arc { to, offset, clockwise } => {
                        let centre = [('I', offset.x), ('J', offset.y)].into_iter().filter(|w| w.1 != 0.0).collect();
                        (if clockwise { 2.0 } else { 3.0 }, to, centre)
                    }
                };
                let new_s = power_s.filter(|s| std::mem::replace(&mut self.power_s, *s) != *s);
                self.moved(g, to, &centre, new_s, Some(round3(contour.feed_mm_per_min)));
                at = to;
            }
        }
    }

    /// Takes the tool off the sheet and goes through these points.
    pub(super) fn travel(&mut self, points: impl IntoIterator<Item = P2>) {
        self.lift();
        for point in points {
            let point = rounded(point);
            if self.at != Some(point) {
                let off = matches!(self.dialect.tool, ToolWords::Laser { .. }).then_some(0.0);
                self.power_s = 0.0;
                self.moved(0.0, point, &[], off, None);
            }
        }
    }

    /// Lifts a pen or a blade. A laser is put out by the next travel.
    pub(super) fn lift(&mut self) {
        if !std::mem::replace(&mut self.down, false) {
            return;
        }
        match self.dialect.tool {
            ToolWords::Laser { .. } => self.down = true,
            ToolWords::Servo { up_s, dwell_s, .. } => {
                self.words(&[('M', 3.0), ('S', up_s)]);
                self.dwell(dwell_s);
            }
            ToolWords::Lift { up_mm, .. } => {
                self.motion = Some(0.0);
                self.words(&[('G', 0.0), ('Z', up_mm)]);
            }
        }
    }

    /// Sets a laser that was lowered for its last pass back to where it was focused.
    pub(super) fn refocus(&mut self) {
        let laser = matches!(self.dialect.tool, ToolWords::Laser { .. });
        if laser && std::mem::replace(&mut self.depth_mm, 0.0) != 0.0 {
            self.motion = Some(0.0);
            self.words(&[('G', 0.0), ('Z', 0.0)]);
        }
    }

    /// Puts the tool to the sheet for a contour, or says the laser's mode.
    fn begin(&mut self, contour: &Contour) {
        match self.dialect.tool {
            ToolWords::Laser { constant_power } => {
                let mode = if constant_power || contour.constant_power { 3.0 } else { 4.0 };
                if self.mode.replace(mode) != Some(mode) {
                    self.power_s = 0.0;
                    self.words(&[('M', mode), ('S', 0.0)]);
                }
                if std::mem::replace(&mut self.depth_mm, contour.depth_mm) != contour.depth_mm {
                    (self.motion, self.power_s) = (Some(0.0), 0.0);
                    self.words(&[('G', 0.0), ('Z', -contour.depth_mm), ('S', 0.0)]);
                }
            }
            ToolWords::Servo { down_s, dwell_s, .. } => {
                if !std::mem::replace(&mut self.down, true) {
                    self.words(&[('M', 3.0), ('S', down_s)]);
                    self.dwell(dwell_s);
                }
            }
            ToolWords::Lift { down_mm, feed_mm_per_min, dwell_s, .. } => {
                self.depth_mm = contour.depth_mm;
                if !std::mem::replace(&mut self.down, true) {
                    self.motion = Some(1.0);
                    self.feed = Some(round3(feed_mm_per_min));
                    self.words(&[('G', 1.0), ('Z', down_mm - contour.depth_mm), ('F', feed_mm_per_min)]);
                    self.dwell(dwell_s);
                }
            }
        }
    }

    fn dwell(&mut self, seconds: f64) {
        if seconds > 0.0 {
            self.words(&[('G', 4.0), ('P', seconds)]);
        }
    }

    /// A motion line with the words that change; arcs always name an end.
    fn moved(&mut self, g: f64, to: P2, centre: &[(char, f64)], s: Option<f64>, f: Option<f64>) {
        let mut words = Vec::with_capacity(7);
        if self.motion.replace(g) != Some(g) {
            words.push(('G', g));
        }
        let before = self.at.replace(to);
        let changed = |axis: fn(P2) -> f64| before.is_none_or(|b| axis(b) != axis(to));
        if changed(|p| p.x) {
            words.push(('X', to.x));
        }
        if changed(|p| p.y) {
            words.push(('Y', to.y));
        }
        words.extend(centre);
        words.extend(s.map(|s| ('S', s)));
        if let Some(f) = f
            && self.feed.replace(f) != Some(f)
        {
            words.push(('F', f));
        }
        self.words(&words);
    }

    /// Switches the air. That stops the machine, so the beam is put out first: under M3 it would burn where it stands.
    fn blow(&mut self, air: Air) {
        let code = self.dialect.air.and_then(|words| match air {
            Air::Off => None,
            Air::Low => Some(words.low),
            Air::High => Some(words.high),
        });
        if self.air == code {
            return;
        }
        if self.power_s != 0.0 {
            self.power_s = 0.0;
            self.words(&[('S', 0.0)]);
        }
        // M7 and M8 add up in GRBL: from one to the other goes through M9.
        if self.air.is_some() {
            self.words(&[('M', 9.0)]);
        }
        if let Some(code) = code {
            self.words(&[('M', f64::from(code))]);
            self.air_used = true;
        }
        self.air = code;
    }
}
