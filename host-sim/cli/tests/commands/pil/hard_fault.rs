//! A processor that is sent where no code is: it restarts, says so, and does not fly again.

use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use quatrack::link::{Parameter, ToBoard};
use quatrack::supervisor::{Fault, Mode, Reason};
use quatrack_cli::pil::client::Client;
use quatrack_cli::pil::emulator::{Emulator, Folder};
use quatrack_cli::pil::interrupt::Interrupt;
use quatrack_cli::pil::line::Line;

use super::emulated::pipes_image;
use super::support::has_emulator;

/// A debugger's requests that set the program counter to 0xf0000000, and the answer to each. QEMU knows single
/// registers only after it has been asked for their list.
const TO_NOWHERE: [(&str, &str); 4] =
    [("?", "T"), ("qXfer:features:read:target.xml:0,fff", "<?xml"), ("Pf=000000f0", "OK"), ("D", "OK")];

/// A packet of the remote protocol that GDB speaks.
fn packet(text: &str) -> String {
    let sum = text.bytes().fold(0_u8, u8::wrapping_add);
    format!("${text}#{sum:02x}")
}

#[test]
fn a_hard_fault_restarts_the_board_disarmed_for_good() {
    if !has_emulator() {
        return;
    }
    let folder = Folder::create().unwrap();
    let [to_board, from_board] = ["to-board", "from-board"].map(|name| folder.path().join(name));
    let line = Line::create_pipes(&to_board, &from_board).unwrap();
    let debugger = ["-serial", "none", "-gdb", "unix:gdb,server=on,wait=off"];
    let emulator = Emulator::start(&pipes_image(), folder.path(), &debugger).unwrap();
    let mut client = Client::connect(line, Some(emulator), None, Interrupt::default()).unwrap();
    client.set(Parameter::Decimation(0)).unwrap();
    client.request(&ToBoard::Arm).unwrap();

    let mut gdb = UnixStream::connect(folder.path().join("gdb")).unwrap();
    gdb.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
    for (command, expected) in TO_NOWHERE {
        gdb.write_all(packet(command).as_bytes()).unwrap();
        let (mut answer, mut bytes) = (String::new(), [0; 4096]);
        // The emulator looks at its debugger only while the board is not waiting in a read of the pipe.
        for _ in 0..400 {
            match gdb.read(&mut bytes) {
                Ok(count) => answer.push_str(&String::from_utf8_lossy(&bytes[..count])),
                Err(_) => client.noise(b"?").unwrap(),
            }
            if answer.contains(expected) {
                break;
            }
        }
        assert!(answer.contains(expected), "{command} is answered with {answer}");
        gdb.write_all(b"+").unwrap();
    }

    let mut client = client.reconnect().unwrap();
    assert_eq!(client.telemetry().unwrap().mode, Mode::Stopped(Reason::Fault(Fault::HardFault)));
    assert!(client.request(&ToBoard::Arm).is_err(), "it must not be armed again");
}
