//! The values of a row.

/// A value of a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// Nothing, a number that is not whole, or one that is cut off.
    Other,
    Integer(i64),
    Text(String),
    Blob(Vec<u8>),
}

/// The values of a payload; those that are cut off are [`Value::Other`]. None where its head is damaged.
pub(super) fn values(payload: &[u8]) -> Option<Vec<Value>> {
    let (length, mut at) = varint(payload, 0)?;
    let mut place = usize::try_from(length).ok().filter(|length| *length <= payload.len())?;
    let end = place;
    let mut values = Vec::new();
    while at < end {
        let (kind, next) = varint(&payload[..end], at)?;
        at = next;
        let size = usize::try_from(match kind {
            0 | 8 | 9 => 0,
            1..=4 => kind,
            5 => 6,
            6 | 7 => 8,
            12.. => (kind - 12) / 2,
            _ => return None,
        })
        .ok()?;
        let bytes = place.checked_add(size).and_then(|end| payload.get(place..end));
        place = place.saturating_add(size);
        values.push(match (kind, bytes) {
            (8, _) => Value::Integer(0),
            (9, _) => Value::Integer(1),
            (1..=6, Some(bytes)) => {
                let sign = if bytes[0] >= 0x80 { -1 } else { 0 };
                Value::Integer(bytes.iter().fold(sign, |value, byte| value << 8 | i64::from(*byte)))
            }
            (12.., Some(bytes)) if kind % 2 == 0 => Value::Blob(bytes.to_vec()),
            (13.., Some(bytes)) => Value::Text(String::from_utf8_lossy(bytes).into_owned()),
            _ => Value::Other,
        });
    }
    Some(values)
}

/// A number of one to nine bytes, the high bits first, and where it ends.
pub(super) fn varint(bytes: &[u8], at: usize) -> Option<(i64, usize)> {
    let mut value: u64 = 0;
    for k in 0..9 {
        let byte = *bytes.get(at + k)?;
        if k == 8 {
            return Some(((value << 8 | u64::from(byte)) as i64, at + 9));
        }
        value = value << 7 | u64::from(byte & 0x7f);
        if byte < 0x80 {
            return Some((value as i64, at + k + 1));
        }
    }
    None
}

/// The names of the columns that the statement makes which made a table.
pub(super) fn columns(sql: &str) -> Vec<String> {
    let Some((_, list)) = sql.split_once('(') else { return Vec::new() };
    let (mut names, mut depth, mut part) = (Vec::new(), 0u32, String::new());
    for letter in list.chars() {
        match letter {
            '(' => depth += 1,
            ')' if depth == 0 => break,
            ')' => depth -= 1,
            ',' if depth == 0 => names.push(std::mem::take(&mut part)),
            _ => {}
        }
        if letter != ',' || depth > 0 {
            part.push(letter);
        }
    }
    names.push(part);
    let first = |part: &String| {
        part.split_whitespace().next().map(|name| name.trim_matches(['"', '`', '[', ']']).to_lowercase())
    };
    names.iter().filter_map(first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_as_many_bytes_as_they_need() {
        for (bytes, expected) in [
            (&[0x05][..], Some((5, 1))),
            (&[0x81, 0x00], Some((128, 2))),
            (&[0xff; 9], Some((-1, 9))),
            (&[0xff; 8], None),
            (&[], None),
        ] {
            assert_eq!(varint(bytes, 0), expected, "{bytes:?}");
        }
    }

    #[test]
    fn values_are_read_by_their_kinds_and_cut_ones_are_none() {
        // NULL, -2 in one byte, 1, text "ab", a blob of three bytes of which one is there.
        let payload = [6, 0, 1, 9, 17, 18, 0xfe, b'a', b'b', 7];
        let expected =
            [Value::Other, Value::Integer(-2), Value::Integer(1), Value::Text("ab".to_owned()), Value::Other];
        assert_eq!(values(&payload), Some(expected.to_vec()));
        assert_eq!(values(&[9, 0]), None, "a head that is longer than the row");
        assert_eq!(values(&[2, 10]), None, "a kind that no row has");
    }

    #[test]
    fn columns_stand_in_the_statement() {
        let sql = "CREATE TABLE messages(id INTEGER PRIMARY KEY,\n topic_id INTEGER, \"Data\" BLOB(3,4) NOT NULL, d)";
        assert_eq!(columns(sql), ["id", "topic_id", "data", "d"]);
        assert!(columns("CREATE TABLE x").is_empty());
    }
}
