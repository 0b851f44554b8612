//! Tables flown: a loaded one commands the bits of the one in the image; a swap at zero error does not move a command.

use proptest::prelude::*;
use quatrack::gains::paper;
use quatrack::gains::table::{GainTable, Rows};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Command, Controller, Equilibrium, ErrorForm, FeedForward, FlatOutput, FlatSample, Handover, Law, Memory,
    Quaternion, Reference, Settings, State,
};
use quatrack_tests::core_step::{command, step};
use quatrack_tests::halton;

use super::fixture::{VEHICLE, bytes_of, head, paper_tables, rate, table};

const CASES: u32 = 5000;

fn loaded(name: &str) -> GainTable<'static> {
    GainTable::from_bytes(&bytes_of(&table(name))).unwrap().owned().unwrap()
}

fn controller<'t>(table: &'t GainTable<'_>, feed_forward: FeedForward, error_form: ErrorForm) -> Controller<'t> {
    let accepted = table.accept_for(&VEHICLE, rate()).unwrap();
    let settings = Settings { feed_forward, error_form, ..Settings::new(accepted.limits(), rate()) };
    accepted.controller(&settings).unwrap()
}

fn bits(command: &Command) -> [u32; 4] {
    let rates = &command.body_rates_rad_s;
    [command.thrust_m_s2, rates.x, rates.y, rates.z].map(f32::to_bits)
}

fn spread(unit: f64, size: f64) -> f32 {
    ((2.0 * unit - 1.0) * size) as f32
}

/// A reference in motion and a state half a metre and 25 degrees off it, the quaternion of any sign.
fn case(index: u32) -> (Reference, State) {
    let u = halton::<20>(index);
    let vector = |at: usize, size| Vector3::new(spread(u[at], size), spread(u[at + 1], size), spread(u[at + 2], size));
    let reference = Reference::from_flat(&FlatSample {
        position_m: vector(0, 2.0),
        velocity_m_s: vector(3, 2.0),
        acceleration_m_s2: vector(6, 4.0),
        jerk_m_s3: vector(9, 10.0),
        heading_rad: spread(u[12], 3.0),
        heading_rate_rad_s: spread(u[13], 2.0),
    })
    .unwrap();
    let (target, turn) = (reference.state(), vector(14, 0.2));
    let sign = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
    let q = target.attitude * Quaternion::new((1.0 - turn.norm_squared()).sqrt(), turn.x, turn.y, turn.z);
    let state = State {
        position_m: target.position_m + vector(15, 0.5),
        attitude: Quaternion::new(sign * q.w, sign * q.x, sign * q.y, sign * q.z),
        velocity_m_s: target.velocity_m_s + vector(17, 1.0),
    };
    (reference, state)
}

#[test]
fn a_loaded_table_commands_the_bits_of_the_one_in_the_image() {
    for (name, _) in paper_tables() {
        let loaded = loaded(name);
        for feed_forward in [FeedForward::Without, FeedForward::With] {
            for error_form in [ErrorForm::HeadingFrame, ErrorForm::Paper] {
                let built_in: Law<'_> = match name {
                    "lyap-e" => Equilibrium { gain: &paper::LYAP_E, error_form, feed_forward }.into(),
                    "lqr-e" => Equilibrium { gain: &paper::LQR_E, error_form, feed_forward }.into(),
                    "lyap-f" => FlatOutput { gain: &paper::LYAP_F, feed_forward }.into(),
                    _ => FlatOutput { gain: &paper::LQR_F, feed_forward }.into(),
                };
                let built_in = Controller::new(built_in, loaded.head().limits);
                let from_file = controller(&loaded, feed_forward, error_form);
                let mut answered = 0;
                for index in 0..CASES {
                    let (reference, state) = case(index);
                    let (expected, found) = (step(&built_in, &state, &reference), step(&from_file, &state, &reference));
                    assert_eq!(found, expected, "{name}, case {index}");
                    let (Ok(expected), Ok(found)) = (expected, found) else { continue };
                    assert_eq!(bits(&found.command), bits(&expected.command), "{name}, case {index}");
                    answered += 1;
                }
                // The flat output laws have no answer where they ask for free fall.
                assert!(answered > CASES / 2, "{name}: {answered} commands");
            }
        }
    }
}

/// Any gains for the equilibrium law, structured or not.
fn equilibrium_gains() -> impl Strategy<Value = Rows> {
    let entry = prop_oneof![2 => Just(0.0_f32), 3 => -100.0_f32..100.0];
    proptest::array::uniform4(proptest::array::uniform9(entry.prop_map(|k| if k.abs() < 1e-3 { 0.0 } else { k })))
        .prop_filter("every error is used", |rows| (0..9).all(|column| rows.iter().any(|row| row[column] != 0.0)))
        .prop_map(Rows::Equilibrium)
}

fn written(rows: &Rows) -> GainTable<'static> {
    GainTable::new(head("any"), rows).unwrap()
}

fn hover(index: u32) -> Reference {
    let u = halton::<4>(index);
    let at = Vector3::new(spread(u[0], 5.0), spread(u[1], 5.0), spread(u[2], 5.0));
    Reference::hover(at, spread(u[3], 3.0)).unwrap()
}

proptest! {
    #[test]
    fn a_swap_at_zero_error_does_not_move_the_command(
        old in equilibrium_gains(), new in equilibrium_gains(), index in 0..CASES, forward in any::<bool>()
    ) {
        let feed_forward = if forward { FeedForward::With } else { FeedForward::Without };
        let gains = [written(&old), written(&new)];
        let commands = |reference: &Reference| gains.each_ref().map(|table| {
            let controller = controller(table, feed_forward, ErrorForm::HeadingFrame);
            step(&controller, reference.state(), reference).unwrap().command
        });
        // In hover, at any heading, the error is 0 to the bit. Equal as numbers: a rate of zero may change its sign,
        // which no actuator sees.
        let [before, after] = commands(&hover(index));
        prop_assert_eq!(before, after);
        // On a tilted reference q_r^-1 q is rounded: three components, each off by two units in the last place of 1/2.
        let [before, after] = commands(&case(index).0);
        let rounding = 3.0 * f32::EPSILON * old.entries().iter().chain(new.entries()).fold(0.0, |a, k| k.abs().max(a));
        let jump = (after.body_rates_rad_s - before.body_rates_rad_s).amax();
        prop_assert!(jump.max((after.thrust_m_s2 - before.thrust_m_s2).abs()) <= 2.0 * rounding + 2e-6, "{}", jump);
    }

    #[test]
    fn a_swap_off_zero_error_jumps_by_the_difference_of_the_gains_and_a_handover_by_a_part_of_it(
        index in 0..CASES, steps in 2..200_u16
    ) {
        let (reference, state) = case(index);
        let (old, new) = (loaded("lyap-e"), loaded("lqr-e"));
        let [old, new] = [&old, &new].map(|table| controller(table, FeedForward::With, ErrorForm::HeadingFrame));
        let rates = |step: &quatrack::Step| step.command.body_rates_rad_s;
        let from = step(&old, &state, &reference).unwrap();
        let jump = (rates(&step(&new, &state, &reference).unwrap()) - rates(&from)).amax();
        let mut memory = Memory::at_rest();
        let mut way = Handover::begin(steps, old.law(), new.law(), &mut memory);
        let mut last = from;
        for _ in 0..steps {
            let next = way.step((&old, &new), &mut memory, (&state).into(), (&reference).into());
            let next = command(next.unwrap());
            // Rounding: a few units in the last place of the largest rate, 20 rad/s.
            prop_assert!((rates(&next) - rates(&last)).amax() <= jump / f32::from(steps) + 1e-5);
            last = next;
        }
        prop_assert_eq!(last, step(&new, &state, &reference).unwrap(), "the way ends at the new table's command");
    }
}

#[test]
fn swapping_the_papers_tables_in_hover_keeps_every_bit_of_the_command() {
    for index in 0..CASES {
        let u = halton::<3>(index);
        let at = Vector3::new(spread(u[0], 5.0), spread(u[1], 5.0), spread(u[2], 5.0));
        let reference = Reference::hover(at, 0.0).unwrap();
        for feed_forward in [FeedForward::Without, FeedForward::With] {
            let commands = paper_tables().map(|(name, _)| {
                let table = loaded(name);
                step(&controller(&table, feed_forward, ErrorForm::HeadingFrame), reference.state(), &reference).unwrap()
            });
            for step in &commands {
                assert_eq!(step.command, *reference.input(), "the thrust that holds the craft up, from every law");
            }
            // Within each law, which has the same signs in both of its tables.
            for pair in commands.chunks(2) {
                assert_eq!(bits(&pair[0].command), bits(&pair[1].command));
            }
        }
    }
}
