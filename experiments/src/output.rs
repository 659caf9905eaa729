//! What a command leaves behind: folders, tables, records.

pub mod digest;
pub mod folder;
pub mod ledger;
pub mod map;
pub mod publication;
pub mod record;
pub mod single;
pub mod summary;
pub mod table;
