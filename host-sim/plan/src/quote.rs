//! The part of a file that an error quotes: never more than a line of a terminal or two holds.

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

fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let kept: String = text.chars().take(most - 3).collect();
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
}
