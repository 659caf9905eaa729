//! What a command takes and leaves behind: options, folders, tables, records.

pub mod args;
pub mod digest;
pub mod folder;
pub mod record;
pub mod table;
