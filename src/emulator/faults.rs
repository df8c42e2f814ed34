//! What goes wrong on command.

/// When a fault strikes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum When {
    /// At a time, s.
    At(f64),
    /// Before the byte with this number, from 0, that arrives at the board since it was made.
    ByteIn(u64),
    /// Before the byte with this number, from 0, that the board writes.
    ByteOut(u64),
}

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The next bytes to the board are lost.
    DropIn(u32),
    /// One bit of each of the next bytes to the board flips.
    CorruptIn(u32),
    /// The next bytes to the host are lost.
    DropOut(u32),
    /// One bit of each of the next bytes to the host flips.
    CorruptOut(u32),
    /// What comes to the board is lost up to and with the next line feed, but for the real-time bytes in between.
    TornLine,
    /// The next answers `ok` are never written.
    StuckOk(u32),
    /// The plug comes out. A board with its own power goes on with what it holds; one without stops at once.
    Unplug {
        /// True for a board with its own power.
        powered: bool,
    },
    /// The plug goes in again; who wants to talk must [`super::Board::open`].
    Replug,
    /// The board resets as when its button is pressed.
    Reset,
    /// The board says so many lines of its own accord.
    Chatter(u32),
}

/// Faults to come and those under way.
#[derive(Debug)]
pub(super) struct Faults {
    pending: Vec<(When, Fault)>,
    drop_in: u32,
    corrupt_in: u32,
    drop_out: u32,
    corrupt_out: u32,
    tearing: bool,
    stuck: u32,
    bytes_in: u64,
    bytes_out: u64,
    random: u64,
}

impl Faults {
    pub(super) fn new(seed: u64) -> Faults {
        Faults {
            pending: Vec::new(),
            drop_in: 0,
            corrupt_in: 0,
            drop_out: 0,
            corrupt_out: 0,
            tearing: false,
            stuck: 0,
            bytes_in: 0,
            bytes_out: 0,
            // Xorshift never leaves zero.
            random: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1,
        }
    }

    pub(super) fn schedule(&mut self, when: When, fault: Fault) {
        self.pending.push((when, fault));
    }

    /// When the next fault strikes that goes by time.
    pub(super) fn next_s(&self) -> Option<f64> {
        let times = self.pending.iter().filter_map(|(when, _)| if let When::At(s) = when { Some(*s) } else { None });
        times.min_by(f64::total_cmp)
    }

    /// Takes the next fault due by now that concerns the board itself; those of the bytes come into effect.
    pub(super) fn due(&mut self, now_s: f64) -> Option<Fault> {
        loop {
            let place = self.pending.iter().position(|(when, _)| match *when {
                When::At(s) => s <= now_s,
                When::ByteIn(n) => n <= self.bytes_in,
                When::ByteOut(n) => n <= self.bytes_out,
            })?;
            match self.pending.remove(place).1 {
                Fault::DropIn(n) => self.drop_in += n,
                Fault::CorruptIn(n) => self.corrupt_in += n,
                Fault::DropOut(n) => self.drop_out += n,
                Fault::CorruptOut(n) => self.corrupt_out += n,
                Fault::TornLine => self.tearing = true,
                Fault::StuckOk(n) => self.stuck += n,
                fault => return Some(fault),
            }
        }
    }

    /// What the board gets of a byte sent to it.
    pub(super) fn inward(&mut self, byte: u8) -> Option<u8> {
        self.bytes_in += 1;
        if self.tearing && !matches!(byte, b'?' | b'!' | b'~' | 0x18 | 0x80..) {
            self.tearing = byte != b'\n';
            return None;
        }
        if take_one(&mut self.drop_in) {
            return None;
        }
        Some(if take_one(&mut self.corrupt_in) { self.flip(byte) } else { byte })
    }

    /// What the host gets of a byte the board writes.
    pub(super) fn outward(&mut self, byte: u8) -> Option<u8> {
        self.bytes_out += 1;
        if take_one(&mut self.drop_out) {
            return None;
        }
        Some(if take_one(&mut self.corrupt_out) { self.flip(byte) } else { byte })
    }

    /// True when this `ok` is to be swallowed.
    pub(super) fn swallows_ok(&mut self) -> bool {
        take_one(&mut self.stuck)
    }

    /// One bit flipped (xorshift64, Marsaglia 2003).
    fn flip(&mut self, byte: u8) -> u8 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        byte ^ (1 << (self.random >> 32 & 7))
    }
}

fn take_one(count: &mut u32) -> bool {
    let any = *count > 0;
    *count -= u32::from(any);
    any
}
