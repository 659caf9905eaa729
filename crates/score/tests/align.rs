//! Known shifts and turns are found again.

use grid::{Frame, GridSpec, Raster};
use proptest::prelude::*;
use score::{AlignBound, Alignment, align};

const CELL_M: f64 = 0.05;
const BOUND: AlignBound = AlignBound { shift_m: 0.4, turn_rad: 0.09 };

/// A box: middle (m), half sizes (m), angle (rad).
type Block = ([f64; 2], [f64; 2], f64);

/// A room of 8 m x 6 m about the origin with four walls and some boxes.
fn blocks(boxes: Vec<Block>) -> Vec<Block> {
    let walls =
        [([0.0, -3.0], [4.1, 0.1]), ([0.0, 3.0], [4.1, 0.1]), ([-4.0, 0.0], [0.1, 3.1]), ([4.0, 0.0], [0.1, 3.1])];
    walls.into_iter().map(|(at, half)| (at, half, 0.0)).chain(boxes).collect()
}

/// Share of a cell that is covered, by 5 x 5 points: cells of any frame, so that no grid is at an advantage.
fn covered(frame: &Frame, blocks: &[Block]) -> Raster<f32> {
    let inside = |[x, y]: [f64; 2]| {
        blocks.iter().any(|(at, half, angle)| {
            let (sin, cos) = angle.sin_cos();
            let [dx, dy] = [x - at[0], y - at[1]];
            (cos * dx + sin * dy).abs() <= half[0] && (-sin * dx + cos * dy).abs() <= half[1]
        })
    };
    let share = |cell: usize| {
        let (column, row) = frame.spec.column_row(cell);
        let points =
            (0..25).map(|k| [column as f64 + 0.1 + 0.2 * f64::from(k % 5), row as f64 + 0.1 + 0.2 * f64::from(k / 5)]);
        points.filter(|point| inside(frame.to_world(*point))).count() as f32 / 25.0
    };
    Raster::new(frame.spec, (0..frame.spec.cells()).map(share).collect())
}

fn grid(cell_m: f64) -> Frame {
    let (width, height) = ((8.6 / cell_m) as usize, (6.6 / cell_m) as usize);
    Frame::straight(GridSpec { cell_m, origin_m: [-4.3, -3.3], width, height })
}

/// The truth of a world: half covered is occupied.
fn truth(frame: &Frame, blocks: &[Block]) -> Raster<Option<bool>> {
    covered(frame, blocks).map(|share| Some(*share >= 0.5))
}

/// What the alignment must be for a map that was moved about the middle of the truth.
fn found(alignment: &Alignment, shift_m: [f64; 2], turn_rad: f64) -> bool {
    let off = |k: usize| (alignment.shift_m[k] - shift_m[k]).abs() / CELL_M;
    off(0) < 0.1 && off(1) < 0.1 && (alignment.turn_rad - turn_rad).abs().to_degrees() < 0.1
}

/// The way back from a shift after a turn.
fn back(shift_m: [f64; 2], turn_rad: f64) -> [f64; 2] {
    let (sin, cos) = (-turn_rad).sin_cos();
    [-(cos * shift_m[0] - sin * shift_m[1]), -(sin * shift_m[0] + cos * shift_m[1])]
}

fn some_boxes() -> Vec<Block> {
    blocks(vec![
        ([-2.0, 1.0], [0.4, 0.2], 0.4),
        ([1.5, -1.2], [0.3, 0.5], 1.1),
        ([2.5, 1.8], [0.25, 0.25], 0.7),
        ([-1.2, -1.9], [0.6, 0.15], -0.3),
    ])
}

#[test]
fn cells_that_are_the_truths_own_but_said_to_lie_elsewhere() {
    let (onto, blocks) = (grid(CELL_M), some_boxes());
    let truth = truth(&onto, &blocks);
    let map = truth.map(|cell| cell.map(|occupied| f32::from(u8::from(occupied))));
    let shift = [0.37 * CELL_M, -0.37 * CELL_M];
    let turn = 1.5_f64.to_radians();
    let said = onto.moved(onto.middle(), shift, turn);
    let alignment = align((&map, &said), (&truth, &onto), &BOUND).expect("memory");
    assert!(found(&alignment, back(shift, turn), -turn) && !alignment.at_bound, "{alignment:?}");
    let home = alignment.of(&said);
    assert!((0..2).all(|k| (home.spec.origin_m[k] - onto.spec.origin_m[k]).abs() < 0.1 * CELL_M), "{home:?}");
    let straight = align((&map, &onto), (&truth, &onto), &BOUND).expect("memory");
    assert!(found(&straight, [0.0; 2], 0.0));
    // A shift alone, with no turn to find it.
    let said = onto.moved(onto.middle(), shift, 0.0);
    let alignment = align((&map, &said), (&truth, &onto), &AlignBound { turn_rad: 0.0, ..BOUND }).expect("memory");
    assert!(found(&alignment, back(shift, 0.0), 0.0) && alignment.turn_rad.abs() <= 0.0, "{alignment:?}");
}

#[test]
fn what_nothing_says_the_place_of_stays() {
    let onto = grid(0.2);
    for occupied in [None, Some(false), Some(true)] {
        let truth = Raster::filled(onto.spec, occupied);
        let map = Raster::filled(onto.spec, Some(0.1_f32));
        let alignment = align((&map, &onto), (&truth, &onto), &BOUND).expect("memory");
        assert_eq!((alignment.shift_m, alignment.turn_rad), ([0.0; 2], 0.0), "{occupied:?}");
    }
}

#[test]
fn beyond_the_bound_is_told() {
    let (onto, blocks) = (grid(CELL_M), some_boxes());
    let truth = truth(&onto, &blocks);
    let map = truth.map(|cell| cell.map(|occupied| f32::from(u8::from(occupied))));
    let bound = AlignBound { shift_m: 0.1, turn_rad: 0.0 };
    let said = onto.moved(onto.middle(), [0.15, 0.0], 0.0);
    let alignment = align((&map, &said), (&truth, &onto), &bound).expect("memory");
    assert!(alignment.at_bound && alignment.shift_m[0] < -0.09, "{alignment:?}");
    assert!(alignment.shift_m[0].hypot(alignment.shift_m[1]) <= 0.1 + 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// The map is another raster of the same world, in cells of its own; it may know surfaces alone, not what is within.
    #[test]
    fn any_shift_and_turn_within_the_bound(
        boxes in prop::collection::vec(([-3.5_f64..3.5, -2.5..2.5], [0.15_f64..0.6, 0.15..0.6], -1.5_f64..1.5), 4..9),
        shift in [-0.25_f64..0.25, -0.25..0.25],
        turn in -0.08_f64..0.08,
        offset in [0.0_f64..1.0, 0.0..1.0],
        finer in prop::sample::select(vec![1.0_f64, 2.0]),
        hidden in any::<bool>(),
    ) {
        let (onto, blocks) = (grid(CELL_M), blocks(boxes));
        let truth = truth(&onto, &blocks);
        let cell_m = CELL_M / finer;
        let own = grid(cell_m).moved([0.0; 2], offset.map(|share| share * cell_m), 0.0);
        let shares = covered(&own, &blocks);
        let map = Raster::new(own.spec, (0..own.spec.cells()).map(|cell| {
            let inside = std::iter::once(cell).chain(own.spec.neighbours(cell).map(|n| n.cell)).all(|cell| shares[cell] > 0.99);
            (!hidden || !inside).then_some(0.1 + 0.8 * shares[cell])
        }).collect());
        let said = own.moved(onto.middle(), shift, turn);
        let alignment = align((&map, &said), (&truth, &onto), &BOUND).expect("memory");
        prop_assert!(found(&alignment, back(shift, turn), -turn), "{:?}, not {:?} {}; hidden {hidden} finer {finer}", alignment, back(shift, turn), -turn);
    }
}
