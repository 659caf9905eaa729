//! Mappers by the names that a user gives.

use mapper::catalogue::{self, Entry};
use strict::nearest;

use crate::failure::Failure;
use crate::programs::options::ProgramOptions;

/// The mappers of the given names, and then those programs that are not named.
///
/// # Errors
/// A name that does not exist, with those that do and the nearest; a name given twice; no name.
pub fn entries(names: &[String], programs: &ProgramOptions) -> Result<Vec<&'static Entry>, Failure> {
    let own = own(programs)?;
    let known = || catalogue::MAPPERS.iter().chain(own.iter().copied()).map(|entry| entry.name);
    let mut entries: Vec<&'static Entry> = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        if name.is_empty() {
            let all = known().collect::<Vec<_>>().join(", ");
            return Err(Failure::BadInput(format!("--mappers: a name is empty; name one or more of: {all}")));
        }
        let of_programs = || own.iter().copied().find(|entry| entry.name == name);
        let Some(entry) = catalogue::find(name).or_else(of_programs) else {
            return Err(Failure::BadInput(format!(
                "--mappers: there is no mapper {name:?}; the nearest is '{}', all are: {}",
                nearest(name, known()),
                known().collect::<Vec<_>>().join(", ")
            )));
        };
        if entries.iter().any(|e| e.name == entry.name) {
            return Err(Failure::BadInput(format!("--mappers: '{name}' is given twice; name each mapper once")));
        }
        entries.push(entry);
    }
    entries.extend(own.iter().copied().filter(|own| !names.iter().any(|name| name.trim() == own.name)));
    Ok(entries)
}

/// The programs as mappers.
///
/// # Errors
/// Two of one name.
pub fn own(programs: &ProgramOptions) -> Result<Vec<&'static Entry>, Failure> {
    let all = &programs.programs;
    for (number, program) in all.iter().enumerate() {
        if all[..number].iter().any(|other| other.name == program.name) {
            let name = &program.name;
            return Err(Failure::BadInput(format!("--mapper: '{name}' is the name of two programs; name each once")));
        }
    }
    Ok(all.iter().map(|program| program.entry(programs.timeout())).collect())
}

#[cfg(test)]
mod tests {
    use mapper::catalogue::Kind;

    use super::*;
    use crate::programs::program::Program;

    #[test]
    fn blanks_about_names_do_not_count_and_empty_names_do() {
        let none = ProgramOptions::default();
        let named = |names: &[&str]| entries(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>(), &none);
        let known = named(&["visibility", " conventional ", "\tprior"]).expect("known");
        assert_eq!(known.iter().map(|entry| entry.name).collect::<Vec<_>>(), ["visibility", "conventional", "prior"]);
        assert!(named(&["visibility", " visibility"]).is_err() && named(&["visibility", " "]).is_err());
    }

    #[test]
    fn programs_stand_where_they_are_named_or_else_at_the_end() {
        let program = |text: &str| Program::parse(text).expect("valid");
        let programs = |texts: &[&str]| ProgramOptions {
            programs: texts.iter().map(|text| program(text)).collect(),
            ..ProgramOptions::default()
        };
        let names = ["b", "prior"].map(str::to_owned);
        let mapped = entries(&names, &programs(&["a=x", "b=online: y"])).expect("known");
        assert_eq!(mapped.iter().map(|entry| entry.name).collect::<Vec<_>>(), ["b", "prior", "a"]);
        assert_eq!(mapped[0].kind, Kind::Online);
        assert_eq!(mapped[2].kind, Kind::Batch);
        let twice = entries(&names, &programs(&["b=x", "b=y"])).map(|_| ()).expect_err("one name");
        assert_eq!(twice.to_string(), "--mapper: 'b' is the name of two programs; name each once");
        assert!(entries(&["c".to_owned()], &programs(&["b=x"])).is_err());
    }
}
