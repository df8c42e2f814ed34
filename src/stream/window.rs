//! Lines on their way: sent and not answered. Character counting keeps their bytes within the board's receive buffer.

use std::collections::VecDeque;

use super::course::Effect;

/// What an unanswered line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A line of the job, by its number in the file, from 1.
    Job(usize),
    /// A question or an order of ours.
    Order,
}

/// A line that was sent and not answered.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) text: String,
    pub(super) kind: Kind,
    /// Nothing may follow it before it is answered.
    pub(super) alone: bool,
    /// How long the machine stands before it answers, s.
    pub(super) dwell_s: f64,
    /// What a line of the job makes the board do.
    pub(super) effect: Effect,
}

impl Entry {
    /// Bytes it takes in the receive buffer, its line feed with it.
    pub(super) fn bytes(&self) -> usize {
        self.text.len() + 1
    }
}

/// All lines that were sent and not answered, oldest first.
#[derive(Debug, Default)]
pub(super) struct Window {
    entries: VecDeque<Entry>,
    bytes: usize,
}

impl Window {
    /// Bytes under way.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    pub(super) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Dwells under way, s.
    pub(super) fn dwell_s(&self) -> f64 {
        self.entries.iter().map(|entry| entry.dwell_s).sum()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The line the next answer is for.
    pub(super) fn first(&self) -> Option<&Entry> {
        self.entries.front()
    }

    /// True when a line of `chars` characters and its line feed may be sent into a buffer of `rx_bytes`.
    pub(super) fn has_room(&self, chars: usize, rx_bytes: usize) -> bool {
        self.bytes + chars < rx_bytes
    }

    /// A line was sent.
    pub(super) fn push(&mut self, entry: Entry) {
        self.bytes += entry.bytes();
        self.entries.push_back(entry);
    }

    /// A line was answered.
    pub(super) fn pop(&mut self) -> Option<Entry> {
        let entry = self.entries.pop_front()?;
        self.bytes -= entry.bytes();
        Some(entry)
    }

    /// The board has forgotten everything.
    pub(super) fn clear(&mut self) {
        self.entries.clear();
        self.bytes = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bytes_under_way_are_those_of_the_unanswered_lines_and_never_beyond_the_buffer(
            rx_bytes in 80_usize..300,
            steps in prop::collection::vec(prop_oneof![4 => (1_usize..79).prop_map(Some), 3 => Just(None)], 0..400),
        ) {
            let mut window = Window::default();
            let mut model: VecDeque<usize> = VecDeque::new();
            for (i, step) in steps.into_iter().enumerate() {
                match step {
                    Some(chars) if window.has_room(chars, rx_bytes) => {
                        window.push(Entry { text: "X".repeat(chars), kind: Kind::Job(i), alone: false, dwell_s: 0.0, effect: Effect::default() });
                        model.push_back(chars + 1);
                    }
                    Some(chars) => prop_assert!(model.iter().sum::<usize>() + chars + 1 > rx_bytes),
                    None => prop_assert_eq!(window.pop().map(|e| e.bytes()), model.pop_front()),
                }
                prop_assert_eq!(window.bytes(), model.iter().sum::<usize>());
                prop_assert!(window.bytes() <= rx_bytes);
                prop_assert_eq!(window.len(), model.len());
            }
        }
    }
}
