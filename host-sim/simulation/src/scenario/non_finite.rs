//! The first number of a TOML text that is not finite: the text in; its byte offset out.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Its first byte; nothing where all are finite, or the text is no TOML.
pub(super) fn non_finite(text: &str) -> Option<usize> {
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
        assert_eq!(non_finite(text), text.find("-nan"));
        assert_eq!(non_finite(&text.replace("-nan", "1_000.0")), text.replace("-nan", "1_000.0").find("inf"));
        assert_eq!(non_finite("a = 1e999"), Some(4));
        assert_eq!((non_finite("a = 1.0\nb = \"nan\"\n"), non_finite("a = nan nan")), (None, None));
    }
}
