//! A distribution as it is written in TOML in; its kind and its figures, or why it is none, out.

use toml::{Table, Value};

use super::{FARTHEST, Kind, SHARE_LEAST};

/// Names of the distributions.
const KINDS: [&str; 4] = ["uniform", "normal", "log_normal", "choice"];
/// How one is written, for messages.
pub(super) const EXAMPLE: &str = "write { uniform = [least, most] }, { normal = [mean, deviation] }, { log_normal = [median, deviation \
                       of the logarithm] } or { choice = [...] }";

pub(super) fn is_distribution(table: &Table) -> bool {
    table.keys().any(|key| KINDS.contains(&key.as_str())) || table.contains_key("relative")
}

pub(super) fn finite(value: &Value) -> Result<f64, String> {
    let number = value.as_float().or(value.as_integer().map(|whole| whole as f64));
    number.filter(|number| number.is_finite()).ok_or_else(|| format!("{value} is no finite number"))
}

pub(super) fn distribution(table: &Table) -> Result<(Kind, bool), String> {
    let known = |key: &str| KINDS.contains(&key) || ["min", "max", "relative"].contains(&key);
    if let Some(key) = table.keys().find(|key| !known(key)) {
        return Err(format!("unknown key {key}; {EXAMPLE}, with min, max or relative = true"));
    }
    let kinds: Vec<&str> = KINDS.into_iter().filter(|kind| table.contains_key(*kind)).collect();
    let [kind] = kinds[..] else { return Err(format!("must be one distribution; {EXAMPLE}")) };
    let numbers: Vec<f64> = match &table[kind] {
        Value::Array(list) => list.iter().map(finite).collect::<Result<_, _>>()?,
        other => return Err(format!("{kind} = {other}: must be a list of numbers")),
    };
    let relative = match table.get("relative") {
        None => false,
        Some(value) => value.as_bool().ok_or_else(|| format!("relative = {value}: must be true or false"))?,
    };
    let bound = |key: &str| table.get(key).map(finite).transpose();
    let (min, max) = (bound("min")?, bound("max")?);
    let two = || <[f64; 2]>::try_from(numbers.clone()).map_err(|_| format!("{kind} takes two numbers; {EXAMPLE}"));
    let bounds = |[least, most]: [f64; 2]| {
        let bounds = [min.unwrap_or(least).max(least), max.unwrap_or(most).min(most)];
        if bounds[0] <= bounds[1] {
            Ok(bounds)
        } else {
            Err("min and max leave nothing to draw; widen them".to_owned())
        }
    };
    let kind = match kind {
        "normal" | "log_normal" => {
            let [middle, deviation] = two()?;
            if deviation < 0.0 || kind == "log_normal" && middle <= 0.0 {
                return Err(format!(
                    "{kind} = [{middle}, {deviation}]: a deviation is not negative, a median positive"
                ));
            }
            if kind == "normal" {
                let far = FARTHEST * deviation;
                let [least, most] = bounds([middle - far, middle + far])?;
                enough(share([least - middle, most - middle], deviation))?;
                Kind::Normal([middle, deviation], [least, most])
            } else {
                let far = (FARTHEST * deviation).exp();
                let [least, most] = bounds([middle / far, middle * far])?;
                enough(share([(least / middle).ln(), (most / middle).ln()], deviation))?;
                Kind::LogNormal([middle, deviation], [least, most])
            }
        }
        _ if min.is_some() || max.is_some() => {
            return Err(format!("min and max belong to normal and log_normal; {kind} has its own ends"));
        }
        "uniform" => {
            let [least, most] = two()?;
            if least > most {
                return Err(format!("uniform = [{least}, {most}]: the least comes first"));
            }
            Kind::Uniform([least, most])
        }
        _ if numbers.is_empty() => return Err("choice = []: nothing to choose from".to_owned()),
        _ => Kind::Choice(numbers),
    };
    Ok((kind, relative))
}

/// The share of a normal distribution of mean 0 between two numbers.
fn share(ends: [f64; 2], deviation: f64) -> f64 {
    if deviation == 0.0 {
        return 1.0;
    }
    let [least, most] = ends.map(|end| 0.5 * libm::erf(end / (deviation * std::f64::consts::SQRT_2)));
    most - least
}

/// Draws beyond the bounds are drawn again: that has to come to an end.
fn enough(share: f64) -> Result<(), String> {
    if share >= SHARE_LEAST {
        return Ok(());
    }
    let [left, least] = [share, SHARE_LEAST].map(|share| 100.0 * share);
    Err(format!(
        "min and max leave {left:.1e} % of the distribution, {least} % is the least; widen them, or write uniform"
    ))
}
