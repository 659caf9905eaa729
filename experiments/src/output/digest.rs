//! Digests: names of what things are, whatever they are called and wherever they lie.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::OnceLock;

use sha2::{Digest as _, Sha256};

use crate::failure::Failure;

/// The SHA-256 of some bytes.
pub fn sha256(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

/// Size and SHA-256, in hexadecimal, of a file.
///
/// # Errors
/// A file that cannot be read.
pub fn file(path: &Path) -> io::Result<(u64, String)> {
    let (mut file, mut digest, mut bytes) = (File::open(path)?, Running::default(), 0);
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok((bytes, digest.hex())),
            read => {
                digest.add(&buffer[..read]);
                bytes += read as u64;
            }
        }
    }
}

/// The first eight bytes of the SHA-256, as a number.
pub fn number(bytes: &[u8]) -> u64 {
    let [a, b, c, d, e, f, g, h, ..] = sha256(bytes);
    u64::from_be_bytes([a, b, c, d, e, f, g, h])
}

/// Bytes in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// A digest in the making.
#[derive(Default)]
pub struct Running(Sha256);

impl Running {
    /// Takes in more bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The SHA-256 of all bytes so far, in hexadecimal.
    pub fn hex(self) -> String {
        hex(&<[u8; 32]>::from(self.0.finalize()))
    }
}

/// What tells this program from another build of it: its version, and a digest of its executable.
///
/// # Errors
/// An executable that cannot be read.
pub fn build() -> Result<&'static str, Failure> {
    static BUILD: OnceLock<Result<String, String>> = OnceLock::new();
    let build = BUILD.get_or_init(|| {
        // The link leads to the executable even after it was deleted or replaced.
        let executable = fs::read("/proc/self/exe").or_else(|_| std::env::current_exe().and_then(fs::read));
        let digest = executable.map(|bytes| number(&bytes)).map_err(|error| error.to_string())?;
        Ok(format!("{}-{digest:016x}", env!("CARGO_PKG_VERSION")))
    });
    build.as_deref().map_err(|error| Failure::Internal(format!("cannot read this program's own file: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_digests() {
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(hex(&sha256(b"abc")), abc);
        assert_eq!(number(b"abc"), 0xba78_16bf_8f01_cfea);
        let mut running = Running::default();
        running.add(b"a");
        running.add(b"bc");
        assert_eq!(running.hex(), abc);
    }
}
