//! How far a jog may go.

use super::board::Board;

/// The part of a way that stays within the machine's travel, mm, for each axis by itself. Where the board knows its place (soft limits, $20, or
/// homed in this session), it ends at the rim of the travel ($130, $131); elsewhere only the length of the way is
/// bounded. `from_mm` is in machine coordinates; `travel_mm` stands in for what the board does not tell.
pub fn within_travel(board: &Board, from_mm: Option<[f64; 3]>, way_mm: [f64; 2], travel_mm: [f64; 2]) -> [f64; 2] {
    let knows_place = board.homed || board.switch(20) == Some(true);
    std::array::from_fn(|axis| {
        let travel_mm = board.settings.get(&(130 + axis as u16)).copied().unwrap_or(travel_mm[axis]);
        match from_mm.filter(|_| knows_place) {
            // A tool that stands outside may come back and go no farther.
            Some(from_mm) => {
                let (low, high) = board.reach_mm(axis, travel_mm);
                way_mm[axis].clamp((low - from_mm[axis]).min(0.0), (high - from_mm[axis]).max(0.0))
            }
            None => way_mm[axis].clamp(-travel_mm, travel_mm),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_ends_at_the_rim_where_the_place_is_known_and_at_the_travel_where_it_is_not() {
        let mut board = Board { settings: [(20, 1.0), (130, 300.0), (131, 200.0)].into(), ..Board::default() };
        let from = Some([-10.0, -195.0, 0.0]);
        assert_eq!(within_travel(&board, from, [50.0, -50.0], [400.0; 2]), [10.0, -5.0]);
        assert_eq!(within_travel(&board, from, [-5.0, 5.0], [400.0; 2]), [-5.0, 5.0]);
        assert_eq!(within_travel(&board, Some([2.0, -1.0, 0.0]), [1.0, 0.0], [400.0; 2]), [0.0, 0.0]);
        board.settings = [(130, 300.0)].into();
        assert_eq!(within_travel(&board, from, [900.0, -900.0], [400.0; 2]), [300.0, -400.0]);
    }
}
