//! A flight of the cascade on a plant: setpoints at 100 Hz to the jerk, estimates with noise, figures.

use nalgebra::Vector3;
use quatrack::cascade::{Cascade, CascadeMemory, JerkFit};
use quatrack::{
    Controller, FifthOrderSample, FlatSample, Heading, Limits, Measured, Memory, MotorStep, Quaternion, RigidState,
    State, Target,
};

use crate::cascade::course::Course;
use crate::cascade::filter::Filter;
use crate::cascade::noise::Random;
use crate::cascade::plant::{Craft, GRAVITY, Plant, STEP_S};

/// Where estimates come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Estimates {
    /// Of each step: the truth with noise of position, velocity, body rates and specific force.
    Noisy([f64; 4]),
    /// Of the firmware's filter, with its drag over mass (1/s): positions of 1 mm at 100 Hz.
    Filtered(f64),
}

pub(crate) const NOISE: Estimates = Estimates::Noisy([1e-3, 1e-2, 0.02, 0.0]);
pub(crate) const EXACT: Estimates = Estimates::Noisy([0.0; 4]);

/// The surroundings and faults of a flight.
#[derive(Clone)]
pub(crate) struct Flight<'a> {
    pub(crate) cascade: Cascade,
    pub(crate) craft: Craft,
    pub(crate) course: Course,
    pub(crate) estimates: Estimates,
    pub(crate) seed: u64,
    /// From when on and how long errors are summed, s.
    pub(crate) from_s: f64,
    pub(crate) for_s: f64,
    pub(crate) wind: &'a dyn Fn(f64) -> Vector3<f64>,
    /// Force from outside over mass, m/s^2.
    pub(crate) push: &'a dyn Fn(f64, &Plant) -> Vector3<f64>,
    pub(crate) setpoint_s: &'a dyn Fn(u32) -> f64,
    pub(crate) start: Start,
    /// Setpoints of each step with the course's own snap and crackle.
    pub(crate) to_fifth: bool,
    pub(crate) accelerometer: bool,
    pub(crate) accelerometer_bias: Vector3<f64>,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Start {
    Hovering,
    /// At some rotation (axis times angle), in hover's place.
    Tilted(Vector3<f64>),
    Ground,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Figures {
    pub(crate) iae: f64,
    pub(crate) largest: f64,
    pub(crate) tilt_deg: f64,
    pub(crate) speed: f64,
    pub(crate) lowest: f64,
    /// Farthest along +x relative to the goal at the end.
    pub(crate) beyond: f64,
    pub(crate) activity: f64,
    pub(crate) lost: bool,
    pub(crate) final_error: f64,
    pub(crate) drag: f64,
    pub(crate) moment: [f64; 2],
    pub(crate) limited: u32,
    pub(crate) across: f64,
}

pub(crate) fn still(_: f64) -> Vector3<f64> {
    Vector3::zeros()
}

impl<'a> Flight<'a> {
    pub(crate) fn of(cascade: Cascade, craft: Craft, course: Course) -> Self {
        let (from_s, for_s) = match course {
            Course::Hover => (2.0, 10.0),
            Course::Step { at_s, .. } => (at_s, 5.0),
            Course::Eight { .. } => (5.0, 12.0),
            Course::W => (2.0, 12.0),
            Course::TakeOff { at_s, .. } => (at_s, 6.0),
        };
        Self {
            cascade,
            craft,
            course,
            estimates: NOISE,
            seed: 1,
            from_s,
            for_s,
            wind: &still,
            push: &|_, _| Vector3::zeros(),
            setpoint_s: &|_| 0.01,
            start: Start::Hovering,
            to_fifth: false,
            accelerometer: true,
            accelerometer_bias: Vector3::zeros(),
        }
    }

    pub(crate) fn fly(&self) -> Figures {
        self.fly_with(&mut |_, _, _| {})
    }

    pub(crate) fn fly_with(&self, look: &mut dyn FnMut(f64, &Plant, &CascadeMemory)) -> Figures {
        let mut random = Random::new(self.seed);
        let home = if self.start == Start::Ground { Vector3::zeros() } else { self.course.at(0.0).0[0] };
        let mut plant = Plant::at(self.craft, home, self.start != Start::Ground);
        if let Start::Tilted(rotation) = self.start {
            plant.q = nalgebra::UnitQuaternion::from_scaled_axis(rotation);
        }
        let grounded = self.start == Start::Ground;
        let mut memory = if grounded { Memory::at_rest() } else { Memory::hovering(self.cascade.airframe()) };
        let controller = Controller::new(&self.cascade, Limits::NONE);
        let drag = if let Estimates::Filtered(drag) = self.estimates { drag } else { 0.0 };
        let mut filter = Filter::at(home, drag);
        let mut stream = Stream::new();
        let (mut next_setpoint, mut setpoints, mut commands) = (0.0, 0, plant.forces.map(|f| f / self.craft.motors[0]));
        let mut figures = Figures { lowest: f64::INFINITY, ..Figures::default() };
        let (mut squares, mut samples) = (0.0, 0.0);
        let goal = self.course.at(1e3).0[0];
        let steps = ((self.from_s + self.for_s) / 0.002).round() as u32;
        let most = f64::from(self.cascade.airframe().figures().force_max_n);
        for step in 0..steps {
            let t = f64::from(step) * 0.002;
            if t >= next_setpoint - 1e-9 {
                stream.accept(&self.course.at(t), t);
                next_setpoint += (self.setpoint_s)(setpoints);
                setpoints += 1;
            }
            let (p, v, q, w, felt) = match self.estimates {
                Estimates::Noisy([np, nv, nw, na]) => (
                    plant.p + random.vector(np),
                    plant.v + random.vector(nv),
                    plant.q,
                    plant.w + random.vector(nw),
                    plant.felt + random.vector(na) + self.accelerometer_bias,
                ),
                Estimates::Filtered(_) => {
                    let w = plant.w + random.vector(0.02);
                    let felt = plant.felt + random.vector(0.05) + self.accelerometer_bias;
                    filter.sense(&w, &felt);
                    if step % 5 == 4 {
                        filter.update(&(plant.p + random.vector(1e-3)));
                    }
                    (filter.p, filter.velocity(), filter.q, w, felt)
                }
            };
            let state = RigidState {
                state: State {
                    position_m: p.cast(),
                    attitude: Quaternion::new(q.w as f32, q.i as f32, q.j as f32, q.k as f32),
                    velocity_m_s: v.cast(),
                },
                body_rates_rad_s: w.cast(),
            };
            let sample = if self.to_fifth { exact(&self.course, t) } else { stream.at(t) };
            let heading = Heading::from_angle(sample.flat.heading_rad);
            let felt = felt.cast();
            let measured = Measured::from(&state);
            let measured = if self.accelerometer { measured.with_specific_force(&felt) } else { measured };
            let target = Target::with_sample(&sample, heading);
            let Ok(MotorStep { forces_n: forces, limited }) = controller.step_to_motors(&mut memory, measured, target)
            else {
                figures.lost = true;
                break;
            };
            commands_of(&mut commands, &forces);
            figures.limited += u32::from(limited.any());
            let wind = (self.wind)(t);
            for _ in 0..(0.002 / STEP_S).round() as u32 {
                let push = (self.push)(t, &plant);
                plant.step(&commands, &wind, &push);
            }
            let after = t + 0.002;
            look(after, &plant, memory.cascade());
            let error = (plant.p - self.course.at(after).0[0]).norm();
            let tilt = (plant.q * Vector3::z()).z.clamp(-1.0, 1.0).acos().to_degrees();
            if after > self.from_s {
                figures.iae += 0.002 * error;
                figures.largest = figures.largest.max(error);
                figures.tilt_deg = figures.tilt_deg.max(tilt);
                figures.speed = figures.speed.max(plant.v.norm());
                figures.lowest = figures.lowest.min(plant.p.z);
                let way = goal - home;
                if way.norm() > 1e-9 {
                    figures.beyond = figures.beyond.max((plant.p - goal).dot(&way.normalize()));
                }
                figures.across = figures.across.max(plant.p.x.hypot(plant.p.y));
                let hover = self.craft.mass_kg * GRAVITY / 4.0;
                squares += commands.iter().map(|u| ((u - hover) / most).powi(2)).sum::<f64>() / 4.0;
                samples += 1.0;
            }
            figures.final_error = error;
            let away = plant.p.norm();
            if away.is_nan() || away > 200.0 || plant.p.z < -5.0 {
                figures.lost = true;
                break;
            }
        }
        figures.activity = (squares / f64::max(samples, 1.0)).sqrt();
        let (drag, moment) = self.cascade.air(memory.cascade());
        figures.drag = f64::from(drag);
        figures.moment = moment.map(f64::from);
        figures
    }
}

fn commands_of(commands: &mut [f64; 4], forces: &[f32; 4]) {
    *commands = forces.map(f64::from);
}

/// The course to its fifth derivative, by differences of its jerk.
fn exact(course: &Course, t: f64) -> FifthOrderSample {
    let h = 1e-3;
    let [before, (now, turn), after] = [t - h, t, t + h].map(|t| course.at(t));
    let jerk = |motion: &crate::cascade::course::Motion| motion.0[3];
    let (a, b) = (jerk(&before), jerk(&after));
    let flat = FlatSample {
        position_m: now[0].cast(),
        velocity_m_s: now[1].cast(),
        acceleration_m_s2: now[2].cast(),
        jerk_m_s3: now[3].cast(),
        heading_rad: turn[0] as f32,
        heading_rate_rad_s: turn[1] as f32,
    };
    FifthOrderSample {
        snap_m_s4: ((b - a) / (2.0 * h)).cast(),
        crackle_m_s5: ((b + a - 2.0 * now[3]) / (h * h)).cast(),
        heading_acceleration_rad_s2: turn[2] as f32,
        heading_jerk_rad_s3: ((after.1[2] - before.1[2]) / (2.0 * h)) as f32,
        flat,
    }
}

/// Setpoints as an object on board takes them: extrapolated by their own derivatives, with snap and crackle of the fit.
struct Stream {
    newest: FifthOrderSample,
    at_s: f64,
    fit: JerkFit,
    begun: bool,
}

impl Stream {
    fn new() -> Self {
        let newest = FifthOrderSample::at_rest(Vector3::new(0.0_f32, 0.0, 0.0), 0.0);
        Self { newest, at_s: 0.0, fit: JerkFit::NONE, begun: false }
    }

    fn accept(&mut self, motion: &crate::cascade::course::Motion, t: f64) {
        let ([p, v, a, j], [heading, rate, acceleration]) = *motion;
        let flat = FlatSample {
            position_m: p.cast(),
            velocity_m_s: v.cast(),
            acceleration_m_s2: a.cast(),
            jerk_m_s3: j.cast(),
            heading_rad: heading as f32,
            heading_rate_rad_s: rate as f32,
        };
        let jumps = (flat.position_m - self.newest.flat.position_m).norm() > 0.05;
        if jumps || !self.begun {
            self.fit.forget();
        }
        let gap = (t - self.at_s) as f32;
        self.fit.accept(&flat.jerk_m_s3, gap);
        let [snap, crackle] = self.fit.snap_and_crackle();
        self.newest = FifthOrderSample {
            snap_m_s4: snap,
            crackle_m_s5: crackle,
            heading_acceleration_rad_s2: acceleration as f32,
            ..FifthOrderSample::of_jerk(flat)
        };
        (self.at_s, self.begun) = (t, true);
    }

    fn at(&self, t: f64) -> FifthOrderSample {
        let t = (t - self.at_s) as f32;
        let FifthOrderSample { flat, snap_m_s4: s, crackle_m_s5: c, .. } = self.newest;
        let FlatSample { position_m: p, velocity_m_s: v, acceleration_m_s2: a, jerk_m_s3: j, .. } = flat;
        let second = self.newest.heading_acceleration_rad_s2;
        FifthOrderSample {
            flat: FlatSample {
                position_m: p + (v + (a + (j + (s + c * (t / 5.0)) * (t / 4.0)) * (t / 3.0)) * (t / 2.0)) * t,
                velocity_m_s: v + (a + (j + (s + c * (t / 4.0)) * (t / 3.0)) * (t / 2.0)) * t,
                acceleration_m_s2: a + (j + (s + c * (t / 3.0)) * (t / 2.0)) * t,
                jerk_m_s3: j + (s + c * (t / 2.0)) * t,
                heading_rad: flat.heading_rad + t * (flat.heading_rate_rad_s + 0.5 * t * second),
                heading_rate_rad_s: flat.heading_rate_rad_s + t * second,
            },
            snap_m_s4: s + c * t,
            ..self.newest
        }
    }
}
