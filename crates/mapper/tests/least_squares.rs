//! The oracle of the reconciliation: Eq. (20) under Eqs. (18) and (19) as a dense linear system.

use grid::GridSpec;
use mapper::{Joint, Lateral, Moments, PairwiseGrid, Prior, RayPosterior, Reconciliation};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// One conflicting posterior `P*` of the pair of cells (a, b).
#[derive(Debug, Clone)]
struct Claim {
    a: usize,
    b: usize,
    joint: Joint,
    weight: f64,
}

/// Minimises the weighted sum of squares over the claims by Lagrange's method: unknown are the four joint
/// probabilities of every pair named by a claim, `P(e_a, e_b)` in the order EE, EF, FE, FF.
fn kkt(claims: &[Claim]) -> Vec<((usize, usize), Joint)> {
    let mut edges: Vec<(usize, usize)> = claims.iter().map(|c| (c.a, c.b)).collect();
    edges.sort_unstable();
    edges.dedup();
    let column = |edge: (usize, usize)| 4 * edges.binary_search(&edge).expect("known edge");
    let mut constraints: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
    for &edge in &edges {
        constraints.push(((0..4).map(|s| (column(edge) + s, 1.0)).collect(), 1.0)); // (18)
    }
    // (19): all pairs that share a cell give it the same marginal.
    let marginal = |edge: (usize, usize), cell: usize, sign: f64| {
        let states = if edge.0 == cell { [0, 1] } else { [0, 2] };
        states.map(|s| (column(edge) + s, sign))
    };
    let mut first_of = std::collections::BTreeMap::new();
    for &edge in &edges {
        for cell in [edge.0, edge.1] {
            if let Some(&other) = first_of.get(&cell) {
                constraints.push(([marginal(edge, cell, 1.0), marginal(other, cell, -1.0)].concat(), 0.0));
            } else {
                first_of.insert(cell, edge);
            }
        }
    }
    let n = 4 * edges.len();
    let size = n + constraints.len();
    let mut matrix = DMatrix::<f64>::zeros(size, size);
    let mut right = DVector::<f64>::zeros(size);
    for claim in claims {
        let base = column((claim.a, claim.b));
        let Joint { ee, ef, fe, ff } = claim.joint;
        for (s, p) in [ee, ef, fe, ff].into_iter().enumerate() {
            matrix[(base + s, base + s)] += 2.0 * claim.weight;
            right[base + s] += 2.0 * claim.weight * p;
        }
    }
    for (row, (terms, value)) in constraints.iter().enumerate() {
        for &(col, coefficient) in terms {
            matrix[(n + row, col)] = coefficient;
            matrix[(col, n + row)] = coefficient;
        }
        right[n + row] = *value;
    }
    let solution = matrix.full_piv_lu().solve(&right).expect("the constraints are independent");
    edges
        .iter()
        .map(|&edge| {
            let base = column(edge);
            let [ee, ef, fe, ff] = [0, 1, 2, 3].map(|s| solution[base + s]);
            (edge, Joint { ee, ef, fe, ff })
        })
        .collect()
}

/// A small grid and 4-connected walks over it with a joint for each step.
#[derive(Debug, Clone)]
struct Walks {
    spec: GridSpec,
    walks: Vec<(Vec<usize>, Vec<Joint>)>,
}

fn walks() -> impl Strategy<Value = Walks> {
    let spec = (1usize..=5, 1usize..=4).prop_filter("some edge", |(w, h)| w * h > 1);
    spec.prop_flat_map(|(width, height)| {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height };
        walks_over(spec).prop_map(move |walks| Walks { spec, walks })
    })
}

/// Joints are nearly independent, so that no clamp acts and least squares alone is compared.
fn walks_over(spec: GridSpec) -> impl Strategy<Value = Vec<(Vec<usize>, Vec<Joint>)>> {
    let joint = (0.3f64..0.7, 0.3f64..0.7, -0.05f64..0.05).prop_map(|(p, q, d)| Joint::new(p, q, p * q + d));
    let walk = (0..spec.width, 0..spec.height, prop::collection::vec((any::<bool>(), joint), 1..6)).prop_map(
        move |(x, y, steps)| {
            let (mut column, mut row) = (x, y);
            let mut cells = vec![spec.index(column, row)];
            let mut joints = Vec::new();
            for (right, joint) in steps {
                if right && column + 1 < spec.width {
                    column += 1;
                } else if row + 1 < spec.height {
                    row += 1;
                } else {
                    break;
                }
                cells.push(spec.index(column, row));
                joints.push(joint);
            }
            (cells, joints)
        },
    );
    prop::collection::vec(walk, 1..5).prop_filter("some pair", |w| w.iter().any(|(_, joints)| !joints.is_empty()))
}

fn unseen(spec: GridSpec) -> PairwiseGrid {
    PairwiseGrid::prior(spec, &Prior { occupancy: 0.5, correlation: 0.1, ..Prior::default() })
}

fn reconciled(walks: &Walks, rule: Reconciliation) -> PairwiseGrid {
    after(walks, |pairs, moments| pairs.reconcile(moments, rule))
}

/// The unseen map after the given step.
fn after(Walks { spec, walks }: &Walks, step: impl Fn(&mut PairwiseGrid, &mut Moments)) -> PairwiseGrid {
    let mut pairs = unseen(*spec);
    let mut moments = Moments::new(*spec);
    for (cells, joints) in walks.iter().filter(|(_, joints)| !joints.is_empty()) {
        let mut posterior = RayPosterior::default();
        posterior.pairs.clone_from(joints);
        moments.add(cells, &posterior);
    }
    step(&mut pairs, &mut moments);
    pairs.check().expect("valid");
    pairs
}

fn claims(Walks { walks, .. }: &Walks) -> Vec<Claim> {
    let steps = walks.iter().flat_map(|(cells, joints)| cells.windows(2).zip(joints));
    steps.map(|(cells, &joint)| Claim { a: cells[0], b: cells[1], joint, weight: 1.0 }).collect()
}

fn compare(pairs: &PairwiseGrid, oracle: &[((usize, usize), Joint)]) -> Result<(), TestCaseError> {
    for ((a, b), expected) in oracle {
        let got = pairs.joint(*a, *b);
        for (g, e) in [(got.ee, expected.ee), (got.ef, expected.ef), (got.fe, expected.fe), (got.ff, expected.ff)] {
            prop_assert!((g - e).abs() < 1e-12, "cells {a} and {b}: {g} against {e}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn touched_edges_solve_the_constrained_least_squares(walks in walks()) {
        compare(&reconciled(&walks, Reconciliation::Touched), &kkt(&claims(&walks)))?;
    }

    #[test]
    fn all_edges_solve_it_with_the_joints_of_silent_edges(walks in walks()) {
        let mut all = claims(&walks);
        let unseen = unseen(walks.spec);
        for cell in 0..walks.spec.cells() {
            for n in walks.spec.neighbours(cell).filter(|n| n.cell > cell) {
                if !all.iter().any(|c| (c.a, c.b) == (cell, n.cell)) {
                    all.push(Claim { a: cell, b: n.cell, joint: unseen.joint(cell, n.cell), weight: 1.0 });
                }
            }
        }
        compare(&reconciled(&walks, Reconciliation::AllEdges), &kkt(&all))?;
    }

    #[test]
    fn edges_that_learn_from_their_ends_solve_it_with_the_joints_of_jeffreys_rule(
        walks in walks(), learnt in 0.0f64..4.0, before in 0.1f64..4.0,
    ) {
        let unseen = unseen(walks.spec);
        let mut all = claims(&walks);
        // What rays say of a cell, or what was known of it.
        let said = |cell: usize| {
            let of = |claim: &Claim| match cell {
                c if c == claim.a => Some(claim.joint.first()),
                c if c == claim.b => Some(claim.joint.second()),
                _ => None,
            };
            let all: Vec<f64> = claims(&walks).iter().filter_map(of).collect();
            if all.is_empty() { unseen.marginals()[cell] } else { all.iter().sum::<f64>() / all.len() as f64 }
        };
        for cell in 0..walks.spec.cells() {
            for n in walks.spec.neighbours(cell).filter(|n| n.cell > cell) {
                if claims(&walks).iter().any(|c| (c.a, c.b) == (cell, n.cell)) {
                    continue;
                }
                let old = unseen.joint(cell, n.cell);
                let [p, q] = [old.first(), old.second()];
                let ([e, f], [g, h]) = ([said(cell) / p, (1.0 - said(cell)) / (1.0 - p)], [said(n.cell) / q, (1.0 - said(n.cell)) / (1.0 - q)]);
                let here = Joint { ee: old.ee * e, ef: old.ef * e, fe: old.fe * f, ff: old.ff * f };
                let there = Joint { ee: old.ee * g, ef: old.ef * h, fe: old.fe * g, ff: old.ff * h };
                for (joint, weight) in [(here, learnt), (there, learnt), (old, before)] {
                    all.push(Claim { a: cell, b: n.cell, joint, weight });
                }
            }
        }
        let lateral = Lateral { learnt, before, ..Lateral::default() };
        compare(&after(&walks, |pairs, moments| pairs.reconcile_laterally(moments, &lateral, 1)), &kkt(&all))?;
    }

    #[test]
    fn silent_edges_keep_their_correlation(walks in walks()) {
        let pairs = reconciled(&walks, Reconciliation::Touched);
        let on_rays = claims(&walks);
        for cell in 0..walks.spec.cells() {
            for n in walks.spec.neighbours(cell).filter(|n| n.cell > cell) {
                if !on_rays.iter().any(|c| (c.a, c.b) == (cell, n.cell)) {
                    let joint = pairs.joint(cell, n.cell);
                    let (p, q) = (joint.first(), joint.second());
                    let c = (joint.ee - p * q) / (p * (1.0 - p) * q * (1.0 - q)).sqrt();
                    prop_assert!((c - 0.1).abs() < 1e-12, "{c}");
                }
            }
        }
    }
}
