//! Flights side by side in the lanes of the processor's vector unit: up to four laws on their way in; all of them at
//! their ends, each with the bits that it has alone, out.

use nalgebra::Vector4;
use pulp::{Arch, Simd, WithSimd};

use super::Flying;
use crate::plant::{Plant, PlantGroup};
use crate::scenario::kept::Keep;

/// Flies up to four that go on by as many steps at once, each with the bits that it has alone.
pub(in crate::scenario) fn together(plants: Vec<Plant>, flights: &mut [Flying<'_>], keep: &mut [impl Keep]) {
    Arch::new().dispatch(Together { group: PlantGroup::new(plants), flights, keep });
}

/// Flights side by side, compiled for the vector instructions of the processor. No multiply-add is fused.
struct Together<'a, 'b, K> {
    group: PlantGroup,
    flights: &'a mut [Flying<'b>],
    keep: &'a mut [K],
}

impl<K: Keep> WithSimd for Together<'_, '_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { mut group, flights, keep } = self;
        let mut goes_on = [false; PlantGroup::MOST];
        goes_on.iter_mut().take(flights.len()).for_each(|goes| *goes = true);
        let steps = flights.iter().map(|flying| flying.track.steps()).max().unwrap_or(0);
        let Some((stride, stride_s)) = flights.first().map(|flying| (flying.stride, flying.stride_s())) else {
            return;
        };
        let mut commands_n = [Vector4::zeros(); PlantGroup::MOST];
        let mut step = 0;
        while step <= steps {
            for (lane, (flying, keep)) in (0..PlantGroup::MOST).zip(flights.iter_mut().zip(keep.iter_mut())) {
                let Some(plant) = group.plant_mut(lane).filter(|_| goes_on[lane]) else { continue };
                goes_on[lane] = step <= flying.track.steps() && flying.decide(step, plant, keep);
                commands_n[lane] = flying.commands_n;
                if !goes_on[lane] {
                    group.stop(lane);
                }
            }
            if goes_on.iter().all(|goes| !goes) {
                return;
            }
            group.advance(&commands_n, stride_s);
            step += stride;
        }
    }
}
