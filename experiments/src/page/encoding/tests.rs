use grid::{GridSpec, Raster};
use sensor::Pose;

use super::*;
use crate::page::Moment;
use crate::worlds::film::{in_fine_steps, in_levels};
use crate::worlds::run::Stage;

/// A world of `width` x `height` cells whose maps move as real ones do: the cells in view of the robot
/// change by noise, the others stay.
fn world(name: &str, width: usize, height: usize, mappers: usize, moments: usize) -> ViewedWorld {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height };
    let mut state = 1u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
    };
    let in_view = |cell: usize, moment: usize| (cell % width + moment * 5) % width < width / 3;
    let moment = |k: usize| Moment {
        scans: 10 * (k + 1),
        parts: Some(Raster::filled(grid, Some(Region::Visible))),
        scenery: None,
    };
    let mut mapper = |number: usize| {
        let mut odds = vec![-2.2f64; grid.cells()];
        let mut frames: Vec<Frame> = Vec::new();
        for k in 0..moments {
            for (cell, odds) in odds.iter_mut().enumerate().filter(|(cell, _)| in_view(*cell, k)) {
                *odds += 2.0 * noise() - if cell % 9 == 0 { -0.5 } else { 0.5 };
            }
            let map = Raster::new(grid, odds.iter().map(|l| 1.0 / (1.0 + (-l).exp())).collect());
            frames.push(Frame {
                scans: 10 * (k + 1),
                levels: in_levels(&map, frames.last().map(|frame| &frame.levels)),
                fine: (k + 1 == moments).then(|| in_fine_steps(&map)),
                exact: vec![[Some(0.25), None, Some(1.0)]; Region::ALL.len()],
            });
        }
        Mapped { name: format!("mapper-{number}"), frames, scores: Vec::new(), known: None }
    };
    let scan = |k: usize| Scan {
        time_s: k as f64,
        pose: Pose::default(),
        bearings_rad: vec![-0.1, 0.0, 0.1],
        readings: vec![Some(2.0 + k as f64), None, Some(7.5)],
        ..Scan::default()
    };
    let scans = Scans { unit: ReadingUnit::Range, scans: (0..10 * moments).map(scan).collect(), truth: None };
    ViewedWorld {
        name: name.to_owned(),
        seed: Some(1),
        grid,
        prior: 0.1,
        robot_radius_m: 0.2,
        truth: Some(Raster::filled(grid, Some(false))),
        route_m: Vec::new(),
        scans: Some(scans),
        sensors: Vec::new(),
        moments: (0..moments).map(moment).collect(),
        stages: vec![Stage { name: "end".to_owned(), label: "at <last>".to_owned(), scans: 10 * moments }],
        regions: Vec::new(),
        metrics: Vec::new(),
        mappers: (0..mappers).map(&mut mapper).collect(),
    }
}

fn viewer(worlds: Vec<ViewedWorld>, budget: usize) -> Viewer {
    Viewer { worlds, budget }
}

#[test]
fn a_world_comes_back() {
    let made = world("w", 40, 30, 2, 5);
    let text = json(&viewer(vec![made.clone()], usize::MAX)).expect("fits");
    let worlds = decoded(&format!("<script id=\"viewer-data\">{text}</script>")).expect("whole");
    let back = &worlds[0];
    assert_eq!((back.name.as_str(), &back.moments), ("w", &vec![10, 20, 30, 40, 50]));
    assert_eq!(back.stages, [("end".to_owned(), 4)]);
    assert_eq!(back.truth, made.truth);
    assert_eq!(Some(&back.parts[2]), made.moments[2].parts.as_ref());
    assert_eq!(back.readings[..3], [Some(2.0), None, Some(7.5)]);
    for (mapper, back) in made.mappers.iter().zip(&back.mappers) {
        let last = mapper.frames.last().expect("one");
        for (frame, map) in mapper.frames.iter().zip(&back.maps) {
            let fine = frame.fine.as_ref().map(|fine| fine.map(|step| f64::from(*step) * FINE));
            let log_odds = fine.unwrap_or_else(|| frame.levels.map(|level| levels().log_odds[usize::from(*level)]));
            let off = map.values().iter().zip(log_odds.values()).map(|(p, l)| (p - 1.0 / (1.0 + (-l).exp())).abs());
            assert!(off.fold(0.0, f64::max) < 1e-12);
        }
        assert_eq!(back.exact[&("all".to_owned(), "retention".to_owned())], vec![Some(1.0); 5]);
        assert_eq!(back.exact[&("all".to_owned(), "brier".to_owned())], vec![None; 5]);
        let kept = frames(&frames_text(&mapper.frames), made.grid, &[false, false, false, false, true]).expect("whole");
        assert_eq!(kept.last(), Some(&(last.levels.clone(), last.fine.clone())));
        assert!(frames(&["no base64!".to_owned(), String::new()], made.grid, &[true]).is_none());
    }
    assert!(decoded("<p>a page without maps</p>").is_none());
}

#[test]
fn a_whole_comparison_fits_the_budget() {
    let worlds = ["corridor", "hall", "clutter", "rooms"].map(|name| world(name, 150, 120, 12, 26)).to_vec();
    let text = json(&viewer(worlds, crate::page::WORLDS_BYTES)).expect("fits, if with fewer moments");
    assert!(text.len() <= crate::page::WORLDS_BYTES, "{}", text.len());
    let value: Value = serde_json::from_str(&text).expect("JSON");
    for world in value["worlds"].as_array().expect("worlds") {
        let moments = world["moments"].as_array().expect("moments");
        assert!(moments.len() >= 4, "{} moments are no film", moments.len());
        assert_eq!(moments.last().expect("moments"), 260);
    }
}

#[test]
fn what_is_too_large_is_thinned_to_the_ends_of_stages_and_then_left_out() {
    let made = world("w", 40, 30, 1, 9);
    let count = |budget: usize| {
        let text = json(&viewer(vec![made.clone()], budget))?;
        assert!(text.len() <= budget && !text.contains('<'));
        let value: Value = serde_json::from_str(&text).expect("JSON");
        let world = &value["worlds"][0];
        let moments: Vec<u64> = (0..9).filter_map(|i| world["moments"][i].as_u64()).collect();
        assert_eq!(world["mappers"][0]["moments"].as_array().map(Vec::len), Some(moments.len()));
        assert_eq!(world["stages"][0]["moment"], moments.len() - 1);
        Some((value["thinned"].as_bool().expect("flag"), moments))
    };
    let all = json(&viewer(vec![made.clone()], usize::MAX)).expect("fits").len();
    assert_eq!(count(all), Some((false, (1..=9).map(|k| 10 * k).collect())));
    assert_eq!(count(all - 10), Some((true, vec![20, 40, 60, 80, 90])));
    let mut ends = made.clone();
    ends.moments.retain(|moment| moment.scans == 90);
    ends.mappers[0].frames.retain(|frame| frame.scans == 90);
    let least = json(&viewer(vec![ends], usize::MAX)).expect("fits").len();
    assert_eq!(count(least), Some((true, vec![90])));
    assert_eq!(count(least - 10), None);
}
