//! The part of a file that an error quotes, and where it is: never more than a line of a terminal or two holds, and nothing that a
//! terminal obeys.

/// Most characters of a file that an error quotes.
pub const QUOTED_MAX: usize = 200;
/// Most characters of one word of a reader's own message, which may be a key or a value of the file.
const WORD_MAX: usize = 100;

/// A text cut to [`QUOTED_MAX`] characters, the last three of them dots where something is missing.
pub fn quoted(text: &str) -> String {
    cut(text, QUOTED_MAX)
}

/// A reader's message on one line, with words of a length that people write.
pub fn one_line(message: &str) -> String {
    message.split_whitespace().map(|word| cut(word, WORD_MAX)).collect::<Vec<_>>().join(" ")
}

/// Whether a character shows itself: no control character, and none that hides or changes the direction of the text.
pub fn is_plain(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    !turns && !c.is_control()
}

/// A tab as a space; what else does not show itself as its number.
pub fn plain(text: &str) -> String {
    let text = text.replace('\t', " ");
    if text.chars().all(is_plain) {
        return text;
    }
    text.chars().map(|c| if is_plain(c) { c.to_string() } else { c.escape_unicode().to_string() }).collect()
}

/// The line of a byte of a file, counted from 1.
pub fn line_at(bytes: &[u8], offset: usize) -> usize {
    1 + bytes.iter().take(offset).filter(|byte| **byte == b'\n').count()
}

/// The line that a reader of TOML complains about; the first where it names none.
pub fn line_of(text: &str, error: &toml::de::Error) -> usize {
    line_at(text.as_bytes(), error.span().map_or(0, |span| span.start))
}

fn cut(text: &str, most: usize) -> String {
    let shown = plain(text);
    if shown.chars().count() <= most {
        return shown;
    }
    let kept: String = shown.chars().take(most - 3).collect();
    kept + "..."
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_cut_between_characters_and_marked() {
        assert_eq!(quoted("speed_m_s = 2"), "speed_m_s = 2");
        let long = quoted(&"\u{e4}".repeat(10_000));
        assert_eq!((long.chars().count(), long.ends_with("\u{e4}...")), (200, true));
        let message = one_line(&format!("unknown field `{}`,\n expected one of", "k".repeat(5000)));
        assert!(message.starts_with("unknown field `kkk") && message.ends_with("... expected one of"), "{message}");
        assert!(message.len() < 150);
    }

    #[test]
    fn lines_are_counted_from_one() {
        let found = [0, 1, 2, 3, 100].map(|offset| line_at(b"a\nb\n", offset));
        assert_eq!(found, [1, 1, 2, 2, 3]);
        let text = "a = 1\n\nb = \n";
        assert_eq!(line_of(text, &toml::from_str::<toml::Table>(text).unwrap_err()), 3);
    }

    #[test]
    fn a_terminal_is_told_nothing() {
        assert_eq!(quoted("m\0\t\u{1b}[2J\u{202e}\u{b5}"), "m\\u{0} \\u{1b}[2J\\u{202e}\u{b5}");
        assert_eq!(one_line("unknown field `\u{7}a`,\n expected"), "unknown field `\\u{7}a`, expected");
        assert_eq!(quoted(&"\0".repeat(1000)).chars().count(), 200);
    }
}
