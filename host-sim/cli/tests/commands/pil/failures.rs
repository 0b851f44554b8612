//! `quatrack pil` where something is wrong: one line that names the fault, exit code 2, and nothing left behind.

use std::fs;

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use super::support::{Scratch, failure, has_emulator};

/// `b .`: runs for ever and says nothing.
const SILENT: [u16; 1] = [0xe7fe];

/// `udf #0`, with no handler for the fault: the processor locks up, and QEMU ends.
const DEAD: [u16; 1] = [0xde00];

#[test]
fn without_a_checkout_or_an_image_there_is_nothing_to_fly() {
    let scratch = Scratch::new("no-checkout");
    for arguments in [["pil", "--emulator"].as_slice(), &["measure"]] {
        let (code, text) = failure(&scratch.quatrack(arguments).output().unwrap());
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains("not inside a checkout") && text.contains("--image"), "{text}");
    }
}

#[test]
fn an_emulator_or_a_port_must_be_named() {
    let (code, text) = failure(&Scratch::new("nothing").quatrack(&["pil"]).output().unwrap());
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("--emulator") && text.contains("--port"), "{text}");
}

#[test]
fn a_file_that_is_no_image_is_refused() {
    let scratch = Scratch::new("no-image");
    fs::write(scratch.path().join("text"), "not an image").unwrap();
    let own = env!("CARGO_BIN_EXE_quatrack");
    for (image, reason) in [("text", "no ELF image"), (own, "no ELF image"), ("missing", "cannot read")] {
        let (code, text) = failure(&scratch.quatrack(&["pil", "--emulator", "--image", image]).output().unwrap());
        assert_eq!(code, Some(2), "{image}: {text}");
        assert!(text.contains(reason), "{image}: {text}");
    }
    scratch.assert_clean();
}

#[test]
fn a_missing_emulator_is_said_with_the_command_that_installs_it() {
    let scratch = Scratch::new("no-emulator");
    let image = scratch.image("silent", &SILENT);
    let mut command = scratch.quatrack(&["pil", "--emulator", "--image"]);
    let (code, text) = failure(&command.arg(image).env("PATH", scratch.path()).output().unwrap());
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("apt-get install qemu-system-arm"), "{text}");
    scratch.assert_clean();
}

#[test]
fn an_image_that_says_nothing_is_given_up() {
    if !has_emulator() {
        return;
    }
    let scratch = Scratch::new("silent");
    let image = scratch.image("silent", &SILENT);
    for transport in ["pipes", "usart"] {
        let mut command = scratch.quatrack(&["pil", "--emulator", "--transport", transport, "--image"]);
        let (code, text) = failure(&command.arg(&image).output().unwrap());
        assert_eq!(code, Some(2), "{transport}: {text}");
        assert!(text.contains("no answer within 4 s: the board does not say hello"), "{transport}: {text}");
        scratch.assert_clean();
    }
}

#[test]
fn an_emulator_that_dies_is_noticed() {
    if !has_emulator() {
        return;
    }
    let scratch = Scratch::new("dead");
    let image = scratch.image("dead", &DEAD);
    let (code, text) = failure(&scratch.quatrack(&["pil", "--emulator", "--image"]).arg(image).output().unwrap());
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("the emulator ended"), "{text}");
    scratch.assert_clean();
}

#[test]
fn a_port_where_nobody_answers_is_given_up() {
    let scratch = Scratch::new("port");
    let (code, text) = failure(&scratch.quatrack(&["pil", "--port", "/dev/null"]).output().unwrap());
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("is it a serial port?"), "{text}");

    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let port = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    let (code, text) = failure(&scratch.quatrack(&["pil", "--port", &port]).output().unwrap());
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("no answer within 4 s"), "{text}");
}
