//! Colours that tell how a move is cut: its power, feed, energy, or when it comes.

use super::canvas::Colour;
use super::run::{Bed, Run};
use crate::gcode::Action;

/// What a cut's colour stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorBy {
    /// Share of full power.
    Power,
    /// Commanded speed.
    Feed,
    /// Energy left per length.
    Energy,
    /// When it is cut.
    Order,
}

/// More different values than this are told by a ramp, fewer one by one.
const MAX_STEPS: usize = 6;

/// Values this much of their range apart are one: what rounding to the last decimals of a program leaves.
const SAME_SHARE: f64 = 1e-3;

/// The colours of the ramp from low to high on white. Lightness falls all the way, so that it reads without telling red from green.
const LIGHT: [Colour; 5] =
    [Colour(242, 165, 75), Colour(231, 98, 84), Colour(188, 45, 116), Colour(115, 28, 133), Colour(45, 16, 92)];

/// The same on black: lightness rises.
const DARK: [Colour; 5] =
    [Colour(104, 96, 236), Colour(176, 86, 222), Colour(236, 100, 160), Colour(252, 150, 96), Colour(253, 224, 120)];

/// What the values of a run's cuts span.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    pub lo: f64,
    pub hi: f64,
    /// All values there are, rising, when they are few.
    pub steps: Vec<f64>,
}

impl ColorBy {
    /// All, in the order they are offered.
    pub const ALL: [ColorBy; 4] = [ColorBy::Power, ColorBy::Feed, ColorBy::Energy, ColorBy::Order];

    /// The word used on the command line.
    pub fn word(self) -> &'static str {
        match self {
            ColorBy::Power => "power",
            ColorBy::Feed => "feed",
            ColorBy::Energy => "energy",
            ColorBy::Order => "order",
        }
    }

    /// The unit people read.
    pub(super) fn unit(self, bed: &Bed) -> &'static str {
        match self {
            ColorBy::Power => "%",
            ColorBy::Feed => "mm/min",
            ColorBy::Energy if bed.optical_power_w.is_some() => "J/mm",
            ColorBy::Energy => "J/mm per watt of laser",
            ColorBy::Order => "min",
        }
    }

    /// The value of every move that works, in [`ColorBy::unit`] (order: s from the start).
    pub(super) fn values(self, run: &Run, bed: &Bed) -> Vec<Option<f64>> {
        let mut clock_s = 0.0;
        let value = |(m, time_s): (&crate::gcode::Move, &f64)| {
            let began_s = clock_s;
            clock_s += time_s;
            m.works(bed.laser).then(|| match self {
                ColorBy::Power => 100.0 * bed.power(m),
                ColorBy::Feed => m.feed_mm_per_min,
                ColorBy::Energy => bed.energy_j_per_mm(m, *time_s),
                ColorBy::Order => began_s,
            })
        };
        run.moves.iter().zip(&run.timing.move_s).map(value).collect()
    }

    /// What the values of all runs span. Values of moves that go nowhere do not count.
    pub(super) fn scale(self, runs: &[Run], bed: &Bed) -> Scale {
        let mut values: Vec<f64> = Vec::new();
        for run in runs {
            let moves = run.moves.iter().zip(self.values(run, bed));
            let moving = moves.filter(|(m, _)| m.action != Action::Stop && m.length_mm() > 0.0);
            values.extend(moving.filter_map(|(_, value)| value).filter(|v| v.is_finite()));
        }
        Scale::of(values)
    }
}

impl Scale {
    fn of(mut values: Vec<f64>) -> Scale {
        values.sort_by(f64::total_cmp);
        let (Some(lo), Some(hi)) = (values.first().copied(), values.last().copied()) else {
            return Scale { lo: 0.0, hi: 0.0, steps: Vec::new() };
        };
        let apart = SAME_SHARE * (hi - lo);
        values.dedup_by(|later, kept| *later - *kept <= apart);
        let steps = if values.len() <= MAX_STEPS { values } else { Vec::new() };
        Scale { lo, hi, steps }
    }

    /// Where on the ramp a value lies, 0..=1; the top when all are alike.
    pub fn share(&self, value: f64) -> f64 {
        if self.hi > self.lo { ((value - self.lo) / (self.hi - self.lo)).clamp(0.0, 1.0) } else { 1.0 }
    }
}

/// The stops of the ramp for a light and for a dark page, as "#rrggbb".
pub(super) fn ramps_hex() -> [Vec<String>; 2] {
    [LIGHT, DARK].map(|ramp| ramp.iter().map(|c| c.hex()).collect())
}

/// The colour on white at a share of the ramp.
pub(super) fn light(share: f64) -> Colour {
    let place = share.clamp(0.0, 1.0) * (LIGHT.len() - 1) as f64;
    let below = (place.floor() as usize).min(LIGHT.len() - 2);
    let t = place - below as f64;
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * t).round() as u8;
    let (a, b) = (LIGHT[below], LIGHT[below + 1]);
    Colour(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

#[cfg(test)]
mod tests {
    use super::super::run::tests::{bed, moves, run};
    use super::*;

    /// Relative luminance of sRGB (WCAG 2).
    fn luminance(c: Colour) -> f64 {
        let linear = |v: u8| {
            let v = f64::from(v) / 255.0;
            if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(c.0) + 0.7152 * linear(c.1) + 0.0722 * linear(c.2)
    }

    #[test]
    fn the_ramps_are_told_by_lightness_alone_and_stand_out_from_their_page() {
        assert!(LIGHT.windows(2).all(|w| luminance(w[0]) > 1.3 * luminance(w[1])));
        assert!(DARK.windows(2).all(|w| luminance(w[1]) > 1.1 * luminance(w[0])));
        assert!(LIGHT.iter().all(|c| 1.05 / (luminance(*c) + 0.05) > 1.9), "on white");
        assert!(DARK.iter().all(|c| (luminance(*c) + 0.05) / (0.008 + 0.05) > 3.0), "on the dark page");
        assert_eq!((light(0.0), light(1.0), light(0.5)), (LIGHT[0], LIGHT[4], LIGHT[2]));
    }

    #[test]
    fn every_cut_has_its_value_and_travels_have_none() {
        let text = "M4S0\nG0X10\nG1X30S300F600\nG1X50S500F1200\nG0Y40S0";
        let moves = moves(text);
        let run = run(text, &moves);
        let of = |by: ColorBy| by.values(&run, &bed());
        assert_eq!(of(ColorBy::Power), [None, None, Some(30.0), Some(50.0), None]);
        assert_eq!(of(ColorBy::Feed), [None, None, Some(600.0), Some(1200.0), None]);
        let energy: Vec<f64> = of(ColorBy::Energy).into_iter().flatten().collect();
        assert!((energy[0] - 0.15).abs() < 1e-12 && (energy[1] - 0.125).abs() < 1e-12, "{energy:?}");
        let order: Vec<f64> = of(ColorBy::Order).into_iter().flatten().collect();
        assert!(order[0] > 0.0 && (order[1] - order[0] - run.timing.move_s[2]).abs() < 1e-12);
    }

    #[test]
    fn few_values_are_steps_and_many_are_a_range() {
        assert_eq!(Scale::of(vec![50.0, 8.0, 50.0]), Scale { lo: 8.0, hi: 50.0, steps: vec![8.0, 50.0] });
        let many = Scale::of((0..20).map(f64::from).collect());
        assert!(many.steps.is_empty() && many.hi == 19.0);
        assert_eq!(many.share(9.5), 0.5);
        assert_eq!(Scale::of(vec![7.0]).share(7.0), 1.0);
        assert_eq!(Scale::of(Vec::new()).hi, 0.0);
    }
}
