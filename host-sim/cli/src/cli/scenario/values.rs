//! Values of flags: texts in, and where there is a flag its value over the file's, out.

use std::str::FromStr;

use quatrack_simulation::scenario::Law;
use quatrack_simulation::scenario::file::Estimator;
use quatrack_simulation::scenario::flight::Setpoints;

use crate::cli::names::did_you_mean;

/// Numbers with commas in between.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) struct List<const N: usize>(pub(in crate::cli) [f64; N]);

impl<const N: usize> FromStr for List<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.map(Self).ok_or_else(|| format!("must be {N} numbers with commas in between"))
    }
}

pub(super) fn law(text: &str) -> Result<Law, String> {
    text.parse().map_err(|error| format!("{error}{}", did_you_mean(text, Law::ALL.map(Law::name))))
}

pub(super) fn setpoints(text: &str) -> Result<Setpoints, String> {
    match text {
        "100hz" => Ok(Setpoints::At100Hz),
        "exact" => Ok(Setpoints::Exact),
        _ => Err("must be 100hz or exact".to_owned()),
    }
}

pub(super) fn estimator(text: &str) -> Result<Estimator, String> {
    match text {
        "exact" => Ok(Estimator::Exact),
        "kalman" => Ok(Estimator::Kalman),
        _ => Err("must be exact or kalman".to_owned()),
    }
}

/// Puts a flag's value, where there is one, over the file's.
pub(super) fn over<T: Clone>(file: &mut Option<T>, flag: &Option<T>) {
    if flag.is_some() {
        file.clone_from(flag);
    }
}

/// Likewise a list.
pub(super) fn over_list<const N: usize>(file: &mut Option<[f64; N]>, flag: Option<List<N>>) {
    over(file, &flag.map(|List(values)| values));
}

/// A path of the command line, beside the file's, which begin at its folder.
pub(super) fn from_here(path: &str) -> String {
    std::path::absolute(path).map_or_else(|_| path.to_owned(), |path| path.display().to_string())
}
