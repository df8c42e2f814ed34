//! Names in letters that the page's face does not have, spelt with those it has: what is printed can be read out and typed, and no letter is lost.

/// Latin letters U+0100 to U+017F without their accents, in that order.
const LATIN: &str = "A a A a A a C c C c C c C c D d D d E e E e E e E e E e G g G g G g G g H h H h I i I i I i I i I i IJ ij J j K k k \
    L l L l L l L l L l N n N n N n 'n Ng ng O o O o O o OE oe R r R r R r S s S s S s S s T t T t T t U u U u U u U u U u U u W w Y y Y Z z Z z Z z s";
/// First letter of [`LATIN`].
const LATIN_FROM: u32 = 0x100;

/// Small Greek and Cyrillic letters, each before its spelling.
const OTHERS: &str = "α a ά a β v γ g δ d ε e έ e ζ z η i ή i θ th ι i ί i ϊ i ΐ i κ k λ l μ m ν n ξ x ο o ό o π p ρ r σ s ς s τ t υ u ύ u ϋ u ΰ u φ f χ ch ψ ps ω o ώ o \
    а a б b в v г g д d е e ж zh з z и i й i к k л l м m н n о o п p р r с s т t у u ф f х kh ц ts ч ch ш sh щ shch ъ ' ы y ь ' э e ю iu я ia ё e \
    є ie і i ї i ґ g ў u ђ dj ј j љ lj њ nj ћ c џ dz";

/// Dashes, quotation marks and their like.
const SIGNS: &[(char, &str)] = &[
    ('–', "-"),
    ('—', "-"),
    ('‘', "'"),
    ('’', "'"),
    ('“', "\""),
    ('”', "\""),
    ('„', "\""),
    ('…', "..."),
    ('€', "EUR"),
    ('•', "-"),
];

/// A character in plain letters: without its accent, in Latin script, or as its number ("U+718A ") where it belongs to a script that is not spelt letter by letter. Marks
/// that only change the letter before them are left out.
pub(super) fn spelt(c: char) -> String {
    if let Some(spelling) = latin(c).or_else(|| sign(c)).or_else(|| other(c)) {
        return spelling.to_owned();
    }
    let small: Vec<char> = c.to_lowercase().collect();
    if let ([small], true) = (small.as_slice(), c.is_uppercase())
        && let Some(spelling) = other(*small)
    {
        let (first, rest) = spelling.split_at(1);
        return first.to_uppercase() + rest;
    }
    match c {
        // Accents that follow their letter, as some systems store names.
        '\u{300}'..='\u{36f}' => String::new(),
        c if c.is_control() || c.is_whitespace() => " ".to_owned(),
        c => format!("U+{:04X} ", c as u32),
    }
}

fn latin(c: char) -> Option<&'static str> {
    let index = (c as u32).checked_sub(LATIN_FROM)? as usize;
    LATIN.split_whitespace().nth(index)
}

fn sign(c: char) -> Option<&'static str> {
    SIGNS.iter().find(|(sign, _)| *sign == c).map(|(_, spelling)| *spelling)
}

fn other(c: char) -> Option<&'static str> {
    let mut words = OTHERS.split_whitespace();
    while let (Some(letter), Some(spelling)) = (words.next(), words.next()) {
        if letter.starts_with(c) {
            return Some(spelling);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latin_table_has_a_spelling_for_each_of_its_letters() {
        assert_eq!(LATIN.split_whitespace().count(), 0x180 - LATIN_FROM as usize);
        let spelling: String = "\u{10c}\u{159}\u{142}\u{151}\u{17e}\u{17f}".chars().map(spelt).collect();
        assert_eq!(spelling, "Crlozs");
    }

    #[test]
    fn greek_and_cyrillic_are_spelt_capitals_included_and_nothing_is_a_question_mark() {
        let word = |text: &str| text.chars().map(spelt).collect::<String>();
        assert_eq!(word("Αρκούδα"), "Arkouda");
        assert_eq!(word("Щука"), "Shchuka");
        assert_eq!(word("–“€”"), "-\"EUR\"");
        assert_eq!(word("\u{308}\u{718a}\u{1f43b}"), "U+718A U+1F43B ");
        assert!(OTHERS.split_whitespace().count().is_multiple_of(2));
        assert!(OTHERS.split_whitespace().skip(1).step_by(2).all(|s| s.is_ascii()));
    }
}
