//! The supervisor over random flights: with any measurements and requests, motors are off where they have to be, and the
//! forces that reach them are finite and within bounds.

use proptest::prelude::*;
use quatrack::cascade::{Air, Cascade, CascadeLimits};
use quatrack::gains::cascade::BRUSHLESS_50_MS;
use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{
    Asked, Circumstances, Config, Fault, Guard, Mode, MonitorConfig, Order, Reason, ReferenceReport, Sample, Tumble,
};
use quatrack::{
    Airframe, Controller, FifthOrderSample, Heading, Limits, Measured, Memory, Quaternion, Rate, State, Target, Tick,
};

#[derive(Clone, Debug)]
enum Event {
    Arm,
    Disarm,
    /// So many steps like this one.
    Steps(Seen, u16),
}

#[derive(Clone, Debug)]
struct Seen {
    state: Option<State>,
    rates: Vector3<f32>,
    felt: Option<Vector3<f32>>,
    asked: Asked,
    reference: ReferenceReport,
    goal: Vector3<f32>,
    link: Option<Tick>,
    battery_v: f32,
    overrun: bool,
    fault: bool,
}

/// A number near a size, or anything at all.
fn number(size: f32) -> impl Strategy<Value = f32> {
    prop_oneof![60 => -size..size, 1 => any::<f32>(), 1 => Just(f32::NAN), 1 => Just(f32::INFINITY)]
}

fn vector(size: f32) -> impl Strategy<Value = Vector3<f32>> {
    [number(size), number(size), number(size)].prop_map(Vector3::from)
}

fn state() -> impl Strategy<Value = State> {
    (vector(2.0), vector(2.0), [number(0.1), number(0.6), number(0.6), number(1.0)]).prop_map(|(p, v, [w, x, y, z])| {
        State { position_m: p, attitude: Quaternion::new(1.0 + w, x, y, z), velocity_m_s: v }
    })
}

fn seen() -> impl Strategy<Value = Seen> {
    let asked = prop_oneof![5 => Just(Asked::Places), 1 => Just(Asked::Tilts), 1 => Just(Asked::Rates)];
    let reference = prop_oneof![
        10 => Just(ReferenceReport::Sound),
        1 => Just(ReferenceReport::Bad),
        1 => Just(ReferenceReport::Missing)
    ];
    let link = prop_oneof![20 => Just(Some(3)), 1 => Just(Some(700)), 1 => Just(None)];
    let chance = prop::bool::weighted;
    (
        prop::option::weighted(0.95, state()),
        vector(3.0),
        prop::option::of(vector(12.0)),
        (asked, reference, vector(5.0)),
        link,
        prop_oneof![20 => Just(3.8), 1 => number(5.0)],
        (chance(0.05), chance(0.004)),
    )
        .prop_map(|(state, rates, felt, (asked, reference, goal), link, battery_v, (overrun, fault))| Seen {
            state,
            rates,
            felt,
            asked,
            reference,
            goal,
            link,
            battery_v,
            overrun,
            fault,
        })
}

fn event() -> impl Strategy<Value = Event> {
    let steps = prop_oneof![10 => 1..20_u16, 1 => 1..1500_u16];
    prop_oneof![3 => Just(Event::Arm), 1 => Just(Event::Disarm), 20 => (seen(), steps).prop_map(|(s, n)| Event::Steps(s, n))]
}

/// A craft under its supervisor, without a plant: it is where it is said to be.
struct Craft {
    guard: Guard,
    cascade: Cascade,
    memory: Memory,
    limited: MotorLimited,
    now: Tick,
}

impl Craft {
    fn new() -> Self {
        let rate = Rate::from_hz(500).unwrap();
        let craft = Airframe::CRAZYFLIE_2_1_BRUSHLESS.with_motor_lag(0.05).unwrap();
        let gains = &BRUSHLESS_50_MS.table.gains;
        let cascade = Cascade::new(gains, &craft, rate, &CascadeLimits::STANDARD, &Air::BRUSHLESS).unwrap();
        Self { guard: Guard::new(), cascade, memory: Memory::at_rest(), limited: MotorLimited::NOTHING, now: 0 }
    }

    /// The motors' forces of a step; none where they are off.
    fn step(&mut self, seen: &Seen) -> Option<[f32; 4]> {
        self.now += 2;
        let sample = Sample {
            now: self.now,
            state: seen.state.as_ref(),
            body_rates_rad_s: Some(&seen.rates),
            specific_force_m_s2: seen.felt.as_ref(),
            thrust_m_s2: 9.81,
        };
        let around = Circumstances {
            link_silence_ticks: seen.link,
            asked: seen.asked,
            reference: seen.reference,
            limited: self.limited,
            levels: true,
            starts_near: true,
            battery_v: Some(seen.battery_v),
            overrun: seen.overrun,
            fault: seen.fault.then_some(Fault::StackExhausted),
        };
        let controller = Controller::new(&self.cascade, Limits::NONE);
        let configs = (&Config::STANDARD, &MonitorConfig::STANDARD);
        let (looked, target, heading) = match self.guard.order(configs, &sample, &around) {
            Order::Off => return None,
            Order::Fly(looked) => (looked, &FifthOrderSample::at_rest(seen.goal, 0.0), Heading::ZERO),
            Order::Brake(looked, target, heading) => (looked, target, heading),
            Order::Level(levelled) => {
                let (forces, limited) = self.memory.level(&self.cascade, &levelled)?;
                self.limited = limited;
                return Some(forces);
            }
        };
        let measured = Measured::new(looked.state).with_body_rates(looked.body_rates_rad_s);
        match controller.step_to_motors(&mut self.memory, measured, Target::with_sample(target, heading)) {
            Ok(step) => {
                self.limited = step.limited;
                Some(step.forces_n)
            }
            Err(_) => {
                let levelled = self.guard.step_failed(self.now, 1e-3, &around)?;
                self.memory.level(&self.cascade, &levelled).map(|(forces, _)| forces)
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn motors_stand_still_where_they_have_to_and_forces_are_within_bounds(
        events in prop::collection::vec(event(), 1..120)
    ) {
        let figures = *Airframe::CRAZYFLIE_2_1_BRUSHLESS.figures();
        let mut craft = Craft::new();
        // Facts known without looking into the supervisor.
        let mut asked = false;
        for event in events {
            match event {
                Event::Arm => {
                    craft.guard.arm(craft.now);
                    asked = true;
                }
                Event::Disarm => {
                    craft.guard.disarm(craft.now);
                    asked = false;
                }
                Event::Steps(seen, steps) => for _ in 0..steps {
                    let was_allowed = craft.guard.mode().motors_allowed();
                    let forces = craft.step(&seen);
                    let mode = craft.guard.mode();
                    prop_assert!(forces.is_none() || (asked && mode.is_in_air()), "{mode:?}");
                    prop_assert!(was_allowed || forces.is_none(), "a stopped craft needs a new request");
                    prop_assert!(!seen.fault || mode == Mode::Stopped(Reason::Fault(Fault::StackExhausted)));
                    for force in forces.into_iter().flatten() {
                        prop_assert!((figures.force_min_n..=figures.force_max_n).contains(&force), "{force}");
                    }
                    asked &= mode.motors_allowed();
                }
            }
        }
    }
}

#[test]
fn every_mode_is_reached_and_left() {
    let mut craft = Craft::new();
    let mut wobble = 0.0;
    // Never quite the same.
    let mut well = |height: f32, up: f32| {
        wobble = 1e-3 - wobble;
        Seen {
            state: Some(State {
                position_m: Vector3::new(wobble, 0.0, height),
                attitude: Quaternion::new((0.5 * (1.0 + up)).sqrt(), (0.5 * (1.0 - up)).sqrt(), 0.0, 0.0),
                velocity_m_s: Vector3::new(0.0, wobble, 0.0),
            }),
            rates: Vector3::new(wobble, 0.0, 0.0),
            felt: None,
            asked: Asked::Places,
            reference: ReferenceReport::Sound,
            goal: Vector3::new(0.0, 0.0, height),
            link: Some(0),
            battery_v: 3.8,
            overrun: false,
            fault: false,
        }
    };
    let mut modes = vec![craft.guard.mode()];
    let mut steps = |craft: &mut Craft, count: u32, make: &mut dyn FnMut() -> Seen| {
        for _ in 0..count {
            craft.step(&make());
            if modes.last() != Some(&craft.guard.mode()) {
                modes.push(craft.guard.mode());
            }
        }
    };
    craft.guard.arm(0);
    steps(&mut craft, 1, &mut || Seen { reference: ReferenceReport::Missing, ..well(1.0, 1.0) });
    steps(&mut craft, 1, &mut || well(1.0, 1.0));
    steps(&mut craft, 10, &mut || Seen { link: None, ..well(1.0, 1.0) });
    steps(&mut craft, 60, &mut || well(1.0, 1.0));
    // Holds, goes down, and does not move any more.
    steps(&mut craft, 2000, &mut || Seen { link: None, ..well(0.0, 1.0) });
    craft.guard.arm(craft.now);
    steps(&mut craft, 1, &mut || well(1.0, 1.0));
    steps(&mut craft, 600, &mut || well(1.0, 0.4));
    craft.guard.disarm(craft.now);
    steps(&mut craft, 1, &mut || well(1.0, 1.0));
    let lost = Reason::LinkLost;
    let expected = [
        Mode::OnGround,
        Mode::Armed,
        Mode::Flying,
        Mode::Holding(lost),
        Mode::Flying,
        Mode::Holding(lost),
        Mode::LevelAndDown(lost),
        Mode::Stopped(Reason::Landed),
        Mode::Flying,
        Mode::Tumbled(Tumble::Tilted),
        Mode::OnGround,
    ];
    assert_eq!(modes, expected);
}
