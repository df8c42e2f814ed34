//! The serial link: bytes take their time on the wire, the receive buffer overflows silently, and while the EEPROM is written nothing is received
//! but what fits the receiver's own two bytes.

use std::collections::VecDeque;

/// Bytes the UART itself holds while interrupts are off: two in its buffer and one in its shift register (ATmega328p data sheet, USART).
const UART_BYTES: usize = 3;

/// Time an ATmega328p takes to write one byte of the EEPROM with interrupts off, s (ATmega328p data sheet: 3.4 ms erase and write).
pub(super) const EEPROM_BYTE_S: f64 = 0.0034;

/// Bytes of the transmit buffer: what does not fit keeps the controller waiting.
const TX_BYTES: f64 = 104.0;

/// Both directions of the link, and the receive buffer.
#[derive(Debug)]
pub(super) struct Link {
    byte_s: f64,
    /// Time to write one byte of the EEPROM, in which nothing is heard, s.
    eeprom_byte_s: f64,
    capacity: usize,
    /// On the wire to the board: when each byte has arrived.
    inbound: VecDeque<(f64, u8)>,
    in_free_s: f64,
    ring: VecDeque<u8>,
    /// On the wire to the host.
    outbound: VecDeque<(f64, u8)>,
    out_free_s: f64,
    /// The EEPROM is being written from .0 to .1.
    stall: Option<(f64, f64)>,
    stalled_byte: usize,
    in_uart: usize,
    /// Bytes lost because the buffer was full or the board did not look.
    pub(super) lost: u64,
}

impl Link {
    pub(super) fn new(baud: f64, capacity: usize, eeprom_byte_s: f64) -> Link {
        Link {
            byte_s: 10.0 / baud,
            eeprom_byte_s,
            capacity,
            inbound: VecDeque::new(),
            in_free_s: 0.0,
            ring: VecDeque::new(),
            outbound: VecDeque::new(),
            out_free_s: 0.0,
            stall: None,
            stalled_byte: 0,
            in_uart: 0,
            lost: 0,
        }
    }

    /// The host writes a byte.
    pub(super) fn send_in(&mut self, now_s: f64, byte: u8) {
        self.in_free_s = self.in_free_s.max(now_s) + self.byte_s;
        self.inbound.push_back((self.in_free_s, byte));
    }

    /// When the next byte arrives at the board.
    pub(super) fn next_in_s(&self) -> Option<f64> {
        self.inbound.front().map(|(s, _)| *s)
    }

    /// Takes the byte that has arrived by now, with when it did.
    pub(super) fn arrived(&mut self, now_s: f64) -> Option<(f64, u8)> {
        self.inbound.front().filter(|(s, _)| *s <= now_s)?;
        self.inbound.pop_front()
    }

    /// True when a byte that arrives at `s` is taken from the UART before the next ones push it out. Counts it as lost otherwise.
    pub(super) fn is_heard(&mut self, s: f64) -> bool {
        let Some((from, to)) = self.stall else { return true };
        if s >= to || s < from {
            return true;
        }
        // Between two bytes of the EEPROM interrupts are on for a moment, and what the UART holds is fetched.
        let byte = ((s - from) / self.eeprom_byte_s) as usize;
        if byte != self.stalled_byte {
            (self.stalled_byte, self.in_uart) = (byte, 0);
        }
        self.in_uart += 1;
        let heard = self.in_uart <= UART_BYTES;
        self.lost += u64::from(!heard);
        heard
    }

    /// Writes a number of EEPROM bytes from now on; returns when done.
    pub(super) fn stall(&mut self, now_s: f64, bytes: usize) -> f64 {
        let done_s = now_s + bytes as f64 * self.eeprom_byte_s;
        self.stall = Some((now_s, done_s));
        (self.stalled_byte, self.in_uart) = (0, 0);
        done_s
    }

    /// Puts a byte into the receive buffer; lost without a word when it is full.
    pub(super) fn store(&mut self, byte: u8) {
        if self.ring.len() < self.capacity {
            self.ring.push_back(byte);
        } else {
            self.lost += 1;
        }
    }

    /// The controller reads a byte.
    pub(super) fn read(&mut self) -> Option<u8> {
        self.ring.pop_front()
    }

    /// Free places of the receive buffer.
    pub(super) fn free(&self) -> usize {
        self.capacity - self.ring.len()
    }

    /// Empties the receive buffer.
    pub(super) fn clear_ring(&mut self) {
        self.ring.clear();
        self.stall = None;
    }

    /// The plug is out: nothing on the wire arrives.
    pub(super) fn cut(&mut self, now_s: f64) {
        self.inbound.clear();
        self.outbound.clear();
        self.in_free_s = now_s;
        self.out_free_s = now_s;
    }

    /// The board writes a byte.
    pub(super) fn send_out(&mut self, now_s: f64, byte: u8) {
        self.out_free_s = self.out_free_s.max(now_s) + self.byte_s;
        self.outbound.push_back((self.out_free_s, byte));
    }

    /// When the next byte reaches the host.
    pub(super) fn next_out_s(&self) -> Option<f64> {
        self.outbound.front().map(|(s, _)| *s)
    }

    /// When the transmit buffer has room again for a controller that has just written to it.
    pub(super) fn written_s(&self) -> f64 {
        self.out_free_s - TX_BYTES * self.byte_s
    }

    /// What has reached the host by now.
    pub(super) fn delivered(&mut self, now_s: f64) -> Vec<u8> {
        let count = self.outbound.partition_point(|(s, _)| *s <= now_s);
        self.outbound.drain(..count).map(|(_, byte)| byte).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_buffer_drops_the_newest_bytes_without_a_word() {
        let mut link = Link::new(115_200.0, 128, EEPROM_BYTE_S);
        (0..200).for_each(|k| link.store(k));
        assert_eq!((link.free(), link.lost), (0, 72));
        assert_eq!(link.read(), Some(0));
    }

    #[test]
    fn bytes_take_ten_bits_each_way() {
        let mut link = Link::new(115_200.0, 128, EEPROM_BYTE_S);
        (0..10).for_each(|_| link.send_in(1.0, b'x'));
        assert_eq!(link.arrived(1.0 + 8e-5), None);
        assert!((link.next_in_s().unwrap() - 1.0 - 10.0 / 115_200.0).abs() < 1e-12);
        link.send_out(2.0, b'o');
        assert!(link.delivered(2.0).is_empty());
        assert_eq!(link.delivered(2.0001), b"o");
    }

    #[test]
    fn while_the_eeprom_is_written_three_bytes_survive_per_byte_written() {
        let mut link = Link::new(115_200.0, 128, EEPROM_BYTE_S);
        let done_s = link.stall(0.0, 2);
        let heard = |from: f64, link: &mut Link| (0..30).filter(|k| link.is_heard(from + f64::from(*k) * 1e-4)).count();
        assert_eq!(heard(0.0, &mut link), 3);
        assert_eq!(heard(EEPROM_BYTE_S, &mut link), 3);
        assert_eq!(link.lost, 54);
        assert!(link.is_heard(done_s));
    }
}
