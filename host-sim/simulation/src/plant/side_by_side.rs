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
    flying: [bool; LANES],
}

impl PlantGroup {
    /// Most of them.
    pub const MOST: usize = LANES;

    /// Of plants; those beyond [`Self::MOST`] are left out.
    pub fn new(mut plants: Vec<Plant>) -> Self {
        plants.truncate(LANES);
        let plain = std::array::from_fn(|lane| plants.get(lane).and_then(Plant::plain));
        let flying = std::array::from_fn(|lane| lane < plants.len());
        Self { lanes: SideBySide::new(&plain), flying, plants }
    }

    /// One of them.
    pub fn plant(&self, lane: usize) -> Option<&Plant> {
        self.plants.get(lane)
    }

    /// One of them, to be asked what it feels.
    pub fn plant_mut(&mut self, lane: usize) -> Option<&mut Plant> {
        self.plants.get_mut(lane)
    }

    /// Leaves one where it is from now on.
    pub fn stop(&mut self, lane: usize) {
        if let Some(flying) = self.flying.get_mut(lane) {
            *flying = false;
        }
    }

    /// Gives each its commands, N, and flies on for a time, s, as [`Plant::advance`] does.
    pub fn advance(&mut self, commands_n: &[Vector4<f64>; LANES], duration_s: f64) {
        let mut ways: [Option<Way>; LANES] = [None; LANES];
        for (lane, plant) in self.plants.iter_mut().enumerate().filter(|(lane, _)| self.flying[*lane]) {
            if plant.plain().is_some() {
                ways[lane] = Some(plant.begin(&commands_n[lane], duration_s));
            } else {
                plant.advance(&commands_n[lane], duration_s);
            }
        }
        loop {
            let mut ends_s = [None; LANES];
            for (lane, plant) in self.plants.iter_mut().enumerate() {
                let Some(way) = &mut ways[lane] else { continue };
                if let Some((to_s, step)) = plant.next_step(way) {
                    self.lanes.put(lane, plant.state(), &step);
                    ends_s[lane] = Some(to_s);
                } else {
                    plant.end(way);
                    ways[lane] = None;
                }
            }
            if ends_s.iter().all(Option::is_none) {
                return;
            }
            self.lanes.advance();
            for (lane, plant) in self.plants.iter_mut().enumerate() {
                if let Some(to_s) = ends_s[lane] {
                    plant.arrive(to_s, self.lanes.state(lane));
                }
            }
        }
    }
}
