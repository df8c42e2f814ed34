//! What the board tells of itself (report.c).

use super::board::{Board, State};
use super::personality::Personality;
use crate::gcode::Beam;
use crate::geom::V3;

/// Reports between two that carry the work offset, and the overrides: moving and resting (config.h).
const WCO_BUSY: u32 = 29;
const WCO_IDLE: u32 = 9;
const OVERRIDES_BUSY: u32 = 19;
const OVERRIDES_IDLE: u32 = 9;

impl Board {
    /// Answers `?`.
    pub(super) fn report(&mut self) {
        let busy = matches!(self.state, State::Run | State::Hold | State::Jog | State::Home | State::Door);
        let state = match (self.state, self.motion.is_running()) {
            (State::Idle, _) => "Idle",
            (State::Run, _) => "Run",
            (State::Hold, false) => "Hold:0",
            (State::Hold, true) => "Hold:1",
            (State::Jog, _) => "Jog",
            (State::Home, _) => "Home",
            (State::Alarm, _) => "Alarm",
            (State::Check, _) => "Check",
            (State::Door, false) => "Door:0",
            (State::Door, true) => "Door:2",
            (State::Sleep, _) => "Sleep",
        };
        let mask = self.settings.get(10) as u32;
        let origin = self.interpreter.origin();
        let position = self.motion.position.coords;
        let mut text = match mask & 1 {
            1 => format!("<{state}|MPos:{}", self.triple(position)),
            _ => format!("<{state}|WPos:{}", self.triple(position - origin)),
        };
        if mask & 2 != 0 {
            text += &format!("|Bf:{},{}", self.motion.free_blocks(), self.link.free());
        }
        let unit = if self.settings.is_on(13) { 25.4 } else { 1.0 };
        text += &format!("|FS:{:.0},{:.0}", self.motion.speed_mm_per_s() * 60.0 / unit, self.motion.shown_s());
        let closed = [self.probe.closed, self.switches[0], self.switches[1], self.switches[2]];
        if closed.contains(&true) {
            let pins: String = "PXYZ".chars().zip(closed).filter(|(_, on)| *on).map(|(pin, _)| pin).collect();
            text += &format!("|Pn:{pins}");
        }
        if self.reports_to_wco > 0 {
            self.reports_to_wco -= 1;
        } else {
            self.reports_to_wco = if busy { WCO_BUSY } else { WCO_IDLE };
            // The overrides come with the next report.
            self.reports_to_overrides = self.reports_to_overrides.max(1);
            text += &format!("|WCO:{}", self.triple(origin));
        }
        if self.reports_to_overrides > 0 {
            self.reports_to_overrides -= 1;
        } else {
            self.reports_to_overrides = if busy { OVERRIDES_BUSY } else { OVERRIDES_IDLE };
            let o = self.motion.overrides;
            text += &format!("|Ov:{},{},{}", o.feed_percent, o.rapid_percent, o.spindle_percent);
            text += &self.accessories();
        }
        self.say(&(text + ">"));
    }

    fn accessories(&self) -> String {
        let modal = self.interpreter.modal();
        let letters = [
            (modal.beam == Beam::Constant, 'S'),
            (modal.beam == Beam::Dynamic, 'C'),
            (modal.coolant[1], 'F'),
            (modal.coolant[0], 'M'),
        ];
        let on: String = letters.iter().filter(|(on, _)| *on).map(|(_, letter)| *letter).collect();
        if on.is_empty() { on } else { format!("|A:{on}") }
    }

    /// Three coordinates in the unit of the reports ($13).
    fn triple(&self, v: V3) -> String {
        // No minus before what is written as zero.
        let tidy = |v: f64, scale: f64| (v * scale).round() / scale + 0.0;
        match self.settings.is_on(13) {
            true => {
                let [x, y, z] = [v.x, v.y, v.z].map(|c| tidy(c / 25.4, 1e4));
                format!("{x:.4},{y:.4},{z:.4}")
            }
            false => {
                let [x, y, z] = [v.x, v.y, v.z].map(|c| tidy(c, 1e3));
                format!("{x:.3},{y:.3},{z:.3}")
            }
        }
    }

    /// `$G`.
    pub(super) fn modal_line(&self) -> String {
        let m = self.interpreter.modal();
        let beam = match m.beam {
            Beam::Off => "M5",
            Beam::Constant => "M3",
            Beam::Dynamic => "M4",
        };
        let coolant = match m.coolant {
            [false, false] => "M9",
            [true, false] => "M7",
            [false, true] => "M8",
            [true, true] => "M7 M8",
        };
        let unit = if m.inches { 20 } else { 21 };
        let distance = if m.incremental { 91 } else { 90 };
        let feed_mode = if m.inverse_time { 93 } else { 94 };
        let feed = m.feed_mm_per_min / if self.settings.is_on(13) { 25.4 } else { 1.0 };
        // grblHAL tells more groups: tool length, the return from drilling cycles, scaling (report.c).
        let (more, point) = match self.hardware.personality {
            Personality::GrblHal if self.interpreter.tool_length_mm() != 0.0 => (" G43.1 G98 G50", "."),
            Personality::GrblHal => (" G49 G98 G50", "."),
            Personality::Grbl | Personality::FluidNc => ("", ""),
        };
        format!(
            "[GC:{} G{} G{} G{unit} G{distance} G{feed_mode}{more} {beam} {coolant} T{:.0} F{feed:.0} S{:.0}{point}]",
            m.motion,
            54 + m.offset,
            m.plane,
            m.tool,
            m.power_s
        )
    }

    /// `$#`.
    pub(super) fn offset_lines(&self) -> Vec<String> {
        let i = &self.interpreter;
        let mut lines: Vec<String> =
            i.offsets().iter().zip(54..).map(|(v, g)| format!("[G{g}:{}]", self.triple(*v))).collect();
        lines.extend(i.homes().iter().zip([28, 30]).map(|(p, g)| format!("[G{g}:{}]", self.triple(p.coords))));
        lines.push(format!("[G92:{}]", self.triple(i.shift())));
        lines.push(format!("[TLO:{:.3}]", i.tool_length_mm()));
        lines.push(self.probe_line());
        lines
    }

    /// What the last probing found.
    pub(super) fn probe_line(&self) -> String {
        format!("[PRB:{}:{}]", self.triple(self.probe.last_mm.coords), u8::from(self.probe.found))
    }
}
