use super::document::MOST_POINTS;
use super::*;

fn parsed(text: &str) -> Result<FloorPlan, FloorPlanError> {
    FloorPlan::parse(text.as_bytes(), Path::new("p.json"))
}

#[test]
fn an_outline_is_read_in_either_direction_and_closed_or_not() {
    let expected = FloorPlan { outline_m: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]], partitions_m: vec![] };
    let texts = [
        "{\"verts\": [[0, 0], [4, 0], [4, 3.0]]}",
        "\u{feff}{\"id\": \"a\", \"room_num\": 1, \"verts\": [[0, 0], [4, 0], [4, 0], [4, 3], [0, 0]], \"bbox\": {\"min\": [0, 0]}}",
    ];
    for text in texts {
        assert_eq!(parsed(text).expect("a plan"), expected);
    }
    let back = parsed("{\"verts\": [[4, 3], [4, 0], [0, 0]]}").expect("a plan");
    assert_eq!(back, FloorPlan { outline_m: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]], partitions_m: vec![] });
    assert_eq!(back.extent_m(), [[0.0, 0.0], [4.0, 3.0]]);
}

#[test]
fn sides_there_and_back_are_walls_within() {
    let square = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]];
    // A wall from the upper side, one with a bend, one of two parts, one from a corner, one along a side.
    let plans: [(&str, &[[[f64; 2]; 2]]); 6] = [
        ("[[0,0],[6,0],[6,4],[3,4],[3,2],[3,4],[0,4]]", &[[[3.0, 2.0], [3.0, 4.0]]]),
        (
            "[[0,0],[6,0],[6,4],[3,4],[3,2],[4,2],[3,2],[3,4],[0,4]]",
            &[[[4.0, 2.0], [3.0, 2.0]], [[3.0, 2.0], [3.0, 4.0]]],
        ),
        (
            "[[0,0],[6,0],[6,4],[3,4],[3,3],[3,1],[3,2.5],[3,4],[0,4],[0,0]]",
            &[[[3.0, 1.0], [3.0, 2.5]], [[3.0, 2.5], [3.0, 3.0]], [[3.0, 3.0], [3.0, 4.0]]],
        ),
        ("[[0,0],[2,2],[0,0],[6,0],[6,4],[0,4]]", &[[[2.0, 2.0], [0.0, 0.0]]]),
        ("[[0,0],[6,0],[6,4],[0,4],[0,0],[0,2],[0,0]]", &[]),
        ("[[0,4],[3,4],[3,5],[3,4],[6,4],[6,0],[0,0]]", &[]), // a wall outside is none
    ];
    for (verts, partitions) in plans {
        let plan = parsed(&format!("{{\"verts\": {verts}}}")).expect(verts);
        assert!((plan.area_m2() - 24.0).abs() < 1e-9, "{verts}");
        assert!(square.iter().all(|corner| plan.outline_m.contains(corner)), "{:?}", plan.outline_m);
        let lengths = |walls: &[[[f64; 2]; 2]]| walls.iter().map(|[a, b]| distance(*a, *b)).sum::<f64>();
        assert_eq!(lengths(&plan.partitions_m).to_bits(), lengths(partitions).to_bits(), "{:?}", plan.partitions_m);
        assert!(partitions.iter().all(|wall| plan.partitions_m.contains(wall)), "{:?}", plan.partitions_m);
    }
}

#[test]
fn outlines_may_touch_themselves() {
    // Two squares that meet in a corner; corners half a millimetre apart.
    for (verts, area_m2) in [
        ("[[0,0],[3,0],[3,3],[6,3],[6,6],[3,6],[3,3],[0,3]]", 18.0),
        ("[[0,0],[2,0.0004],[4,-0.0003],[6,0],[6,4],[6,4.0005],[5.9995,4],[0,4],[0,0]]", 24.0),
    ] {
        let plan = parsed(&format!("{{\"verts\": {verts}}}")).expect(verts);
        assert!((plan.area_m2() - area_m2).abs() < 2e-3, "{verts}: {}", plan.area_m2());
    }
}

#[test]
fn pixels_are_taken_for_pixels() {
    let of = |side: f64| parsed(&format!("{{\"verts\": [[0, 0], [{side}, 0], [{side}, {side}], [0, {side}]]}}"));
    let warning = |side| of(side).expect("a plan").warning(Path::new("p.json")).map(|warning| warning.to_string());
    assert_eq!(warning(99.0), None);
    let expected = "p.json: `verts`: the outline holds 14400 m²: are the corners metres? divide them by the pixels per metre if not";
    assert_eq!(warning(120.0).as_deref(), Some(expected));
    let refusal = of(964.0).expect_err("too large").to_string();
    let expected = "p.json: `verts`: the outline holds 929296 m²: must be at most 100000 m²; are the corners pixels or millimetres? divide them, so that they are metres";
    assert_eq!(refusal, expected);
}

#[test]
fn what_is_no_plan_is_refused_with_its_place_and_reason() {
    let many = (0..=MOST_POINTS).map(|k| format!("[{k}, {}]", k * k % 1000)).collect::<Vec<_>>().join(", ");
    let many = format!("{{\"verts\": [{many}]}}");
    let deep = format!("{{\"a\": {}", "[".repeat(100_000));
    let cases = [
        ("", "p.json:1:1: EOF while parsing a value"),
        ("[1]", "p.json:1:1: invalid type: sequence, expected an object with `verts`"),
        ("{\"verts\": [[0, 0], [1, 0]", "p.json:1:25: EOF while parsing a list"),
        ("{\n\"verts\": [[0, 0],\n [1, NaN]]}", "p.json:3:6: expected value"),
        ("{\"verts\": [[0, 0], [1, 1e400]]}", "number out of range"),
        ("{\"verts\": [[0, 0],\n[1, 2e6],\n[0, 1]]}", "corner 2: coordinate 2e6: must lie within 1000000 m"),
        ("{\"verts\": [[0, 0], [1]]}", "invalid length 1"),
        ("{\"verts\": [[0, 0], [1, 2, 3]]}", "trailing characters"),
        ("{\"verts\": [[0, 0], [1, \"2\"]]}", "invalid type: string \"2\", expected f64"),
        ("{\"bbox\": 1}", "missing field `verts`"),
        ("{\"verts\": [], \"verts\": []}", "duplicate field `verts`"),
        ("{\"verts\": []}", "p.json: `verts`: 0 different corners: must be at least 3"),
        ("{\"verts\": [[0, 0], [1, 0], [1, 0], [0, 0]]}", "p.json: `verts`: 2 different corners"),
        ("{\"verts\": [[0, 0], [2, 0], [1, 0]]}", "the outline holds 0e0 m²; must hold an area"),
        ("{\"verts\": [[0, 0], [1, 1], [1, 0], [0, 1]]}", "the sides [0, 0] to [1, 1] and [1, 0] to [0, 1] cross"),
        (
            "{\"verts\": [[[0, 0], [6, 0], [6, 4]], [[2, 1], [3, 1], [3, 2]]]}",
            "`verts` holds 2 lists of corners: must be one outline; give the outer one",
        ),
        (&many, "corner 5001: must be at most 5000 corners"),
        (&deep, "EOF while parsing a list"),
    ];
    for (text, expected) in cases {
        let message = parsed(text).expect_err(expected).to_string();
        let placed =
            message.starts_with("p.json:1:") || message.starts_with("p.json:2:") || message.starts_with("p.json:3:");
        assert!(placed || message.starts_with("p.json: `verts`: "), "{message}");
        assert!(message.contains(expected) && !message.contains('\n'), "{message}\nlacks\n{expected}");
    }
    let missing = FloorPlan::load(Path::new("no/such.json")).expect_err("no file").to_string();
    assert!(missing.starts_with("no/such.json: cannot be read: "), "{missing}");
}
