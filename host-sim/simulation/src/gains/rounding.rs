//! Figures of six digits: a JSON value in; the same with its numbers rounded, or held against one that was, out.

use serde_json::Value;

/// Digits of a figure.
const DIGITS: usize = 6;
/// Beyond the rounding to six digits, figures of two processors agree to this share.
pub(super) const SAME_FIGURE: f64 = 1e-6;
/// Gains in f64 agree to this share.
pub(super) const SAME_GAIN: f64 = 1e-9;
/// A number below this share of the largest of its list is zero but for rounding: imaginary parts of real poles.
const DUST: f64 = 1e-7;

/// Every number that is no integer, rounded to six digits.
pub(super) fn rounded(value: Value) -> Value {
    each_number(value, &to_digits)
}

/// Every list of numbers, or of lists of them, with numbers that are only rounding beside its largest set to zero.
pub(super) fn without_dust(value: Value) -> Value {
    match value {
        Value::Array(entries) => {
            let list = Value::Array(entries);
            let least = DUST * largest(&list);
            if least > 0.0 {
                return each_number(list, &|x| if x.abs() < least { 0.0 } else { x });
            }
            let Value::Array(entries) = list else { return list };
            Value::Array(entries.into_iter().map(without_dust).collect())
        }
        Value::Object(entries) => {
            Value::Object(entries.into_iter().map(|(key, entry)| (key, without_dust(entry))).collect())
        }
        other => other,
    }
}

/// Largest number of a list or of its lists; 0 for a list of anything else.
fn largest(value: &Value) -> f64 {
    match value {
        Value::Array(entries) => entries.iter().map(largest).fold(0.0, f64::max),
        Value::Number(number) => number.as_f64().map_or(0.0, f64::abs),
        _ => 0.0,
    }
}

fn each_number(value: Value, change: &impl Fn(f64) -> f64) -> Value {
    match value {
        Value::Number(number) if number.is_f64() => number.as_f64().map_or(Value::Null, |x| Value::from(change(x))),
        Value::Array(entries) => Value::Array(entries.into_iter().map(|entry| each_number(entry, change)).collect()),
        Value::Object(entries) => {
            Value::Object(entries.into_iter().map(|(key, entry)| (key, each_number(entry, change))).collect())
        }
        other => other,
    }
}

/// The nearest number of six digits.
pub(super) fn to_digits(x: f64) -> f64 {
    format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x)
}

/// Whether a figure that was rounded to six digits is the one that was computed.
pub(super) fn is_same_figure(committed: f64, computed: f64) -> bool {
    if committed == computed {
        return true;
    }
    let size = committed.abs().max(computed.abs());
    let last_digit = 10_f64.powi(size.log10().floor() as i32 - (DIGITS as i32 - 1));
    (committed - computed).abs() <= 0.5 * last_digit + SAME_FIGURE * size
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_itself_through_its_rounding_and_not_its_neighbour() {
        for figure in [1.234_564_9, -9.999_994, 0.017_091_35, 1e-12 / 3.0, 123_456.4] {
            let written = to_digits(figure);
            for other_processor in [1.0 - 1e-8, 1.0, 1.0 + 1e-8] {
                assert!(is_same_figure(written, figure * other_processor), "{figure}");
            }
            assert!(!is_same_figure(written * (1.0 + 2e-5), figure), "{figure}");
        }
        assert!(is_same_figure(0.0, 0.0) && !is_same_figure(0.0, 1e-9) && !is_same_figure(1.0, f64::NAN));
    }

    #[test]
    fn dust_in_a_list_of_poles_is_zero() {
        let poles = serde_json::json!({ "poles": [[-2.0, 1e-12], [-1e-10, 3.0]], "small": 1e-12, "name": ["a"] });
        let clean = serde_json::json!({ "poles": [[-2.0, 0.0], [0.0, 3.0]], "small": 1e-12, "name": ["a"] });
        assert_eq!(without_dust(poles), clean);
    }
}
