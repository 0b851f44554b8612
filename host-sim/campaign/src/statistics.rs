//! Intervals, quantiles and ranks: numbers in, numbers out.

/// Two-sided 95 % of a normal distribution, in deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Wilson's score interval of 95 % for a share (Wilson 1927): `successes` of `trials`, which are at least one.
///
/// ```
/// use quatrack_campaign::statistics::wilson;
///
/// // Of ten flights without a loss one knows little: at least 72 % succeed.
/// let [least, most] = wilson(10, 10);
/// assert!((least - 0.7225).abs() < 1e-4 && (most - 1.0).abs() < 1e-12);
/// ```
pub fn wilson(successes: u64, trials: u64) -> [f64; 2] {
    let (n, share, z2) = (trials as f64, successes as f64 / trials as f64, NORMAL_95 * NORMAL_95);
    let middle = (share + 0.5 * z2 / n) / (1.0 + z2 / n);
    let half = NORMAL_95 / (1.0 + z2 / n) * (share * (1.0 - share) / n + 0.25 * z2 / (n * n)).sqrt();
    [(middle - half).max(0.0), (middle + half).min(1.0)]
}

/// Quantile of values in ascending order, linear between them (Hyndman and Fan 1996, definition 7, NumPy's and R's own);
/// infinite where one of the two is; nothing of none.
pub fn quantile(ascending: &[f64], share: f64) -> Option<f64> {
    let last = ascending.len().checked_sub(1)?;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = (place as usize).min(last);
    let (low, high) = (ascending[below], ascending[(below + 1).min(last)]);
    let part = place - below as f64;
    Some(if part == 0.0 { low } else { low + (high - low) * part })
}

/// Ranks from 1; equal values share the mean of theirs.
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    while from < order.len() {
        let alike = order[from..].iter().take_while(|i| values[**i] == values[order[from]]).count();
        let mean = from as f64 + 0.5 * (alike as f64 + 1.0);
        order[from..from + alike].iter().for_each(|i| ranks[*i] = mean);
        from += alike;
    }
    ranks
}

/// Spearman's rank correlation: Pearson's of the ranks; nothing where one of the two does not vary.
pub fn spearman(ranks_x: &[f64], ranks_y: &[f64]) -> Option<f64> {
    let n = ranks_x.len() as f64;
    let mean = 0.5 * (n + 1.0);
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in ranks_x.iter().zip(ranks_y) {
        let (x, y) = (x - mean, y - mean);
        xy += x * y;
        xx += x * x;
        yy += y * y;
    }
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}

/// Two-sided 97.5 % of a normal distribution, in deviations.
const NORMAL_97: f64 = 2.241_402_727_604_947;

/// Whether chance alone gives as large a rank correlation of so many flights in less than one of forty campaigns.
pub fn is_correlated(rank_correlation: f64, flights: u64) -> bool {
    rank_correlation.abs() > NORMAL_97 / ((flights.max(2) - 1) as f64).sqrt()
}

/// Most parts of a figure's flights in [`explained`], and the flights of each at least.
const PARTS_MOST: usize = 8;
const FLIGHTS_OF_PART: usize = 10;

/// 97.5 % of chi-squared distributions of one to seven degrees of freedom.
const CHI_SQUARED_97: [f64; PARTS_MOST - 1] = [5.0239, 7.3778, 9.3484, 11.1433, 12.8325, 14.4494, 16.0128];

/// What parts of a figure tell of another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explained {
    /// The share of the variance, from 0 to 1, of which chance expects none.
    pub share: f64,
    /// Whether chance alone would give as much in less than one of forty campaigns.
    pub beyond_chance: bool,
}

/// How much of the variance of y lies between the means of eight equal parts by x, or fewer where there are fewer than 80, both as
/// ranks: Kelley's epsilon squared (1935), the correlation ratio without its bias. Unlike [`spearman`] it sees an effect with a
/// minimum in the middle. Equal x are of one part; nothing where one of the two does not vary.
pub fn explained(ranks_x: &[f64], ranks_y: &[f64]) -> Option<Explained> {
    let (count, n) = (ranks_x.len(), ranks_x.len() as f64);
    let parts = (count / FLIGHTS_OF_PART).clamp(2, PARTS_MOST);
    let mean = 0.5 * (n + 1.0);
    let (mut sums, mut counts, mut all) = ([0.0; PARTS_MOST], [0.0; PARTS_MOST], 0.0);
    for (x, y) in ranks_x.iter().zip(ranks_y) {
        let part = (((x - 0.5) / n * parts as f64) as usize).min(parts - 1);
        sums[part] += y - mean;
        counts[part] += 1.0;
        all += (y - mean).powi(2);
    }
    let filled = counts.iter().filter(|count| **count > 0.0).count();
    if filled < 2 || all <= 0.0 {
        return None;
    }
    if count <= filled {
        // One flight a part says nothing.
        return Some(Explained { share: 0.0, beyond_chance: false });
    }
    let between: f64 = sums.iter().zip(counts).map(|(sum, count)| sum * sum / f64::max(count, 1.0)).sum();
    let ratio = between / all;
    Some(Explained {
        share: (1.0 - (1.0 - ratio) * (n - 1.0) / (n - filled as f64)).max(0.0),
        beyond_chance: ratio * (n - 1.0) > CHI_SQUARED_97[filled - 2],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_s_interval_is_the_published_one() {
        // Newcombe, "Two-sided confidence intervals for the single proportion", Statistics in Medicine 17 (1998), table I,
        // method 3.
        for (successes, trials, least, most) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let [found_least, found_most] = wilson(successes, trials);
            let close = |a: f64, b: f64| (a - b).abs() < 5.1e-5;
            assert!(close(found_least, least) && close(found_most, most), "{found_least} {found_most}");
        }
    }

    #[test]
    fn quantiles_lie_between_values() {
        let values = [1.0, 2.0, 4.0, 8.0];
        // numpy.quantile([1, 2, 4, 8], [0, 0.5, 0.95, 1]).
        for (share, expected) in [(0.0, 1.0), (0.5, 3.0), (0.95, 7.4), (1.0, 8.0)] {
            assert!((quantile(&values, share).unwrap() - expected).abs() < 1e-12);
        }
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[1.0, f64::INFINITY], 0.0), Some(1.0));
        assert_eq!(quantile(&[1.0, f64::INFINITY], 0.5), Some(f64::INFINITY));
        assert_eq!(quantile(&[f64::INFINITY; 3], 0.5), Some(f64::INFINITY));
    }

    #[test]
    fn a_valley_is_seen_by_its_parts() {
        let x: Vec<f64> = (0..800).map(|k| f64::from(k) - 399.5).collect();
        let of = |y: &dyn Fn(f64) -> f64| {
            let ranks = [ranks(&x), ranks(&x.iter().map(|x| y(*x)).collect::<Vec<_>>())];
            (spearman(&ranks[0], &ranks[1]).unwrap(), explained(&ranks[0], &ranks[1]).unwrap())
        };
        // Of eight steps in a line their own variance, 1/64 of all, is missing; of a valley four steps are seen, 1/16. Freedom makes
        // that 799/792 as much.
        let (monotone, line) = of(&|x| x.powi(3));
        assert!((monotone - 1.0).abs() < 1e-12 && (line.share - (1.0 - 799.0 / 792.0 / 64.0)).abs() < 1e-4, "{line:?}");
        let (none, valley) = of(&|x| x * x);
        assert!(none.abs() < 1e-12 && (valley.share - (1.0 - 799.0 / 792.0 / 16.0)).abs() < 1e-4, "{valley:?}");
        assert!(line.beyond_chance && valley.beyond_chance);
        // scipy.stats.chi2.ppf(0.975, [1, 7]).
        assert!((CHI_SQUARED_97[0] - 5.023_886).abs() < 1e-4 && (CHI_SQUARED_97[6] - 16.012_764).abs() < 1e-4);
        // An order without sense explains next to nothing.
        let (_, chance) = of(&|x| (x * 12.9898).sin() * 43758.5453 % 1.0);
        assert!(chance.share < 0.02 && !chance.beyond_chance, "{chance:?}");
        assert_eq!(explained(&ranks(&[1.0, 1.0]), &ranks(&[1.0, 2.0])), None);
    }

    #[test]
    fn rank_correlation_is_scipy_s() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, f64::INFINITY]), [2.5, 1.0, 2.5, 4.0]);
        // scipy.stats.spearmanr([1, 2, 3, 4, 5], [5, 6, 7, 8, 7]).statistic.
        let rho = spearman(&ranks(&[1.0, 2.0, 3.0, 4.0, 5.0]), &ranks(&[5.0, 6.0, 7.0, 8.0, 7.0])).unwrap();
        assert!((rho - 0.820_782_681_668_123_4).abs() < 1e-12, "{rho}");
        assert_eq!(spearman(&ranks(&[1.0, 1.0]), &ranks(&[1.0, 2.0])), None);
    }
}
