//! Names that were nearly right: the typed one and all names in; the one that was meant, as a question, out.

/// How alike two names must be, by Jaro and Winkler, 1 for the same: a slip of two letters in ten.
const ALIKE: f64 = 0.8;

/// `; did you mean NAME?`, or nothing.
pub(super) fn did_you_mean<'a>(typed: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let typed = typed.to_lowercase();
    let scored = names.into_iter().map(|name| (strsim::jaro_winkler(&typed, name), name));
    match scored.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((alike, name)) if alike > ALIKE => format!("; did you mean {name}?"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_recognised_and_another_word_is_not() {
        let names = ["crazyflie-2.1", "crazyflie-2.1-brushless", "mellinger"];
        assert_eq!(did_you_mean("crazyfly-2.1", names), "; did you mean crazyflie-2.1?");
        assert_eq!(did_you_mean("Melinger", names), "; did you mean mellinger?");
        assert_eq!(did_you_mean("boeing", names), "");
    }
}
