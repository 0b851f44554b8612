//! Names in a table: text in, a fixed number of bytes that can be compared and printed out.

use core::fmt;

/// A name of 1 to [`Self::BYTES`] printable ASCII characters without spaces, filled up with zeros.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Padded", into = "Padded")
)]
pub struct Name {
    padded: Padded,
}

type Padded = [u8; Name::BYTES];

/// Why a text is no name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NameError {
    /// Nothing, or too much.
    Length {
        /// Bytes found.
        bytes: u32,
    },
    /// A byte that is no printable ASCII character, or one behind the zeros that fill up.
    Character {
        /// Its position, from 0.
        position: u8,
        /// The byte found.
        byte: u8,
    },
}

impl Name {
    /// Most characters.
    pub const BYTES: usize = 31;

    /// Checks a text.
    ///
    /// # Errors
    /// [`NameError`].
    pub const fn new(text: &str) -> Result<Self, NameError> {
        let mut padded = [0; Self::BYTES];
        let mut rest = text.as_bytes();
        if rest.is_empty() || rest.len() > Self::BYTES {
            return Err(NameError::Length { bytes: rest.len() as u32 });
        }
        let mut position = 0;
        while let Some((byte, after)) = rest.split_first() {
            if !byte.is_ascii_graphic() || position >= Self::BYTES {
                return Err(NameError::Character { position: position as u8, byte: *byte });
            }
            padded[position] = *byte;
            rest = after;
            position += 1;
        }
        Ok(Self { padded })
    }

    /// For names in the source: a bad one does not compile when it initialises a constant.
    ///
    /// # Panics
    /// At compile time, on text that [`Name::new`] refuses.
    pub const fn literal(text: &str) -> Self {
        match Self::new(text) {
            Ok(name) => name,
            Err(_) => panic!("a name has 1 to 31 printable ASCII characters without spaces"),
        }
    }

    /// Checks the bytes as a table stores them, zeros included.
    ///
    /// # Errors
    /// [`NameError`].
    #[inline(never)]
    pub fn from_padded(padded: [u8; Self::BYTES]) -> Result<Self, NameError> {
        let mut ended = false;
        for (position, byte) in (0_u8..).zip(padded) {
            match byte {
                0 if position == 0 => return Err(NameError::Length { bytes: 0 }),
                0 => ended = true,
                byte if ended || !byte.is_ascii_graphic() => return Err(NameError::Character { position, byte }),
                _ => {}
            }
        }
        Ok(Self { padded })
    }

    /// The bytes as a table stores them, zeros included.
    pub const fn padded(&self) -> [u8; Self::BYTES] {
        self.padded
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        let text = self.padded.split(|byte| *byte == 0).next().unwrap_or_default();
        // ASCII since it was checked.
        core::str::from_utf8(text).unwrap_or_default()
    }
}

impl TryFrom<Padded> for Name {
    type Error = NameError;

    fn try_from(padded: Padded) -> Result<Self, NameError> {
        Self::from_padded(padded)
    }
}

impl From<Name> for Padded {
    fn from(name: Name) -> Self {
        name.padded
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Name {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{=str}", self.as_str());
    }
}

impl fmt::Display for NameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { bytes } => write!(f, "name: {bytes} bytes; give 1 to {}", Name::BYTES),
            Self::Character { position, byte } => {
                write!(f, "name: byte {byte:#04x} at {position}; printable ASCII without spaces, then zeros")
            }
        }
    }
}

impl core::error::Error for NameError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_the_same_as_text_and_as_bytes() {
        for text in ["a", "crazyflie-2.1", "exactly-31-characters-is-all-ok"] {
            let name = Name::new(text).unwrap();
            assert_eq!(name.as_str(), text);
            assert_eq!(Name::from_padded(name.padded()), Ok(name));
        }
    }

    #[test]
    fn bad_names_are_refused_as_text_and_as_bytes() {
        assert_eq!(Name::new(""), Err(NameError::Length { bytes: 0 }));
        assert_eq!(Name::new("exactly-32-characters-is-too-lon"), Err(NameError::Length { bytes: 32 }));
        for (text, position, byte) in [("a b", 1, b' '), ("a\0", 1, 0), ("ü", 0, 0xC3)] {
            assert_eq!(Name::new(text), Err(NameError::Character { position, byte }), "{text:?}");
        }
        let mut padded = [0; Name::BYTES];
        assert_eq!(Name::from_padded(padded), Err(NameError::Length { bytes: 0 }));
        (padded[0], padded[2]) = (b'a', b'c');
        assert_eq!(Name::from_padded(padded), Err(NameError::Character { position: 2, byte: b'c' }), "behind the end");
        padded[1] = 0x7F;
        assert_eq!(Name::from_padded(padded), Err(NameError::Character { position: 1, byte: 0x7F }));
    }
}
