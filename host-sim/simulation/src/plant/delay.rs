//! A transport delay: commands (N) with their times in; the command that acts at a time out.

use std::collections::VecDeque;

use nalgebra::Vector4;

/// Longest run of commands that it is made for; more of them grow it.
const ROOM: usize = 64;

/// A line in which commands spend a time.
#[derive(Clone, Debug)]
pub(super) struct DelayLine {
    delay_s: f64,
    /// None before the first has arrived.
    acting: Option<Vector4<f64>>,
    /// The time at which each begins to act, s, and its forces; the oldest first.
    on_the_way: VecDeque<(f64, Vector4<f64>)>,
}

impl DelayLine {
    pub(super) fn new(delay_s: f64) -> Self {
        Self { delay_s, acting: None, on_the_way: VecDeque::with_capacity(ROOM) }
    }

    /// A command is given in a line without a delay.
    #[inline]
    pub(super) fn give_at_once(&mut self, command: &Vector4<f64>) {
        self.acting = Some(*command);
    }

    /// A command is given at a time, s.
    #[inline]
    pub(super) fn give(&mut self, time_s: f64, command: &Vector4<f64>) {
        if self.delay_s > 0.0 {
            self.on_the_way.push_back((time_s + self.delay_s, *command));
        } else {
            self.acting = Some(*command);
        }
    }

    /// The commands that act from a time, s, and the time of their next change. Times less than a nanosecond apart are
    /// the same, so that sums of steps and delays meet.
    #[inline]
    pub(super) fn at(&mut self, time_s: f64) -> (Option<Vector4<f64>>, f64) {
        while let Some((from_s, command)) = self.on_the_way.front() {
            if *from_s > time_s + 1e-9 {
                return (self.acting, *from_s);
            }
            self.acting = Some(*command);
            self.on_the_way.pop_front();
        }
        (self.acting, f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_acts_after_the_delay_and_until_the_next() {
        let command = |k: f64| Vector4::repeat(k);
        let mut line = DelayLine::new(0.003);
        line.give(0.0, &command(1.0));
        assert_eq!(line.at(0.0), (None, 0.003));
        line.give(0.002, &command(2.0));
        assert_eq!(line.at(0.002), (None, 0.003));
        assert_eq!(line.at(0.003), (Some(command(1.0)), 0.005));
        assert_eq!(line.at(0.1), (Some(command(2.0)), f64::INFINITY));
        let mut none = DelayLine::new(0.0);
        none.give(0.0, &command(1.0));
        assert_eq!(none.at(0.0), (Some(command(1.0)), f64::INFINITY));
    }
}
