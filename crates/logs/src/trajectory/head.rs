//! The first line of a trajectory, where it names the columns.

use super::clock::Unit;
use super::rows::Order;
use crate::fields::number;

/// What the names of columns say, if a line is names of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Names {
    pub(super) order: Option<Order>,
    pub(super) unit: Option<Unit>,
}

/// The names of columns in a line, such as `#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []`.
pub(super) fn names(text: &[u8]) -> Names {
    let text = String::from_utf8_lossy(text).to_ascii_lowercase();
    let place = |wanted: char| {
        let mut cells =
            text.split([',', ';', ' ', '\t', '#']).filter(|cell| !cell.is_empty() && !cell.starts_with('['));
        cells.position(|cell| {
            let cell = cell.split('[').next().unwrap_or_default();
            (cell.starts_with('q') || cell.starts_with("rot") || cell.starts_with("orient")) && cell.ends_with(wanted)
        })
    };
    let order = match (place('w'), place('x')) {
        (Some(w), Some(x)) => Some(if w < x { Order::ScalarFirst } else { Order::ScalarLast }),
        _ => None,
    };
    Names { order, unit: Unit::named(&text) }
}

/// Whether a line names columns: none of its fields is a number.
pub(super) fn is_head(text: &[u8]) -> bool {
    let fields = super::rows::fields(text);
    fields.len() >= 8 && fields.iter().all(|field| number(field).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_columns_give_order_and_unit() {
        for (text, order, unit) in [
            (
                "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z []",
                Some(Order::ScalarFirst),
                Some(Unit::Nanoseconds),
            ),
            ("# timestamp tx ty tz qx qy qz qw", Some(Order::ScalarLast), None),
            ("#timestamp,tx,ty,tz,qx,qy,qz,qw", Some(Order::ScalarLast), None),
            (
                "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []",
                Some(Order::ScalarFirst),
                None,
            ),
            ("# made by a program with quite some words", None, None),
        ] {
            assert_eq!(names(text.as_bytes()), Names { order, unit }, "{text}");
        }
    }
}
