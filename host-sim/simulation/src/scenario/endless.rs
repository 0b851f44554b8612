//! Numbers that are none, or have no end: the text of a file in; where the first of them is written out.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The first byte of it; nothing of a text that is no TOML.
pub(super) fn endless(text: &str) -> Option<usize> {
    first(DeTable::parse(text).ok()?.get_ref().values())
}

fn first<'a>(values: impl IntoIterator<Item = &'a Spanned<DeValue<'a>>>) -> Option<usize> {
    // Tables are sorted by their keys: the first is the one that is written first.
    let found = values.into_iter().filter_map(|value| match value.get_ref() {
        DeValue::Float(float) => {
            let is_finite = float.as_str().parse::<f64>().is_ok_and(f64::is_finite);
            (!is_finite).then_some(value.span().start)
        }
        DeValue::Array(list) => first(list.iter()),
        DeValue::Table(table) => first(table.values()),
        _ => None,
    });
    found.min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_place_of_all_tables_and_lists_is_found() {
        let text = "b = 1.5e3\na = 7\n[z]\ny = [1.0, -nan]\n[c]\nd = { e = inf }\n";
        assert_eq!(endless(text), text.find("-nan"));
        assert_eq!(endless(&text.replace("-nan", "1_000.0")), text.replace("-nan", "1_000.0").find("inf"));
        assert_eq!(endless("a = 1e999"), Some(4));
        assert_eq!((endless("a = 1.0\nb = \"nan\"\n"), endless("a = nan nan")), (None, None));
    }
}
