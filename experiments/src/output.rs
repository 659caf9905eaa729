//! What a command leaves behind: folders, tables, records.

pub mod digest;
pub mod folder;
pub mod record;
pub mod summary;
pub mod table;
