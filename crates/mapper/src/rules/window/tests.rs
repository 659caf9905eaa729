use std::sync::Arc;

use grid::GridSpec;
use proptest::prelude::*;
use sensor::{Laser, Pose, SensorModel, Stereo};

use super::*;
use crate::ray::likelihood::RayLikelihood;
use crate::ray::worth::{Explained, Worth};
use crate::rules::gibbs::field::{self, BlockField};
use crate::rules::window::chains::Maps;
use crate::rules::window::rays::Rays;

/// Cells of a ray, nearest first, with what it is worth by the first occupied one, and by none.
type Ray = (Vec<usize>, Vec<f32>, f32);

const GRID: GridSpec = GridSpec { cell_m: 0.5, origin_m: [0.0; 2], width: 4, height: 3 };

/// Rays along random cells: what judges a map does not ask whether they lie on a line.
fn moments() -> impl Strategy<Value = Vec<Vec<Ray>>> {
    let cells = Just((0..GRID.cells()).collect::<Vec<_>>()).prop_shuffle();
    let ray = (cells, 1usize..8, prop::collection::vec(-9.0f32..0.0, 8), -9.0f32..0.0)
        .prop_map(|(cells, length, log, none)| (cells[..length].to_vec(), log[..length].to_vec(), none));
    prop::collection::vec(prop::collection::vec(ray, 1..5), 1..5)
}

fn moment(rays: &[Ray]) -> Moment {
    let mut moment = Moment::default();
    rays.iter().for_each(|(cells, log, none)| moment.push(cells, log.iter().copied(), *none));
    moment
}

fn field() -> BlockField {
    BlockField::fitted(0.05).scaled(0.5).shifted(-0.2)
}

/// Log posterior of a map up to a constant, nats, block by block and ray by ray.
fn log_posterior(map: &[bool], rays: &[&Ray], condensed: &[f64]) -> f64 {
    let field = field();
    let blocks: f64 = field::patterns(&GRID, map).iter().map(|&pattern| field.weight(pattern.into())).sum();
    let worth = |(cells, log, none): &&Ray| {
        f64::from(cells.iter().position(|&cell| map[cell]).map_or(*none, |first| log[first]))
    };
    let told: f64 = map.iter().zip(condensed).map(|(&occupied, told)| if occupied { *told } else { 0.0 }).sum();
    blocks + rays.iter().map(worth).sum::<f64>() + told
}

fn flipped(map: &[bool], cell: usize) -> Vec<bool> {
    let mut map = map.to_vec();
    map[cell] ^= true;
    map
}

/// A map from the bits of all.
fn map_of(maps: &[Maps], map: usize) -> Vec<bool> {
    maps.iter().map(|maps| maps >> map & 1 == 1).collect()
}

/// The rays of a target through a cell.
fn through(target: &Target, cell: usize) -> Vec<Crossing> {
    let mut crossings = Vec::new();
    target.rays.gather(cell, &mut crossings);
    crossings
}

/// Maps in which cells are occupied, by bits, and the rays of a target followed.
fn chains(target: &Target, occupied: &[Maps]) -> Chains {
    let mut chains = Chains::free(GRID.cells());
    let unseen = Target::new(GRID, &field());
    occupied.iter().enumerate().for_each(|(cell, &maps)| chains.flip(&unseen, cell, &[], maps));
    chains.follow(&target.rays);
    chains
}

proptest! {
    /// Every map against the log posterior counted anew, after scans have come and gone and cells have been flipped between them.
    #[test]
    fn changes_are_worth_what_the_posterior_says(
        moments in moments(), flips in prop::collection::vec((0..GRID.cells(), any::<Maps>()), 0..30),
        condensed in prop::collection::vec(-3.0f64..3.0, GRID.cells()), scans in 1usize..4, begins: u32,
    ) {
        let mut target = Target::new(GRID, &field());
        target.rays = Rays::numbered_from(GRID.cells(), begins);
        target.condensed.clone_from(&condensed);
        let mut chains = Chains::free(GRID.cells());
        let mut occupied = vec![0; GRID.cells()];
        for (number, rays) in moments.iter().enumerate() {
            if target.rays.moments() == scans {
                let gone = target.rays.leave().expect("one is there").rays();
                chains.forget(gone);
            }
            target.rays.add(moment(rays));
            chains.follow(&target.rays);
            for &(cell, which) in flips.iter().skip(number).step_by(moments.len()) {
                chains.flip(&target, cell, &through(&target, cell), which);
                occupied[cell] ^= which;
            }
        }
        let kept: Vec<&Ray> = moments[moments.len().saturating_sub(scans)..].iter().flatten().collect();
        prop_assert_eq!(target.rays.count(), kept.len());
        prop_assert!((0..GRID.cells()).all(|cell| chains.occupied(cell) == occupied[cell]));
        for l in 0..LANES {
            let map = map_of(&occupied, l);
            let now = log_posterior(&map, &kept, &condensed);
            for cell in 0..GRID.cells() {
                let gain = log_posterior(&flipped(&map, cell), &kept, &condensed) - now;
                let found = f64::from(chains.log_odds(&target, cell, &through(&target, cell))[l]);
                prop_assert!((found - if map[cell] { -gain } else { gain }).abs() < 1e-4, "cell {cell}: {found}, {gain}");
            }
        }
    }

    /// What a scan is condensed to is what the flip of each cell gains on its rays, in the mean over all maps at the times at which it was
    /// looked.
    #[test]
    fn what_leaves_says_what_flips_gained(
        rays in moments(), looks in prop::collection::vec(prop::collection::vec(any::<Maps>(), GRID.cells()), 1..4),
    ) {
        let rays = &rays[0];
        let mut target = Target::new(GRID, &field());
        target.rays.add(moment(rays));
        for occupied in &looks {
            let chains = chains(&target, occupied);
            target.rays.look(chains.nearest(), 1, 1);
        }
        let mut found = vec![0.0; GRID.cells()];
        target.rays.leave().expect("one").gains().for_each(|(cell, gain)| found[cell] += f64::from(gain));
        let of_rays = |map: &[bool]| {
            let worth = |(cells, log, none): &Ray| cells.iter().position(|&cell| map[cell]).map_or(*none, |first| log[first]);
            rays.iter().map(|ray| f64::from(worth(ray))).sum::<f64>()
        };
        let maps: Vec<Vec<bool>> = looks.iter().flat_map(|occupied| (0..LANES).map(|l| map_of(occupied, l))).collect();
        for (cell, found) in found.iter().enumerate() {
            let gain = |map: &Vec<bool>| {
                let with = |state: bool| {
                    let mut map = map.clone();
                    map[cell] = state;
                    of_rays(&map)
                };
                with(true) - with(false)
            };
            let expected = maps.iter().map(gain).sum::<f64>() / maps.len() as f64;
            prop_assert!((found - expected).abs() < 1e-4, "cell {cell}: {found}, {expected}");
        }
    }

    /// Against the whole ray in double precision, up to the border. Cells that are not kept are worth what none is.
    #[test]
    fn a_ray_is_worth_what_the_kernel_says(
        reading in 0.5f64..50.0, x_m in 0.1f64..1.9, y_m in 0.1f64..1.4, theta_rad in 0.0f64..std::f64::consts::TAU, others in 0usize..9,
        weight in 0.1f64..1.0, leak in 0.0f64..0.5, stereo: bool,
    ) {
        let sensor: Arc<dyn SensorModel> = if stereo { Arc::new(Stereo::default()) } else { Arc::new(Laser::default()) };
        let reading = if stereo { reading } else { 0.05 * reading };
        let (rule, onset) = (Reading { weight, leak }, 0.02);
        let bearings_rad: Vec<f64> = (0..=others).map(|k| 0.1 * k as f64).collect();
        let scan = Scan {
            sensor: 0, time_s: 0.0, pose: Pose { x_m, y_m, theta_rad }, readings: vec![Some(reading); bearings_rad.len()], bearings_rad,
        };
        let mut moment = Moment::default();
        Reader::default().read(&scan, &GRID, &*sensor, (&rule, onset), &mut moment);
        let mut rays = Rays::new(GRID.cells());
        rays.add(moment);
        prop_assert_eq!(rays.count(), others + 1);
        for (place, ray) in scan.rays().enumerate() {
            let mut whole = RayLikelihood::default();
            prop_assert!(whole.take(&ray, &GRID, &*sensor, onset));
            let RayLikelihood { line, likelihood, none } = &whole;
            let explained = Explained { line, direction: ray.direction, likelihood, none: *none };
            let mut expected = Vec::new();
            let none = Worth::default().of(&rule, &GRID, &explained, 0.0, &mut expected);
            let cells = rays.cells(place);
            prop_assert!(line.cells().iter().map(|&cell| cell as u32).take(cells.len()).eq(cells.iter().copied()));
            for (step, expected) in expected.iter().chain([&none]).enumerate() {
                let found = f64::from(rays.value(place, step.min(cells.len())));
                prop_assert!((found - expected).abs() < 2e-3 * expected.abs().max(1.0), "ray {place}, step {step}: {found}, {expected}");
            }
        }
    }
}

#[test]
fn a_ray_is_kept_no_farther_than_its_reading_tells_cells_apart() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 200, height: 1 };
    let scan = Scan {
        sensor: 0,
        time_s: 0.0,
        pose: Pose { x_m: 0.025, y_m: 0.025, theta_rad: 0.0 },
        bearings_rad: vec![0.0],
        readings: vec![Some(4.0)],
    };
    let (mut moment, rule) = (Moment::default(), Reading { weight: 0.5, leak: 0.1 });
    Reader::default().read(&scan, &grid, &Laser::default(), (&rule, 0.02), &mut moment);
    let mut rays = Rays::new(grid.cells());
    rays.add(moment);
    assert!((82..100).contains(&rays.cells(0).len()), "{} cells", rays.cells(0).len());
}

/// All 2^12 maps and rays that cross: with every cell in doubt, means of draws are the marginals of the posterior.
#[test]
fn draws_are_of_the_posterior() {
    let rays: Vec<Ray> = vec![
        (vec![0, 1, 2, 3], vec![-3.0, -0.5, -1.0, -2.0], -2.5),
        (vec![4, 5, 6, 7], vec![-2.0, -2.0, 0.0, -1.0], -2.0),
        (vec![8, 4, 0], vec![-1.0, -2.0, 0.0], -3.0),
        (vec![11, 7, 3], vec![-2.5, -2.0, -2.0], 0.0),
        (vec![9, 5, 1], vec![-1.5, -0.2, -0.3], -2.5),
        (vec![10, 6, 2], vec![-3.0, -1.0, -0.5], -0.5),
    ];
    let mut window = VisibilityWindow::new(
        &Model::new(GRID, Arc::new(Stereo::default())),
        FixedLag { share: 1.0, draws: f64::INFINITY, ..FixedLag::TUNED },
    );
    window.target = Target::new(GRID, &field());
    window.target.rays.add(moment(&rays));
    window.chains.follow(&window.target.rays);
    let cells: Vec<u32> = (0..GRID.cells() as u32).collect();
    (0..200).for_each(|_| draw_all(&mut window, &cells));
    window.draws.fill(0);
    (0..10_000).for_each(|_| draw_all(&mut window, &cells));
    let kept: Vec<&Ray> = rays.iter().collect();
    let (mut total, mut occupied) = (0.0, vec![0.0; GRID.cells()]);
    for states in 0..1usize << GRID.cells() {
        let map: Vec<bool> = (0..GRID.cells()).map(|cell| states >> cell & 1 == 1).collect();
        let weight = log_posterior(&map, &kept, &vec![0.0; GRID.cells()]).exp();
        total += weight;
        occupied.iter_mut().zip(&map).for_each(|(sum, &on)| *sum += if on { weight } else { 0.0 });
    }
    let exact: Vec<f64> = occupied.iter().map(|sum| sum / total).collect();
    for (cell, (p, exact)) in window.drawn.iter().zip(&exact).enumerate() {
        assert!((p - exact).abs() < 0.01, "cell {cell}: {p}, exactly {exact}");
    }
    let [least, most] = exact.iter().fold([1.0f64, 0.0], |[least, most], p| [least.min(*p), most.max(*p)]);
    assert!(least < 0.2 && most > 0.4, "the readings say something: {least} to {most}");
}

/// Looks round a room of 2 m x 1.5 m from a few places.
fn drive() -> Vec<Scan> {
    let bearings_rad: Vec<f64> = (0..24).map(|k| 0.26 * f64::from(k)).collect();
    let scan = |number: usize| Scan {
        sensor: 0,
        time_s: 0.2 * number as f64,
        pose: Pose { x_m: 0.6 + 0.03 * number as f64, y_m: 0.7, theta_rad: 0.1 * number as f64 },
        readings: (0..24).map(|k| Some(12.0 + ((7 * k + 3 * number) % 11) as f64)).collect(),
        bearings_rad: bearings_rad.clone(),
    };
    (0..9).map(scan).collect()
}

fn model() -> Model {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 30 };
    Model::new(grid, Arc::new(Stereo::default()))
}

#[test]
fn the_order_of_rays_within_a_scan_does_not_matter() {
    let [mut one, mut other] =
        [(); 2].map(|()| VisibilityWindow::new(&model(), FixedLag { share: 1.0, ..FixedLag::TUNED }));
    for scan in drive() {
        one.integrate(&scan);
        let (bearings_rad, readings) =
            scan.bearings_rad.iter().zip(&scan.readings).rev().map(|(b, r)| (*b, *r)).unzip();
        other.integrate(&Scan { bearings_rad, readings, ..scan });
    }
    assert_eq!(one.occupancy(), other.occupancy());
    let most = one.occupancy().values().iter().copied().fold(0.0, f64::max);
    assert!(most > 2.0 * model().prior.marginal(), "something was found: {most}");
}

#[test]
fn a_share_of_nothing_is_the_map_of_pairs() {
    let mut window = VisibilityWindow::new(&model(), FixedLag { share: 0.0, ..FixedLag::TUNED });
    let mut pairs = FastVisibility::lateral(&model(), Lateral::default());
    for scan in drive() {
        window.integrate(&scan);
        pairs.integrate(&scan);
    }
    for (cell, (found, expected)) in window.occupancy().values().iter().zip(pairs.occupancy().values()).enumerate() {
        assert!((found - expected).abs() < 1e-15, "cell {cell}");
        assert!((window.occupied(cell) - found).abs() < 1e-15, "cell {cell} by itself");
    }
}

#[test]
fn no_more_scans_are_held_than_the_window_has() {
    let mut window = VisibilityWindow::new(&model(), FixedLag { scans: 3, ..FixedLag::TUNED });
    for (number, scan) in drive().iter().enumerate() {
        window.integrate(scan);
        assert_eq!(window.target.rays.moments(), 3.min(number + 1));
        assert_eq!(window.chains.nearest().len(), window.target.rays.count());
        let through: usize = (0..model().grid.cells()).map(|cell| window.target.rays.crossings(cell)).sum();
        let cells: usize = (0..window.target.rays.count()).map(|place| window.target.rays.cells(place).len()).sum();
        assert_eq!(through, cells);
        // A ray that has come to the window is followed as one that has always been there.
        let mut anew = Chains::free(model().grid.cells());
        let unseen = Target::new(model().grid, &field());
        (0..model().grid.cells()).for_each(|cell| anew.flip(&unseen, cell, &[], window.chains.occupied(cell)));
        anew.follow(&window.target.rays);
        assert!(anew.nearest() == window.chains.nearest());
    }
    assert!(
        window.target.condensed.iter().any(|told| *told > 0.5)
            && window.target.condensed.iter().any(|told| *told < -0.5)
    );
}
