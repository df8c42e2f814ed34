//! The single-stroke alphabet.
//!
//! Plain upright letters after the proportions of technical lettering (ISO 3098): every bowl is a quarter circle or several, so that a
//! letter is a handful of lines and arcs and stays legible at 3 mm, where a laser's line is a tenth of its height.
//!
//! How the table reads: the grid's unit is an eighth of the cap height. A stroke is a run of points, two characters each: x, then y,
//! as hexadecimal digits. y is 2 on the baseline, 8 at the top of small letters, a (ten) at the top of capitals, 0 at the bottom of
//! descenders. A point is reached by a straight line, after `<` by an arc of 90 degrees that turns left (counter-clockwise), after
//! `>` by one that turns right. A space lifts the pen.

/// Cap height in grid units.
pub(super) const CAP_HEIGHT: f64 = 8.0;
/// Grid row of the baseline.
pub(super) const BASELINE: f64 = 2.0;
/// Empty columns between two glyphs.
pub(super) const GAP: f64 = 2.0;

/// One character: how many columns it spans, and its strokes.
pub(super) struct Glyph {
    pub width: f64,
    pub strokes: &'static str,
}

/// Drawn for characters the alphabet does not have.
pub(super) const BOX: Glyph = Glyph { width: 4.0, strokes: "020a4a4202" };

/// The glyph of `c`; a box when there is none.
pub(super) fn glyph(c: char) -> Glyph {
    let found = GLYPHS.binary_search_by_key(&c, |(letter, ..)| *letter);
    found.map_or(BOX, |i| Glyph { width: f64::from(GLYPHS[i].1), strokes: GLYPHS[i].2 })
}

/// Character, width, strokes; sorted by character.
const GLYPHS: &[(char, u8, &str)] = &[
    (' ', 2, ""),
    ('#', 4, "1319 3339 0545 0747"),
    ('%', 6, "125a 19<08<17<28<19 54<43<52<63<54"),
    ('&', 5, "521819>2a>39380504<22<55"),
    ('\'', 0, "0a08"),
    ('(', 2, "2b<21"),
    (')', 2, "0b>01"),
    ('*', 4, "2a26 0749 0947"),
    ('+', 4, "0646 2824"),
    (',', 1, "1301"),
    ('-', 3, "0636"),
    ('.', 0, "0302"),
    ('/', 4, "024a"),
    ('0', 4, "04<22<4448<2a<0804"),
    ('1', 2, "082a22"),
    ('2', 4, "08>2a>480242"),
    ('3', 4, "08>2a>48>26>44>22>04"),
    ('4', 4, "323a0444"),
    ('5', 4, "4a0a0626>44>2202"),
    ('6', 4, "4a<0604<22<44<26<04"),
    ('7', 4, "0a4a12"),
    ('8', 4, "26<48<2a<08<26>44>22>04>26"),
    ('9', 4, "02<4648<2a<08<26<48"),
    (':', 0, "0807 0403"),
    ('<', 4, "490643"),
    ('=', 4, "0747 0545"),
    ('>', 4, "094603"),
    ('A', 6, "023a62 1555"),
    ('B', 4, "020a2a>48>2606 26>44>2202"),
    ('C', 5, "58<3a2a<0804<2232<54"),
    ('D', 5, "020a3a>5854>3202"),
    ('E', 4, "4a0a0242 0636"),
    ('F', 4, "4a0a02 0636"),
    ('G', 5, "58<3a2a<0804<2232<545636"),
    ('H', 4, "020a 424a 0646"),
    ('I', 2, "0222 0a2a 121a"),
    ('J', 4, "4a44>22>04"),
    ('K', 4, "020a 4a0642"),
    ('L', 4, "0a0242"),
    ('M', 6, "020a366a62"),
    ('N', 4, "020a424a"),
    ('O', 5, "04<2232<5458<3a2a<0804"),
    ('P', 4, "020a2a>48>2606"),
    ('Q', 5, "04<2232<5458<3a2a<0804 3452"),
    ('R', 4, "020a2a>48>2606 2642"),
    ('S', 4, "48<2a<08<26>44>22>04"),
    ('T', 4, "0a4a 2a22"),
    ('U', 4, "0a04<22<444a"),
    ('V', 4, "0a224a"),
    ('W', 6, "0a1238526a"),
    ('X', 4, "024a 0a42"),
    ('Y', 4, "0a264a 2622"),
    ('Z', 4, "0a4a0242"),
    ('_', 4, "0141"),
    ('a', 4, "4842 46<28<0604<22<44"),
    ('b', 4, "0a02 06>28>4644>22>04"),
    ('c', 4, "46<28<0604<22<44"),
    ('d', 4, "4a42 46<28<0604<22<44"),
    ('e', 4, "054546<28<0604<2232<43"),
    ('f', 3, "3a<1812 0838"),
    ('g', 4, "4842>2010 46<28<0604<22<44"),
    ('h', 4, "0a02 06>28>4642"),
    ('i', 0, "0802 0a09"),
    ('j', 2, "2822>00 2a29"),
    ('k', 3, "0a02 380532"),
    ('l', 1, "0a03<12"),
    ('m', 6, "0802 07>1828>3732 37>4858>6762"),
    ('n', 4, "0802 06>28>4642"),
    ('o', 4, "04<22<4446<28<0604"),
    ('p', 4, "0800 06>28>4644>22>04"),
    ('q', 4, "4840 46<28<0604<22<44"),
    ('r', 3, "0802 06>2838"),
    ('s', 3, "37<2818<0706<1525>3433>2212>03"),
    ('t', 3, "1a14<32 0838"),
    ('u', 4, "0804<22<44 4842"),
    ('v', 4, "082248"),
    ('w', 6, "0812375268"),
    ('x', 4, "0248 0842"),
    ('y', 4, "0804<22<44 4842>2010"),
    ('z', 4, "08480242"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_sorted_and_every_character_people_need_is_in_it() {
        assert!(GLYPHS.windows(2).all(|w| w[0].0 < w[1].0));
        for c in ('A'..='Z').chain('a'..='z').chain('0'..='9').chain(" .,-+/:()#%='&_*<>".chars()) {
            assert!(GLYPHS.iter().any(|g| g.0 == c), "{c} is missing");
        }
    }

    #[test]
    fn no_two_characters_look_the_same() {
        for (i, a) in GLYPHS.iter().enumerate() {
            assert!(GLYPHS[i + 1..].iter().all(|b| b.2 != a.2) && a.2 != BOX.strokes, "{}", a.0);
        }
    }
}
