//! The commands by what one wants of them, with an example of each: the first page of the help.

use clap::{Arg, Command};

use crate::output::table::wrapped;

/// Groups of commands, each with what is typed behind the program's name.
const GROUPS: [(&str, &[(&str, &str)]); 4] = [
    (
        "Simulate",
        &[
            ("room", "room --scene clutter --layout 7"),
            ("compare", "compare --quick"),
            ("sweep", "sweep cell-size"),
            ("tune", "tune --mappers mrf"),
            ("slam-worlds", "slam-worlds --seeds 5"),
            ("ray", "ray near"),
            ("sensor", "sensor room"),
            ("speed", "speed --growth"),
            ("features", "features --posts 50"),
        ],
    ),
    (
        "Real data",
        &[
            ("replay", "replay scenes/logs/aces.clf.bz2"),
            ("slam", "slam scenes/logs/aces.clf.bz2 --particles 5"),
            ("calibrate", "calibrate scenes/logs/aces.clf.bz2"),
            ("scene", "scene from-plan scenes/plans/flat.json --out flat.toml"),
            ("convert", "convert results/room/visibility-c.npy map.yaml"),
        ],
    ),
    (
        "Judge",
        &[
            ("score", "score results/room/visibility-c.npy --truth room"),
            ("gate", "gate --only near"),
            ("estimate", "estimate room"),
        ],
    ),
    (
        "Tools",
        &[
            ("check", "check room --show"),
            ("report", "report results/room"),
            ("schema", "schema scene"),
            ("list", "list"),
            ("guide", "guide logs"),
            ("completions", "completions bash"),
            ("man", "man"),
        ],
    ),
];

/// Columns before what a command does.
const INDENT: usize = 14;

/// The command line with its first page in groups, in lines of at most so many columns.
pub(super) fn grouped(command: Command, width: usize) -> Command {
    let text = groups(&command, width);
    command.mut_subcommands(with_lists).help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{text}\nOptions:\n{{options}}{{after-help}}"
    ))
}

/// Lists that are usual values are told with a blank behind each comma, where a line can end.
fn with_lists(command: Command) -> Command {
    let told = |arg: Arg| {
        let usual: Vec<String> =
            arg.get_default_values().iter().map(|value| value.to_string_lossy().into_owned()).collect();
        let list = usual.join(",").split(',').collect::<Vec<_>>().join(", ");
        if arg.get_value_delimiter().is_none() || !list.contains(',') {
            return arg;
        }
        let about = arg.get_help().map(ToString::to_string).unwrap_or_default();
        arg.help(format!("{about} [default: {list}]")).hide_default_value(true)
    };
    command.mut_args(told).mut_subcommands(with_lists)
}

fn groups(command: &Command, width: usize) -> String {
    let mut text = String::new();
    for (title, commands) in GROUPS {
        text += &format!("{title}:\n");
        for (name, example) in commands {
            let about = command.find_subcommand(name).and_then(Command::get_about).map(ToString::to_string);
            let lines = wrapped(&about.unwrap_or_default(), width.saturating_sub(INDENT));
            for (number, line) in lines.iter().enumerate() {
                let head = if number == 0 { *name } else { "" };
                text += &format!("  {head:<12}{line}\n");
            }
            let example = format!("{} {example}", command.get_name());
            let lines = wrapped(&example, width.saturating_sub(INDENT + 4));
            text += &format!("{:INDENT$}$ {}\n", "", lines.join(&format!("\n{:1$}", "", INDENT + 4)));
        }
        text += "\n";
    }
    text.trim_end().to_owned() + "\n"
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn every_command_stands_in_one_group_with_an_example_that_is_parsed() {
        let command = super::super::Cli::command();
        let mut named: Vec<&str> =
            GROUPS.iter().flat_map(|(_, commands)| commands.iter().map(|(name, _)| *name)).collect();
        let mut all: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        named.sort_unstable();
        all.sort_unstable();
        assert_eq!(named, all);
        for (name, example) in GROUPS.iter().flat_map(|(_, commands)| *commands) {
            assert_eq!(example.split(' ').next(), Some(*name));
            let typed = std::iter::once("sightgrid").chain(example.split(' '));
            super::super::Cli::command()
                .try_get_matches_from(typed)
                .unwrap_or_else(|error| panic!("{example}: {error}"));
        }
    }

    #[test]
    fn lines_end_within_the_width_and_between_words() {
        for width in [60, 80, 100] {
            let text = groups(&super::super::Cli::command(), width);
            assert!(text.lines().all(|line| line.chars().count() <= width), "{width}: {text}");
        }
    }
}
