//! Overrides, one byte at a time: a board merges equal ones that are pending, so each must show in a report before the next is sent.

use std::time::Duration;

use super::realtime::Override;

/// After this long without effect the byte is taken for lost.
const RESEND: Duration = Duration::from_secs(2);

/// What is wanted, what the board reports, and the byte between.
#[derive(Debug, Default)]
pub(super) struct Overrides {
    wanted: [Option<u16>; 3],
    told: Option<[u16; 3]>,
    pending: Option<Duration>,
}

impl Overrides {
    /// The board has started: everything is at 100 % again.
    pub(super) fn restarted(&mut self) {
        *self = Overrides { told: Some([100; 3]), ..Overrides::default() };
    }

    pub(super) fn want(&mut self, which: Override, percent: u16) {
        self.wanted[which as usize] = Some(which.nearest(percent));
    }

    pub(super) fn reported(&mut self, told: [u16; 3]) {
        if self.told.replace(told) != Some(told) {
            self.pending = None;
        }
    }

    /// The next byte to send.
    pub(super) fn next(&mut self, now: Duration) -> Option<u8> {
        if self.pending.is_some_and(|sent| now.saturating_sub(sent) < RESEND) {
            return None;
        }
        let told = self.told?;
        let byte =
            Override::ALL.into_iter().find_map(|which| which.step(told[which as usize], self.wanted[which as usize]?));
        self.pending = byte.map(|_| now);
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_step_waits_until_the_last_one_shows() {
        let at = Duration::from_millis;
        let mut overrides = Overrides::default();
        overrides.want(Override::Feed, 121);
        assert_eq!(overrides.next(at(0)), None, "nothing is known of the board yet");
        overrides.reported([100, 100, 100]);
        assert_eq!(overrides.next(at(10)), Some(0x91));
        assert_eq!(overrides.next(at(20)), None);
        overrides.reported([100, 100, 100]);
        assert_eq!(overrides.next(at(30)), None);
        overrides.reported([110, 100, 100]);
        assert_eq!(overrides.next(at(40)), Some(0x91));
        assert_eq!(overrides.next(at(3000)), Some(0x91), "the byte was lost");
        overrides.reported([120, 100, 100]);
        assert_eq!(overrides.next(at(3010)), Some(0x93));
        overrides.reported([121, 100, 100]);
        assert_eq!(overrides.next(at(9000)), None);
    }
}
