//! Bytes a board acts on at once, wherever they stand. They are never counted and take no line feed.

/// Asks for a status report.
pub(super) const STATUS: u8 = b'?';
/// Brakes and holds.
pub(super) const HOLD: u8 = b'!';
/// Goes on after a hold.
pub(super) const RESUME: u8 = b'~';
/// Soft reset.
pub(super) const RESET: u8 = 0x18;
/// As if the door were opened.
pub(super) const DOOR: u8 = 0x84;
/// Ends a jog.
pub(super) const JOG_CANCEL: u8 = 0x85;

/// What can be scaled while a job runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Override {
    /// Feeds, 10 to 200 %.
    Feed,
    /// Travels: 25, 50 or 100 %.
    Rapid,
    /// Laser power, 10 to 200 %.
    Power,
}

impl Override {
    /// All, in the order boards report them.
    pub(super) const ALL: [Override; 3] = [Override::Feed, Override::Rapid, Override::Power];

    /// The nearest value a board takes, %.
    pub fn nearest(self, percent: u16) -> u16 {
        match self {
            Override::Feed | Override::Power => percent.clamp(10, 200),
            Override::Rapid => match percent {
                0..=37 => 25,
                38..=75 => 50,
                _ => 100,
            },
        }
    }

    /// The one byte that brings `now` nearer to `wanted`, both in %; `None` when it is there.
    pub(super) fn step(self, now: u16, wanted: u16) -> Option<u8> {
        if now == wanted {
            return None;
        }
        let base = match self {
            Override::Rapid => {
                return Some(match wanted {
                    25 => 0x97,
                    50 => 0x96,
                    _ => 0x95,
                });
            }
            Override::Feed => 0x90,
            Override::Power => 0x99,
        };
        let by = i32::from(wanted) - i32::from(now);
        Some(match by {
            _ if wanted == 100 => base,
            10.. => base + 1,
            ..=-10 => base + 2,
            1.. => base + 3,
            _ => base + 4,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_lead_to_what_is_wanted() {
        for (which, base) in [(Override::Feed, 0x90), (Override::Power, 0x99)] {
            for wanted in [10, 37, 99, 100, 101, 200] {
                let mut now = 123;
                let mut steps = 0;
                while let Some(byte) = which.step(now, wanted) {
                    now = match byte - base {
                        0 => 100,
                        1 => now + 10,
                        2 => now - 10,
                        3 => now + 1,
                        _ => now - 1,
                    };
                    steps += 1;
                    assert!(steps < 30);
                }
                assert_eq!(now, wanted);
            }
        }
        assert_eq!(Override::Rapid.step(100, 25), Some(0x97));
        assert_eq!([300, 5].map(|p| Override::Feed.nearest(p)), [200, 10]);
    }
}
