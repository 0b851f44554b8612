//! The first difference of a committed file: its contents and the right ones in; the line, byte or key that differs
//! out, and nothing where they agree.

use serde_json::Value;

use crate::gains::artifacts::{FIGURES, document};
use crate::gains::certified::Certified;
use crate::gains::rounding::{SAME_GAIN, is_same_figure};

/// A decimal of an f64 is read to one rounding.
const READ: f64 = 1e-15;

/// The comparison of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Comparison {
    /// Byte for byte.
    Bytes,
    /// Text byte for byte between its numbers; integers exactly, others to this share of themselves, or of 1 below 1.
    Numbers(f64),
}

/// The computed text with each line that is near the committed one as committed: the first difference is a real one.
pub(super) fn with_near_lines_of(committed: &[u8], computed: &[u8], comparison: Comparison) -> Vec<u8> {
    let lines = |text| <[u8]>::split_inclusive(text, |byte| *byte == b'\n');
    let nothing: &[u8] = &[];
    let pairs = lines(computed).zip(lines(committed).chain(std::iter::repeat(nothing)));
    pairs.flat_map(|(there, here)| if is_near(here, there, comparison) { here } else { there }).copied().collect()
}

pub(super) fn is_near(committed: &[u8], computed: &[u8], comparison: Comparison) -> bool {
    let (Comparison::Numbers(share), Ok(committed), Ok(computed)) =
        (comparison, std::str::from_utf8(committed), std::str::from_utf8(computed))
    else {
        return committed == computed;
    };
    let is_in_number = |c: char| c.is_ascii_alphanumeric() || ['.', '-', '_'].contains(&c);
    let words = |text| str::split_inclusive(text, move |c| !is_in_number(c));
    let (mut here, mut there) = (words(committed), words(computed));
    loop {
        match (here.next(), there.next()) {
            (None, None) => return true,
            (Some(here), Some(there)) if here == there => {}
            (Some(here), Some(there)) if is_near_number(here, there, share) => {}
            _ => return false,
        }
    }
}

/// Two numbers with a point, each with the character that ends it.
fn is_near_number(here: &str, there: &str, share: f64) -> bool {
    let parted = |word: &str| {
        let (at, end) = word.char_indices().next_back()?;
        let digits = word.get(..at).filter(|digits| digits.contains('.') || digits.contains('e'))?;
        digits.parse::<f64>().ok().map(|number| (number, end))
    };
    match (parted(here), parted(there)) {
        (Some((here, end)), Some((there, other_end))) => {
            end == other_end && (here - there).abs() <= share * there.abs().max(1.0)
        }
        _ => false,
    }
}

pub(super) fn byte_difference(committed: &[u8], computed: &[u8]) -> Option<String> {
    if committed == computed {
        return None;
    }
    if let (Ok(committed), Ok(computed)) = (std::str::from_utf8(committed), std::str::from_utf8(computed)) {
        let end = "(the end)";
        let lines = committed.lines().count().max(computed.lines().count()) + 1;
        let mut pairs = committed.lines().chain([end]).zip(computed.lines().chain([end])).take(lines);
        if let Some((number, (here, there))) =
            (1..).zip(&mut pairs).find(|(_, (committed, computed))| committed != computed)
        {
            return Some(format!("line {number} is `{}`; its design gives `{}`", here.trim(), there.trim()));
        }
    }
    let position = committed.iter().zip(computed).position(|(committed, computed)| committed != computed);
    Some(match position {
        Some(at) => {
            format!("byte {at} is {:#04x}; its design gives {:#04x}", committed[at], computed[at])
        }
        None => format!("{} bytes; its design gives {}", committed.len(), computed.len()),
    })
}

/// The comparison of numbers.
#[derive(Clone, Copy)]
enum Rule {
    Figure,
    Relative(f64),
}

pub(super) fn json_difference(committed: &[u8], certified: &Certified) -> Option<String> {
    let committed: Value = match serde_json::from_slice(committed) {
        Ok(value) => value,
        Err(error) => return Some(format!("no JSON ({error})")),
    };
    difference("", &committed, &document(certified), Rule::Relative(READ))
}

fn difference(path: &str, committed: &Value, computed: &Value, rule: Rule) -> Option<String> {
    match (committed, computed) {
        (Value::Object(here), Value::Object(there)) => {
            if let Some(key) = here.keys().find(|key| !there.contains_key(*key)) {
                return Some(format!("{path}{key} is there; its design gives none"));
            }
            there.iter().find_map(|(key, computed)| {
                let rule = match key.as_str() {
                    key if FIGURES.contains(&key) => Rule::Figure,
                    "gain" => Rule::Relative(SAME_GAIN),
                    _ => rule,
                };
                let dot = if computed.is_object() { "." } else { "" };
                match here.get(key) {
                    Some(committed) => difference(&format!("{path}{key}{dot}"), committed, computed, rule),
                    None => Some(format!("{path}{key} is missing")),
                }
            })
        }
        (Value::Array(here), Value::Array(there)) if here.len() == there.len() => {
            here.iter().zip(there).enumerate().find_map(|(i, (committed, computed))| {
                let dot = if computed.is_object() { "." } else { "" };
                difference(&format!("{path}[{i}]{dot}"), committed, computed, rule)
            })
        }
        (Value::Number(_), Value::Number(_)) => {
            let (here, there) = (committed.as_f64()?, computed.as_f64()?);
            let same = match rule {
                Rule::Figure => is_same_figure(here, there),
                Rule::Relative(share) => (here - there).abs() <= share * there.abs(),
            };
            (!same).then(|| format!("{path} is {here}; its design gives {there}"))
        }
        _ if committed == computed => None,
        _ => Some(format!("{path} is {committed}; its design gives {computed}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_may_differ_in_their_last_digits_and_nothing_else() {
        let near = |committed: &str, computed: &str| {
            is_near(committed.as_bytes(), computed.as_bytes(), Comparison::Numbers(1e-6))
        };
        let text = "pub static W: [Piece; 1] = [\n    duration_ns: 315789474,\n    x: [0.25, -1.5e-3, 2000.0],\n];\n";
        assert!(near(text, text));
        // Below 1 by 1e-6, above by that share.
        assert!(near(&text.replace("0.25", "0.2500009"), text) && !near(&text.replace("0.25", "0.2500011"), text));
        assert!(near(&text.replace("2000.0", "2000.0019"), text) && !near(&text.replace("2000.0", "2000.0021"), text));
        assert!(near(&text.replace("-1.5e-3", "-0.0015005"), text) && !near(&text.replace("-1.5e-3", "1.5e-3"), text));
        // Integers, names, and how many numbers there are.
        for (from, to) in [("474", "475"), ("W", "V"), (", 2000.0", ""), ("2000.0]", "2000.0)"), ("];\n", "];")] {
            assert!(!near(&text.replace(from, to), text), "{to} instead of {from}");
        }
    }
}
