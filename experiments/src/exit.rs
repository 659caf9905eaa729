//! How a program of ours ends: its last message, and the exit codes of the command line.

use std::process::ExitCode;

use crate::failure::Failure;
use crate::jobs::interruption;
use crate::output::tell;

/// Prints why a command did not succeed, if it did not, and gives the exit code: 0 done, 1 a failure of the system or a
/// defect of ours, 2 bad input, 3 a claim or a gate that does not hold; after an interruption the code of that.
pub(crate) fn code(outcome: Result<(), Failure>) -> ExitCode {
    let Err(failure) = outcome else { return ExitCode::SUCCESS };
    if let Some(code) = interruption::exit_code() {
        return ExitCode::from(code); // files vanish then under the hands of whoever still writes them
    }
    format!("error: {failure}").lines().for_each(tell);
    ExitCode::from(match failure {
        Failure::Internal(_) => 1,
        Failure::BadInput(_) => 2,
        Failure::Claim(_) => 3,
    })
}
