//! What fuzzing has found, as tests.

mod writer;

use bags::Bag;
use writer::db3;

#[test]
fn names_of_tables_are_quoted_in_one_plain_line() {
    let bytes = db3::file(&[]);
    let at = bytes.windows(14).position(|some| some == b"messagesmessag").expect("the table's name") + 8;
    let mut changed = bytes;
    changed[at - 8..at + 8].fill(0);
    let bag = Bag::read(changed, "a.db3").expect("a bag");
    let said: Vec<String> = bag.records(|_| true).filter_map(Result::err).map(|damage| damage.to_string()).collect();
    assert!(said[0].contains("without the tables of a bag") && !said[0].contains(char::is_control), "{said:?}");
}
