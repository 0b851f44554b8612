//! Any orders, noise and steps into the image's session, over a cable and with a key: no panic, forces within the motors'
//! range, and no motor that turns for anybody who has not armed.
#![no_main]

use std::cell::Cell;

use libfuzzer_sys::fuzz_target;
use quatrack::Tick;
use quatrack::link::{
    FRAME_BYTES, GivenKeys, HostSession, Key, LoopStatistics, Nonce, Protection, ToBoard,
};
use quatrack_firmware::craft::BodyRates;
use quatrack_firmware::flight::Flight;
use quatrack_firmware::kept::NoFlash;
use quatrack_firmware::provisioned::Keys;
use quatrack_firmware::session::{Session, Shared, Uploads, Vitals};
use quatrack_firmware::vehicle::AIRFRAME;

struct Here(Flight);

impl Shared for Here {
    fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R {
        access(&mut self.0)
    }
}

struct At<'a>(Tick, &'a Cell<u8>);

impl Vitals for At<'_> {
    fn now(&self) -> Tick {
        self.0
    }

    fn statistics(&self) -> LoopStatistics {
        LoopStatistics::default()
    }

    fn nonce(&self) -> Option<Nonce> {
        self.1.set(self.1.get().wrapping_add(1));
        Some(Nonce([self.1.get(); 16]))
    }

    fn set_decimation(&self, _decimation: u32) {}
}

/// Bytes to take from.
struct Source<'b>(&'b [u8]);

impl Source<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*byte)
    }

    fn float(&mut self) -> Option<f32> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(f32::from_le_bytes(*bytes))
    }

    fn message(&mut self) -> Option<ToBoard> {
        let (message, rest) = postcard::take_from_bytes(self.0).ok()?;
        self.0 = rest;
        Some(message)
    }
}

/// A static of the board for one run, and free again after it: else thousands of runs take all memory.
struct Lent<T>(*mut T);

impl<T> Lent<T> {
    fn new(value: T) -> Self {
        Self(Box::into_raw(Box::new(value)))
    }

    /// To be asked for once; the borrower has to be gone first.
    fn lend(&self) -> &'static mut T {
        // SAFETY: of `new`, and freed by `drop` alone.
        unsafe { &mut *self.0 }
    }
}

impl<T> Drop for Lent<T> {
    fn drop(&mut self) {
        // SAFETY: of `new`, and dropped once.
        drop(unsafe { Box::from_raw(self.0) });
    }
}

fn fly(bytes: &[u8]) -> Option<()> {
    let mut source = Source(bytes);
    let protection = [Protection::CableOnly, Protection::Orders, Protection::Everything][usize::from(source.byte()? % 3)];
    let is_keyed = protection != Protection::CableOnly;
    let keys = Keys::of(&GivenKeys { link: is_keyed.then_some(([7; 32], protection)), signing: None });
    // Before those that borrow them: what is declared first goes last.
    let (store, uploads) = (Lent::new(Default::default()), Lent::new(Uploads::new()));
    let mut flight = Here(Flight::new(store.lend(), None));
    let mut session = Session::new(uploads.lend(), keys, NoFlash, None);
    // A pilot with the key, if there is one, and somebody without.
    let mut hosts = [HostSession::new(10), HostSession::new(11)];
    if is_keyed {
        hosts[0] = HostSession::keyed(10, Key::new(&[7; 32]), Nonce([1; 16]));
    }
    let figures = *AIRFRAME.figures();
    let (nonces, mut now, mut asked) = (Cell::new(0), 0, false);
    while let Some(choice) = source.byte() {
        let mut hear = |bytes: &[u8], host: &mut HostSession| {
            let mut buffer = [0; FRAME_BYTES];
            for byte in bytes {
                let answers = session.push(*byte, &mut flight, &At(now, &nonces));
                for message in answers.into_iter().flatten() {
                    let frame = session.frame(&message, &mut buffer).unwrap_or_default();
                    let _ = host.next(frame);
                }
            }
        };
        match choice % 8 {
            0..4 => {
                let number = usize::from(choice / 8) % 2;
                let host = &mut hosts[number];
                let message = match source.message()? {
                    ToBoard::Hello(_) => host.hello(),
                    message => message,
                };
                asked |= message == ToBoard::Arm && (number == 0 || !is_keyed);
                let mut buffer = [0; FRAME_BYTES];
                if let Ok(frame) = host.encode(&message, &mut buffer) {
                    hear(frame, host);
                }
            }
            4 => {
                let (noise, rest) = source.0.split_at(source.0.len().min(usize::from(choice)));
                source.0 = rest;
                hear(noise, &mut hosts[1]);
            }
            _ => {
                let rates = match choice / 8 % 2 {
                    0 => BodyRates::NoGyroscope,
                    _ => BodyRates::Measured([source.float()?, source.float()?, source.float()?].into()),
                };
                for _ in 0..=choice / 16 {
                    now += 2;
                    flight.0.step(now, choice % 8 == 7, rates);
                    let forces = *flight.0.forces_n();
                    let is_off = forces == [0.0; 4];
                    assert!(is_off || (asked && flight.0.mode().is_in_air()), "{:?}", flight.0.mode());
                    let range = figures.force_min_n..=figures.force_max_n;
                    assert!(is_off || forces.iter().all(|force| range.contains(force)), "{forces:?}");
                    assert!(flight.0.command().is_finite());
                }
            }
        }
    }
    Some(())
}

fuzz_target!(|bytes: &[u8]| {
    // Where the bytes end.
    let _ = fly(bytes);
});
