//! Several plants in the lanes of the vector unit: plants and commands in; the same plants later, each with the bits that it has
//! alone, out.

use nalgebra::Vector4;

use super::Plant;
use super::in_flight::Way;
use super::kernel::{LANES, SideBySide};

/// Up to four plants that fly side by side.
pub struct PlantGroup {
    plants: Vec<Plant>,
    lanes: SideBySide,
    /// Whether nothing but the commands is new in the steps of any.
    steady: bool,
    flying: [bool; LANES],
    /// Plants that are elsewhere than their lanes.
    apart: [bool; LANES],
}

impl PlantGroup {
    /// Most of them.
    pub const MOST: usize = LANES;

    /// Of plants; those beyond [`Self::MOST`] are left out.
    pub fn new(mut plants: Vec<Plant>) -> Self {
        plants.truncate(LANES);
        let plain = std::array::from_fn(|lane| plants.get(lane).and_then(Plant::plain));
        let flying = std::array::from_fn(|lane| lane < plants.len());
        let steady = plants.iter().all(Plant::is_steady);
        Self { lanes: SideBySide::new(&plain), steady, flying, apart: [true; LANES], plants }
    }

    /// One of them.
    pub fn plant(&self, lane: usize) -> Option<&Plant> {
        self.plants.get(lane)
    }

    /// One of them, to be asked for its specific force, and not to be moved.
    pub(crate) fn plant_mut(&mut self, lane: usize) -> Option<&mut Plant> {
        self.plants.get_mut(lane)
    }

    /// Leaves one where it is from now on.
    pub fn stop(&mut self, lane: usize) {
        if let Some(flying) = self.flying.get_mut(lane) {
            *flying = false;
        }
    }

    /// Gives each its commands, N, and flies on for a time, s, as [`Plant::advance`] does.
    #[inline(always)]
    pub fn advance(&mut self, commands_n: &[Vector4<f64>; LANES], duration_s: f64) {
        if self.steady && Plant::is_one_step(duration_s) {
            self.advance_steadily(commands_n, duration_s);
        } else {
            self.advance_step_by_step(commands_n, duration_s);
        }
    }

    fn advance_step_by_step(&mut self, commands_n: &[Vector4<f64>; LANES], duration_s: f64) {
        let mut ways = [Way::default(); LANES];
        let mut under_way = [false; LANES];
        for (lane, plant) in self.plants.iter_mut().enumerate().filter(|(lane, _)| self.flying[*lane]) {
            under_way[lane] = plant.is_plain();
            if under_way[lane] {
                ways[lane] = plant.begin(&commands_n[lane], duration_s);
            } else {
                plant.advance(&commands_n[lane], duration_s);
            }
        }
        while under_way != [false; LANES] {
            let mut ends_s = [0.0; LANES];
            for (lane, plant) in self.plants.iter_mut().enumerate().filter(|(lane, _)| under_way[*lane]) {
                // There is a step until it is at its end.
                let Some((to_s, step)) = plant.next_step(&mut ways[lane]) else { continue };
                if self.apart[lane] {
                    self.lanes.put_state(lane, plant.state());
                }
                self.lanes.put_step(lane, &step);
                ends_s[lane] = to_s;
            }
            self.lanes.advance();
            for (lane, plant) in self.plants.iter_mut().enumerate() {
                self.apart[lane] = !under_way[lane];
                if under_way[lane] {
                    let mut state = *plant.state();
                    self.lanes.take(lane, &mut state);
                    plant.arrive(ends_s[lane], state, self.lanes.is_finite(lane));
                    if plant.is_at_end(&ways[lane]) {
                        plant.end(&ways[lane]);
                        under_way[lane] = false;
                    }
                }
            }
        }
    }

    /// The same where nothing but commands changes and one step takes all of it.
    #[inline(always)]
    fn advance_steadily(&mut self, commands_n: &[Vector4<f64>; LANES], duration_s: f64) {
        // Over the lanes, so that no index is looked at twice.
        for (lane, plant) in (0..LANES).zip(&mut self.plants) {
            if !self.flying[lane] {
                continue;
            }
            if self.apart[lane] {
                self.lanes.put_state(lane, plant.state());
                self.lanes.put_wind(lane, plant.wind_m_s());
            }
            let step = plant.steady_step(&commands_n[lane], duration_s);
            self.lanes.put_goals(lane, &step.goals_n, step.from_s, step.step_s);
        }
        self.lanes.advance();
        for (lane, plant) in (0..LANES).zip(&mut self.plants) {
            if self.flying[lane] {
                self.apart[lane] = false;
                let (state, finite) = plant.arrive_steadily(duration_s);
                self.lanes.take(lane, state);
                *finite = self.lanes.is_finite(lane);
            }
        }
    }
}
