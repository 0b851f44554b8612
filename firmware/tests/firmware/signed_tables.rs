//! An image that takes signed gain tables alone: no other is flown, however good its certificate.

use quatrack::gains::paper;
use quatrack::gains::table::{GainTable, Rows, TABLE_BYTES_MAX, TableError};
use quatrack::link::{
    BlobError, BlobKind, Encoder, FRAME_BYTES, FromBoard, GivenKeys, KEY_BYTES, Key, LawChoice, LoopStatistics, Nonce,
    Refusal, Table, ToBoard, UploadBegin, signature,
};
use quatrack::{Rate, Tick};
use quatrack_firmware::flight::Flight;
use quatrack_firmware::kept::Keep;
use quatrack_firmware::provisioned::Keys;
use quatrack_firmware::session::{Session, Shared, Uploads, Vitals};

/// LQR-E for the Crazyflie 2.1, as `quatrack gains design` writes it.
pub(crate) const TABLE: &[u8] = include_bytes!("../../../gains/generated/lqr-e.bin");

struct Here(Flight);

impl Shared for Here {
    fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R {
        access(&mut self.0)
    }
}

struct Still;

impl Vitals for Still {
    fn now(&self) -> Tick {
        0
    }

    fn statistics(&self) -> LoopStatistics {
        LoopStatistics::default()
    }

    fn nonce(&self) -> Option<Nonce> {
        None
    }

    fn set_decimation(&self, _decimation: u32) {}
}

/// A board at the end of a cable, and the host's numbers.
pub(crate) struct Board<K> {
    flight: Here,
    session: Session<K>,
    host: Encoder,
    uploads: u32,
}

impl<K: Keep> Board<K> {
    /// Started anew, with the uploads that were kept.
    pub(crate) fn started(signing: Option<[u8; KEY_BYTES]>, kept: K) -> Self {
        let keys = Keys::of(&GivenKeys { link: None, signing });
        let mut flight = Here(Flight::new(Box::leak(Box::default()), None));
        let mut session = Session::new(Box::leak(Box::new(Uploads::new())), keys, kept, None);
        session.restore(&mut flight);
        let mut board = Self { flight, session, host: Encoder::new(1), uploads: 0 };
        board.ask(&ToBoard::Hello(Nonce::NONE));
        board
    }

    pub(crate) fn ask(&mut self, message: &ToBoard) -> FromBoard {
        let frame = self.host.encode(message, &mut [0; FRAME_BYTES]).unwrap().to_vec();
        let answers = frame.iter().find_map(|byte| self.session.push(*byte, &mut self.flight, &Still)).unwrap();
        answers[0]
    }

    /// Uploads a blob and gives the answer to its last message.
    pub(crate) fn upload(&mut self, kind: BlobKind, blob: &[u8], last: fn(u32) -> ToBoard) -> Result<(), Refusal> {
        self.uploads += 1;
        let begin = UploadBegin::of(kind, self.uploads, blob).unwrap();
        let mut answer = self.ask(&ToBoard::UploadBegin(begin));
        while let FromBoard::Upload(progress) = answer {
            let Some(chunk) = progress.next_chunk(blob) else { break };
            answer = self.ask(&ToBoard::UploadChunk(chunk));
        }
        match self.ask(&last(self.uploads)) {
            FromBoard::Ack { .. } => Ok(()),
            FromBoard::Nack { reason, .. } => Err(reason),
            other => panic!("{other:?}"),
        }
    }

    fn commit(&mut self, table: &[u8]) -> Result<(), Refusal> {
        self.upload(BlobKind::GainTable, table, |id| ToBoard::UploadCommit { id })
    }

    /// Whether a loaded table can be chosen.
    pub(crate) fn has_table(&mut self) -> bool {
        matches!(self.ask(&ToBoard::SelectLaw(LawChoice::new(Table::Loaded(0)))), FromBoard::Ack { .. })
    }
}

/// A key that is made when the test runs.
pub(crate) fn random_key() -> [u8; KEY_BYTES] {
    use std::hash::{BuildHasher, Hasher, RandomState};
    let mut bytes = [0; KEY_BYTES];
    for word in bytes.as_chunks_mut::<8>().0 {
        *word = RandomState::new().build_hasher().finish().to_le_bytes();
    }
    bytes
}

pub(crate) fn signed(table: &[u8], key: &[u8; KEY_BYTES]) -> Vec<u8> {
    [table, &signature(&Key::new(key), table)].concat()
}

/// The same certificate over gains of the other sign: every deviation is driven on.
fn negated() -> Vec<u8> {
    let head = *GainTable::from_bytes(TABLE).unwrap().head();
    let rows = paper::LQR_E.gain().rows().map(|row| row.map(|entry| -entry));
    GainTable::new(head, &Rows::Equilibrium(rows)).unwrap().to_bytes(&mut [0; TABLE_BYTES_MAX]).unwrap().to_vec()
}

/// A table of the law before the cascade, sound and certified.
const ACTUATOR_AWARE: &[u8] = include_bytes!("../../../tests/data/actuator-aware.bin");

const UNSIGNED: Result<(), Refusal> = Err(Refusal::Blob(BlobError::Unsigned));

#[test]
fn only_tables_signed_with_the_right_key_are_taken() {
    let (key, other) = (random_key(), random_key());
    let mut board = Board::started(Some(key), quatrack_firmware::kept::NoFlash);
    assert_eq!(board.commit(TABLE), UNSIGNED);
    assert_eq!(board.commit(&signed(TABLE, &other)), UNSIGNED);
    assert!(!board.has_table());
    assert_eq!(board.commit(&signed(TABLE, &key)), Ok(()));
    assert!(board.has_table());
}

#[test]
fn a_forged_table_is_refused_where_tables_are_signed_and_taken_where_they_are_not() {
    let key = random_key();
    let forged = negated();
    assert_eq!(Rate::from_hz(500), Some(GainTable::from_bytes(&forged).unwrap().head().rate));
    let mut cable = Board::started(None, quatrack_firmware::kept::NoFlash);
    assert_eq!(cable.commit(&forged), Ok(()), "nothing on board proves a certificate");
    let mut board = Board::started(Some(key), quatrack_firmware::kept::NoFlash);
    assert_eq!(board.commit(&forged), UNSIGNED);
    // The signature of the table that was forged, behind the forged one.
    let behind = &signed(TABLE, &key)[TABLE.len()..];
    assert_eq!(board.commit(&[&forged, behind].concat()), UNSIGNED);
    assert!(!board.has_table());
}

#[test]
fn any_bit_of_a_signed_table_counts() {
    let key = random_key();
    let mut board = Board::started(Some(key), quatrack_firmware::kept::NoFlash);
    let mut blob = signed(TABLE, &key);
    // Every bit of the signature, and one of each word of the table.
    let table = (0..8 * TABLE.len()).step_by(32);
    for bit in table.chain(8 * TABLE.len()..8 * blob.len()) {
        blob[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(board.commit(&blob), UNSIGNED, "bit {bit}");
        blob[bit / 8] ^= 1 << (bit % 8);
    }
    assert!(!board.has_table());
}

#[test]
fn a_signed_table_is_taken_where_any_are() {
    let mut cable = Board::started(None, quatrack_firmware::kept::NoFlash);
    assert_eq!(cable.commit(&signed(TABLE, &random_key())), Ok(()));
}

#[test]
fn a_table_of_the_actuator_aware_law_is_refused_by_name_signed_or_not() {
    let key = random_key();
    let refused = Err(Refusal::Blob(BlobError::GainTable(TableError::ActuatorAware.into())));
    for (signing, blob) in [(None, ACTUATOR_AWARE.to_vec()), (Some(key), signed(ACTUATOR_AWARE, &key))] {
        let mut board = Board::started(signing, quatrack_firmware::kept::NoFlash);
        assert_eq!(board.commit(&blob), refused);
        assert!(!board.has_table());
    }
}
