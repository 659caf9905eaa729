//! `completions SHELL` and `man`: what shells and `man` know of the command line.

use clap::{Args, Command};
use clap_complete::Shell;

use crate::failure::Failure;
use crate::output::table::print;

/// Options of `completions`.
#[derive(Debug, Args)]
pub struct CompletionsOptions {
    /// Shell that is to complete the commands
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: Shell,
}

/// Prints the completions of a command line.
///
/// # Errors
/// A stdout that cannot be written.
pub fn run(options: &CompletionsOptions, mut command: Command) -> Result<(), Failure> {
    let (name, mut script) = (command.get_name().to_owned(), Vec::new());
    clap_complete::generate(options.shell, &mut command, name, &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Prints the manual page of a command line: its own, then those of its commands.
///
/// # Errors
/// A stdout that cannot be written.
pub fn man(command: Command) -> Result<(), Failure> {
    let mut page = Vec::new();
    let written = pages(&command, &mut page);
    written.map_err(Failure::internal)?;
    print(&String::from_utf8_lossy(&page))
}

/// One page with the options of every command.
fn pages(command: &Command, page: &mut Vec<u8>) -> std::io::Result<()> {
    clap_mangen::Man::new(command.clone()).render(page)?;
    for inner in command.get_subcommands() {
        let name = inner.get_name();
        page.extend(format!(".SH \"{}\"\n", name.to_uppercase()).bytes());
        let man = clap_mangen::Man::new(inner.clone());
        man.render_description_section(page)?;
        man.render_synopsis_section(page)?;
        man.render_options_section(page)?;
    }
    Ok(())
}
