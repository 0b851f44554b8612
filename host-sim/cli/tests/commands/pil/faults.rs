//! The worst faults, flown by the image on the emulated board.

use quatrack_cli::pil::faults::{WORST, fly};
use quatrack_simulation::faults::kinds;

use super::emulated::connected;
use super::support::has_emulator;

#[test]
fn nothing_recoverable_is_lost_and_the_rest_ends_with_motors_off() {
    if !has_emulator() {
        return;
    }
    let mut client = connected();
    let faults: Vec<_> = kinds().into_iter().filter(|fault| WORST.contains(&fault.name)).collect();
    assert_eq!(faults.len(), WORST.len());
    for fault in &faults {
        let row = fly(&mut client, fault).unwrap();
        assert!(row.is_as_promised(), "{row:?}");
    }
}
