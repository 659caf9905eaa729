//! The assignment of most pairs and then of the least cost.

/// For each row its column, each to one at most: the most pairs that there can be, and among such assignments one of the least sum of costs.
/// `costs[row]` has the columns that the row may go to, each with its cost, 0 or more; `columns` is their number.
///
/// By augmenting along shortest paths (Jonker and Volgenant 1987), found by Bellman's and Ford's rule since steps back have costs below 0.
pub(super) fn least(costs: &[Vec<(usize, f64)>], columns: usize) -> Vec<Option<usize>> {
    let mut of_row: Vec<Option<usize>> = vec![None; costs.len()];
    let mut of_column: Vec<Option<usize>> = vec![None; columns];
    while let Some(path) = shortest(costs, &of_row, &of_column) {
        for (row, column) in path {
            of_row[row] = Some(column);
            of_column[column] = Some(row);
        }
    }
    of_row
}

/// Rounding is no gain.
const GAIN: f64 = 1e-12;

/// The pairs that the cheapest path from any row without a column to any column without a row sets, from its end on; none where there is no
/// such path.
fn shortest(
    costs: &[Vec<(usize, f64)>],
    of_row: &[Option<usize>],
    of_column: &[Option<usize>],
) -> Option<Vec<(usize, usize)>> {
    let mut to_row: Vec<f64> = of_row.iter().map(|column| if column.is_none() { 0.0 } else { f64::INFINITY }).collect();
    let mut to_column = vec![f64::INFINITY; of_column.len()];
    let mut from = vec![None; of_column.len()];
    // No shortest path visits a row twice.
    for _ in 0..=costs.len() {
        let mut changed = false;
        for (row, edges) in costs.iter().enumerate() {
            for (column, cost) in edges.iter().filter(|(column, _)| of_row[row] != Some(*column)) {
                let there = to_row[row] + cost;
                if there < to_column[*column] - GAIN {
                    to_column[*column] = there;
                    from[*column] = Some(row);
                    changed = true;
                    if let Some(taken) = of_column[*column] {
                        let given = costs[taken].iter().find(|(own, _)| own == column).map_or(0.0, |(_, cost)| *cost);
                        to_row[taken] = there - given;
                    }
                }
            }
        }
        if !changed {
            break;
        }
    }
    let free = (0..of_column.len()).filter(|column| of_column[*column].is_none() && to_column[*column].is_finite());
    let mut column = free.min_by(|a, b| to_column[*a].total_cmp(&to_column[*b]))?;
    let mut path = Vec::new();
    while let Some(row) = from[column] {
        path.push((row, column));
        match of_row[row] {
            Some(before) => column = before,
            None => return Some(path),
        }
    }
    None
}
