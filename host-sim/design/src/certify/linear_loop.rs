//! A plant with its controller, taken apart into loops that know nothing of each other, or behind lagging actuators.

use nalgebra::DMatrix;

use super::plant::{Controller, LagModel, Plant, Predictor};

/// A plant and the feedback around it.
#[derive(Debug, Clone)]
pub(super) struct LinearLoop {
    /// n x n.
    pub(super) a: DMatrix<f64>,
    /// n x m.
    pub(super) b: DMatrix<f64>,
    /// States whose sums the controller keeps.
    pub(super) integrated: Vec<usize>,
    /// m x n.
    pub(super) state_gain: DMatrix<f64>,
    /// m x integrated states.
    pub(super) integral_gain: DMatrix<f64>,
    /// m x m each.
    pub(super) past_command_gains: Vec<DMatrix<f64>>,
    /// m x m.
    pub(super) predictor: Option<Predictor>,
    pub(super) body_rates: Vec<bool>,
    /// Which channels of the whole plant these are.
    pub(super) channels: Vec<usize>,
}

impl LinearLoop {
    pub(super) fn new(plant: &Plant, controller: &Controller) -> Self {
        let n = plant.a.nrows();
        Self {
            a: plant.a.clone(),
            b: plant.b.clone(),
            integrated: plant.integrated.clone(),
            state_gain: controller.gain.columns(0, n).into_owned(),
            integral_gain: controller.gain.columns(n, plant.integrated.len()).into_owned(),
            past_command_gains: controller.past_command_gains.clone(),
            predictor: controller.predictor.clone(),
            body_rates: plant.body_rates.clone(),
            channels: (0..plant.b.ncols()).collect(),
        }
    }

    /// Continuous time, the sums as integrals: A and B with them as further states, and K.
    pub(super) fn continuous(&self) -> (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>) {
        let (n, m, p) = (self.a.nrows(), self.b.ncols(), self.integrated.len());
        let mut a = self.a.clone().resize(n + p, n + p, 0.0);
        for (i, state) in self.integrated.iter().enumerate() {
            a[(n + i, *state)] = 1.0;
        }
        let mut gain = self.state_gain.clone().resize_horizontally(n + p, 0.0);
        gain.view_mut((0, n), (m, p)).copy_from(&self.integral_gain);
        (a, self.b.clone().resize_vertically(n + p, 0.0), gain)
    }

    /// The independent loops this one consists of: states and channels that share no entry of A, B or K.
    pub(super) fn independent(&self) -> Vec<Self> {
        let (n, m) = (self.a.nrows(), self.b.ncols());
        // States come first, then channels; every node ends up with the smallest node of its part.
        let mut part: Vec<usize> = (0..n + m).collect();
        let mut join = |i: usize, j: usize| {
            let (kept, gone) = (part[i].min(part[j]), part[i].max(part[j]));
            part.iter_mut().filter(|value| **value == gone).for_each(|value| *value = kept);
        };
        for i in 0..n {
            (0..n).filter(|j| self.a[(i, *j)] != 0.0).for_each(|j| join(i, j));
            (0..m).filter(|j| self.b[(i, *j)] != 0.0 || self.state_gain[(*j, i)] != 0.0).for_each(|j| join(i, n + j));
        }
        for channel in 0..m {
            for (sum, state) in self.integrated.iter().enumerate() {
                if self.integral_gain[(channel, sum)] != 0.0 {
                    join(n + channel, *state);
                }
            }
            for past in self.past_command_gains.iter().chain(self.predictor.iter().map(|held| &held.gain)) {
                (0..m).filter(|j| past[(channel, *j)] != 0.0).for_each(|j| join(n + channel, n + j));
            }
        }
        let mut names = part.clone();
        names.sort_unstable();
        names.dedup();
        names
            .into_iter()
            .map(|name| {
                let states: Vec<usize> = (0..n).filter(|i| part[*i] == name).collect();
                let channels: Vec<usize> = (0..m).filter(|j| part[n + j] == name).collect();
                self.restricted(&states, &channels)
            })
            .collect()
    }

    fn restricted(&self, states: &[usize], channels: &[usize]) -> Self {
        let sums: Vec<usize> = (0..self.integrated.len()).filter(|i| states.contains(&self.integrated[*i])).collect();
        let place = |state: usize| states.iter().position(|held| *held == state);
        let pick = |m: &DMatrix<f64>, rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| m[(rows[i], columns[j])])
        };
        Self {
            a: pick(&self.a, states, states),
            b: pick(&self.b, states, channels),
            integrated: sums.iter().filter_map(|sum| place(self.integrated[*sum])).collect(),
            state_gain: pick(&self.state_gain, channels, states),
            integral_gain: pick(&self.integral_gain, channels, &sums),
            past_command_gains: self.past_command_gains.iter().map(|past| pick(past, channels, channels)).collect(),
            predictor: self
                .predictor
                .as_ref()
                .map(|held| Predictor { gain: pick(&held.gain, channels, channels), ..*held }),
            body_rates: channels.iter().map(|j| self.body_rates[*j]).collect(),
            channels: channels.iter().map(|j| self.channels[*j]).collect(),
        }
    }

    /// The loop with actuators of time constant `lag_s` in the channels for which `lagging` holds.
    pub(super) fn behind_actuators(&self, lag_s: f64, model: LagModel, lagging: impl Fn(usize) -> bool) -> Self {
        let mut whole = self.clone();
        for channel in (0..self.b.ncols()).filter(|channel| lagging(*channel)) {
            let n = whole.a.nrows();
            let input = whole.b.column(channel).into_owned();
            let states = match model {
                LagModel::MotorsInRateLoop { .. } if self.body_rates[channel] => 2,
                _ => 1,
            };
            whole.a = whole.a.resize(n + states, n + states, 0.0);
            whole.b = whole.b.resize_vertically(n + states, 0.0);
            whole.state_gain = whole.state_gain.resize_horizontally(n + states, 0.0);
            // The plant is driven by the actuator's output, the actuator by the command.
            whole.a.view_mut((0, n), (n, 1)).copy_from(&input);
            whole.b.column_mut(channel).fill(0.0);
            match model {
                LagModel::MotorsInRateLoop { rate_gain_1_s } if states == 2 => {
                    whole.a[(n, n + 1)] = 1.0;
                    whole.a[(n + 1, n)] = -rate_gain_1_s / lag_s;
                    whole.a[(n + 1, n + 1)] = -1.0 / lag_s;
                    whole.b[(n + 1, channel)] = rate_gain_1_s / lag_s;
                }
                _ => {
                    whole.a[(n, n)] = -1.0 / lag_s;
                    whole.b[(n, channel)] = 1.0 / lag_s;
                }
            }
        }
        whole
    }
}
