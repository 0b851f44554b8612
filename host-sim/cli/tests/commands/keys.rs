//! `quatrack keys`, and the tables that `quatrack gains` signs with them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use quatrack::link::{GivenKeys, KEY_SLOT_BYTES, Key, Protection, signed_with};

const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../gains/generated/lqr-e.bin");

fn quatrack(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quatrack")).args(arguments).current_dir(folder).output().unwrap()
}

fn done(folder: &Path, arguments: &[&str]) {
    let output = quatrack(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

fn refused(folder: &Path, arguments: &[&str], said: &str) {
    let output = quatrack(folder, arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && stderr.contains(said), "{arguments:?}: {stderr}");
}

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("keys").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn key(path: &Path) -> [u8; 32] {
    let text = fs::read_to_string(path).unwrap();
    let digits = text.trim_end();
    assert_eq!(digits.len(), 64);
    std::array::from_fn(|at| u8::from_str_radix(&digits[2 * at..2 * at + 2], 16).unwrap())
}

#[test]
fn every_new_key_is_another_one_which_its_owner_alone_may_read() {
    let dir = folder("new");
    done(&dir, &["keys", "new", "a"]);
    done(&dir, &["keys", "new", "b"]);
    assert_ne!(key(&dir.join("a")), key(&dir.join("b")));
    #[cfg(unix)]
    assert_eq!(
        std::os::unix::fs::PermissionsExt::mode(&fs::metadata(dir.join("a")).unwrap().permissions()) & 0o777,
        0o600
    );
    let before = key(&dir.join("a"));
    refused(&dir, &["keys", "new", "a"], "cannot make this file");
    assert_eq!(key(&dir.join("a")), before, "it is left as it is");
}

#[test]
fn a_signed_table_is_the_table_with_a_signature_that_holds() {
    let dir = folder("sign");
    done(&dir, &["keys", "new", "secret"]);
    done(&dir, &["gains", "sign", TABLE, "--key-file", "secret", "--out", "signed"]);
    let (blob, table) = (fs::read(dir.join("signed/lqr-e.signed.bin")).unwrap(), fs::read(TABLE).unwrap());
    assert_eq!(signed_with(&Key::new(&key(&dir.join("secret"))), &blob), Some(&table[..]));
    // Signed again, it has the new signature alone.
    done(&dir, &["gains", "sign", "signed/lqr-e.signed.bin", "--key-file", "secret"]);
    assert_eq!(fs::read(dir.join("signed/lqr-e.signed.signed.bin")).unwrap(), blob);
}

#[test]
fn files_that_are_no_table_or_no_key_are_refused_without_showing_them() {
    let dir = folder("refused");
    done(&dir, &["keys", "new", "secret"]);
    fs::write(dir.join("text"), "no table").unwrap();
    refused(&dir, &["gains", "sign", "text", "--key-file", "secret"], "text: gain table");
    for (name, text) in
        [("short", "00ff".to_owned()), ("word", "zz".repeat(32)), ("long", "00".repeat(33)), ("empty", String::new())]
    {
        fs::write(dir.join(name), &text).unwrap();
        refused(
            &dir,
            &["gains", "sign", TABLE, "--out", "signed", "--key-file", name],
            "is no key: 64 hexadecimal digits",
        );
        let output = quatrack(&dir, &["gains", "sign", TABLE, "--out", "signed", "--key-file", name]);
        assert!(text.is_empty() || !String::from_utf8_lossy(&output.stderr).contains(&text));
    }
    refused(&dir, &["gains", "sign", TABLE, "--key-file", "absent"], "absent: cannot be read");
}

#[test]
fn an_image_gets_its_keys_in_the_place_that_it_has_for_them() {
    let dir = folder("provision");
    done(&dir, &["keys", "new", "link"]);
    done(&dir, &["keys", "new", "tables"]);
    let slot = GivenKeys::NONE.write();
    let image = [&[1; 1000][..], &slot, &[2; 500]].concat();
    fs::write(dir.join("image"), &image).unwrap();
    let given = || GivenKeys::read(fs::read(dir.join("out")).unwrap()[1000..1000 + KEY_SLOT_BYTES].try_into().unwrap());

    done(&dir, &["keys", "provision", "image", "--out", "out", "--link", "link", "--tables", "tables"]);
    let expected = GivenKeys {
        link: Some((key(&dir.join("link")), Protection::Everything)),
        signing: Some(key(&dir.join("tables"))),
    };
    assert_eq!(given(), expected);
    done(&dir, &["keys", "provision", "out", "--out", "out", "--link", "link", "--orders-only"]);
    assert_eq!(given(), GivenKeys { link: Some((key(&dir.join("link")), Protection::Orders)), signing: None });
    done(&dir, &["keys", "provision", "out", "--out", "out"]);
    assert_eq!(fs::read(dir.join("out")).unwrap(), image, "all of it is gone, and nothing else was touched");

    fs::write(dir.join("two"), [&slot[..], &slot].concat()).unwrap();
    fs::write(dir.join("none"), [0; 500]).unwrap();
    for wrong in ["two", "none"] {
        refused(&dir, &["keys", "provision", wrong, "--out", "out"], "has no one place for keys");
    }
}
