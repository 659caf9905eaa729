//! What a program said, and that it ended as it should.

use std::fmt::Debug;
use std::process::Output;

/// Stdout and stderr of a run of `what`, which must have ended with this exit code.
pub(crate) fn checked(code: i32, what: &dyn Debug, output: &Output) -> (String, String) {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert_eq!(output.status.code(), Some(code), "{what:?}\nstdout: {out}\nstderr: {err}");
    (out, err)
}
