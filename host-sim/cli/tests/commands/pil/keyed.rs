//! The image on the emulated board with keys that it was given, and the uploads that it keeps while its power is off.

use std::fs;
use std::path::{Path, PathBuf};

use quatrack::link::{
    BlobError, BlobKind, FromBoard, GivenKeys, KEY_SLOT_BYTES, KEY_SLOT_MAGIC, Key, LawChoice, Parameter, Protection,
    Refusal, Table, ToBoard, UploadBegin,
};
use quatrack_cli::pil::PilError;
use quatrack_cli::pil::client::Client;
use quatrack_cli::pil::emulated::{self, Equipment, Transport};
use quatrack_cli::pil::interrupt::Interrupt;
use quatrack_cli::pil::lock_step::fly_all;

use super::emulated::pipes_image;
use super::support::{Scratch, failure, has_emulator};

const TABLE: &[u8] = include_bytes!("../../../../../gains/generated/lqr-e.bin");

/// A key that is made when the test runs.
fn random_key() -> [u8; 32] {
    let mut key = [0; 32];
    getrandom::fill(&mut key).unwrap();
    key
}

/// A copy of the image that was given keys.
fn image(folder: &Path, given: &GivenKeys) -> PathBuf {
    let mut bytes = fs::read(pipes_image()).unwrap();
    let at: Vec<usize> =
        (0..bytes.len() - KEY_SLOT_BYTES).filter(|at| bytes[*at..].starts_with(&KEY_SLOT_MAGIC)).collect();
    assert_eq!(at.len(), 1, "one place for keys");
    bytes[at[0]..at[0] + KEY_SLOT_BYTES].copy_from_slice(&given.write());
    let path = folder.join("image");
    fs::write(&path, bytes).unwrap();
    path
}

fn connect(image: &Path, equipment: Equipment<'_>) -> Result<Client, PilError> {
    emulated::connect(image, Transport::Pipes, equipment, Interrupt::default())
}

/// Uploads a blob; the answer to its last message.
fn upload(client: &mut Client, blob: &[u8], last: &ToBoard) -> FromBoard {
    let begin = UploadBegin::of(BlobKind::GainTable, 1, blob).unwrap();
    let mut answer = client.ask(&ToBoard::UploadBegin(begin)).unwrap();
    while let FromBoard::Upload(progress) = answer {
        let Some(chunk) = progress.next_chunk(blob) else { break };
        answer = client.ask(&ToBoard::UploadChunk(chunk)).unwrap();
    }
    client.ask(last).unwrap()
}

fn is_ack(answer: &FromBoard) -> bool {
    matches!(answer, FromBoard::Ack { .. })
}

#[test]
fn with_a_key_every_bit_is_as_without_and_the_host_names_its_protection() {
    if !has_emulator() {
        return;
    }
    let scratch = Scratch::new("keyed");
    let bare = fly_all(&mut connect(&pipes_image(), Equipment::default()).unwrap(), Some(400), &|| {}).unwrap();
    assert!(bare.to_string().contains("the link is for a cable only: no frame is authenticated"), "{bare}");
    for (protection, said) in [
        (Protection::Everything, "the link is authenticated, every frame"),
        (Protection::Orders, "the link is authenticated but for states and references"),
    ] {
        let key = random_key();
        let image = image(scratch.path(), &GivenKeys { link: Some((key, protection)), signing: None });
        let mut client = connect(&image, Equipment { key: Some(Key::new(&key)), ..Equipment::default() }).unwrap();
        assert_eq!(client.identity().protection, protection);
        let flown = fly_all(&mut client, Some(400), &|| {}).unwrap();
        assert!(flown.bit_exact && flown.hash == bare.hash);
        assert!(flown.to_string().contains(said), "{flown}");
        assert_eq!(client.telemetry().unwrap().link.rejected(), 0);
        let mut again = client.reconnect().unwrap();
        again.set(Parameter::TelemetryPeriodTicks(0)).unwrap();
    }
}

#[test]
fn another_key_none_or_one_too_many_is_named() {
    if !has_emulator() {
        return;
    }
    let scratch = Scratch::new("wrong-key");
    let key = random_key();
    let image = image(scratch.path(), &GivenKeys { link: Some((key, Protection::Everything)), signing: None });
    let said = |image: &Path, key: Option<[u8; 32]>| {
        let equipment = Equipment { key: key.map(|key| Key::new(&key)), ..Equipment::default() };
        connect(image, equipment).err().expect("no session").to_string()
    };
    let without = said(&image, None);
    assert!(without.contains("it answers holders of its key alone"), "{without}");
    for (image, key) in [(&image, random_key()), (&pipes_image(), key)] {
        let other = said(image, Some(key));
        assert!(other.contains("with this key; it has another one, or none"), "{other}");
    }
    // The same from the command.
    fs::write(scratch.path().join("key"), "00".repeat(32)).unwrap();
    let output = scratch.quatrack(&["pil", "--emulator", "--image", "image", "--key-file", "key"]).output().unwrap();
    let (code, text) = failure(&output);
    assert!(code == Some(2) && text.contains("with this key; it has another one"), "{text}");
    scratch.assert_clean();
}

#[test]
fn a_table_that_is_kept_is_there_when_the_power_is_back() {
    if !has_emulator() {
        return;
    }
    let scratch = Scratch::new("flash");
    let flash = scratch.path().join("flash");
    emulated::new_flash(&flash).unwrap();
    let started = || connect(&pipes_image(), Equipment { flash: Some(&flash), ..Equipment::default() }).unwrap();
    let loaded = ToBoard::SelectLaw(LawChoice::new(Table::Loaded(0)));
    let mut client = started();
    assert!(client.request(&loaded).is_err(), "nothing was kept yet");
    assert!(is_ack(&upload(&mut client, TABLE, &ToBoard::UploadCommit { id: 1 })));
    drop(client);
    let mut client = started();
    assert!(client.request(&loaded).is_err(), "committed, but not kept");
    assert!(is_ack(&upload(&mut client, TABLE, &ToBoard::UploadKeep { id: 1 })));
    drop(client);
    let mut client = started();
    client.request(&loaded).unwrap();
    let mut without = connect(&pipes_image(), Equipment::default()).unwrap();
    let answer = upload(&mut without, TABLE, &ToBoard::UploadKeep { id: 1 });
    assert!(matches!(answer, FromBoard::Nack { reason: Refusal::NotKept, .. }), "{answer:?}");
}

#[test]
fn an_image_that_takes_signed_tables_alone_refuses_any_other() {
    if !has_emulator() {
        return;
    }
    let scratch = Scratch::new("signed");
    let done = |arguments: &[&str]| assert!(scratch.quatrack(arguments).status().unwrap().success(), "{arguments:?}");
    let folder = scratch.path().to_owned();
    fs::write(folder.join("lqr-e.bin"), TABLE).unwrap();
    fs::copy(pipes_image(), folder.join("built")).unwrap();
    for owner in ["ours", "theirs"] {
        done(&["keys", "new", owner]);
        done(&["gains", "sign", "lqr-e.bin", "--key-file", owner, "--out", &format!("by-{owner}")]);
    }
    done(&["keys", "provision", "built", "--out", "image", "--tables", "ours"]);
    let mut client = connect(&folder.join("image"), Equipment::default()).unwrap();
    assert!(client.identity().signed_tables);
    let blob = |owner: &str| fs::read(folder.join(format!("by-{owner}/lqr-e.signed.bin"))).unwrap();
    for blob in [TABLE, &blob("theirs")] {
        let answer = upload(&mut client, blob, &ToBoard::UploadCommit { id: 1 });
        assert!(matches!(answer, FromBoard::Nack { reason: Refusal::Blob(BlobError::Unsigned), .. }), "{answer:?}");
    }
    let answer = upload(&mut client, &blob("ours"), &ToBoard::UploadCommit { id: 1 });
    assert!(is_ack(&answer), "{answer:?}");
}
