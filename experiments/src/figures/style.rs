//! One colour and one shape for each mapper, the same in every picture.

use super::drawing::{Dashes, Stroke};
use super::ink::{Colour, FAINT};
use super::mark::Shape;

/// How a line and its points look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    pub stroke: Stroke,
    pub shape: Option<Shape>,
    /// Its name stands at the end of its line: its colour does not tell it from others.
    pub labelled: bool,
}

impl Style {
    /// A line in one piece.
    pub fn line(colour: Colour) -> Self {
        Self { stroke: colour.stroke(2.5), shape: None, labelled: false }
    }

    /// A line in one piece, with a sign at its points.
    pub fn marked(colour: Colour, shape: Shape) -> Self {
        Self { shape: Some(shape), ..Self::line(colour) }
    }

    /// A thin broken line.
    pub fn guide() -> Self {
        Self { stroke: FAINT.dashed(2.0), shape: None, labelled: false }
    }

    /// Signs without a line.
    pub fn broken(self, dashes: Dashes) -> Self {
        Self { stroke: Stroke { dashes, ..self.stroke }, ..self }
    }

    /// The style of the value number `k` of those that have no name of a mapper.
    pub fn numbered(k: usize) -> Self {
        let colours = super::ink::LINES;
        let style = Self::marked(colours[k % colours.len()], Shape::ALL[k % Shape::ALL.len()]);
        style.broken(if k < colours.len() { Dashes::Solid } else { Dashes::Dashed })
    }
}

/// At most so many lines of a picture are in colour.
pub const MOST_COLOURS: usize = 8;

const BLUE: Colour = Colour(0, 114, 178);
const SKY: Colour = Colour(70, 165, 220);
const RED: Colour = Colour(213, 94, 0);
const PURPLE: Colour = Colour(190, 95, 150);
const AMBER: Colour = Colour(225, 150, 0);
const GREEN: Colour = Colour(0, 150, 110);
const WINE: Colour = Colour(120, 30, 75);
const OLIVE: Colour = Colour(140, 140, 40);
const VIOLET: Colour = Colour(105, 55, 165);
const NAVY: Colour = Colour(0, 45, 95);
const GREY: Colour = Colour(130, 130, 130);

/// Those that stand for others first: where there are more than colours, the last ones are grey. Of a family all have
/// the same hue; hues are those of Okabe and Ito (2008) and of Tol (2021), for every eye.
const MAPPERS: [(&str, Colour, Shape, Dashes); 40] = [
    ("visibility", BLUE, Shape::Circle, Dashes::Solid),
    ("conventional", RED, Shape::Square, Dashes::Solid),
    ("log-odds-octomap", PURPLE, Shape::Diamond, Dashes::Solid),
    ("log-odds-cartographer", AMBER, Shape::Triangle, Dashes::Solid),
    ("independent", GREEN, Shape::Cross, Dashes::Solid),
    ("visibility-lateral", SKY, Shape::Star, Dashes::Solid),
    ("no-occlusion", WINE, Shape::Wedge, Dashes::Solid),
    ("mrf", VIOLET, Shape::Hourglass, Dashes::Solid),
    ("forward-em", OLIVE, Shape::Plus, Dashes::Solid),
    ("conventional-tuned", RED, Shape::Flag, Dashes::Dashed),
    ("visibility-printed", NAVY, Shape::Triangle, Dashes::Dashed),
    ("wavemap-tuned", GREEN, Shape::Diamond, Dashes::Dashed),
    ("tsdf-tuned", GREEN, Shape::Square, Dashes::Dashed),
    ("mrpt-widening-tuned", GREEN, Shape::Triangle, Dashes::Dashed),
    ("hit-count-tuned", AMBER, Shape::Square, Dashes::Dashed),
    ("conventional-cut", RED, Shape::Wedge, Dashes::Dotted),
    ("octomap-cut", PURPLE, Shape::Wedge, Dashes::Dotted),
    ("wavemap", GREEN, Shape::Star, Dashes::Dotted),
    ("tsdf", GREEN, Shape::Flag, Dashes::Dotted),
    ("mrpt-widening", GREEN, Shape::Plus, Dashes::Dotted),
    ("hit-count-gmapping", AMBER, Shape::Diamond, Dashes::Dotted),
    ("hit-count-karto", AMBER, Shape::Plus, Dashes::Dotted),
    ("visibility-dynamic", SKY, Shape::Square, Dashes::Dashed),
    ("visibility-window", SKY, Shape::Circle, Dashes::Dotted),
    ("log-odds-decay", PURPLE, Shape::Square, Dashes::Dashed),
    ("dynamic-grid", VIOLET, Shape::Diamond, Dashes::Dashed),
    ("visibility-pool", BLUE, Shape::Cross, Dashes::Dotted),
    ("visibility-maximum", BLUE, Shape::Flag, Dashes::Dotted),
    ("octomap-maximum", PURPLE, Shape::Flag, Dashes::Dotted),
    ("miura-2002", RED, Shape::Diamond, Dashes::Dotted),
    ("sonar-moravec", OLIVE, Shape::Diamond, Dashes::Solid),
    ("gibbs", VIOLET, Shape::Star, Dashes::Solid),
    ("gibbs-unchecked", VIOLET, Shape::Cross, Dashes::Dashed),
    ("visibility-touched", BLUE, Shape::Square, Dashes::Dashed),
    ("visibility-all-edges", BLUE, Shape::Diamond, Dashes::Dashed),
    ("visibility-reference", BLUE, Shape::Plus, Dashes::Dotted),
    ("lateral-rays", SKY, Shape::Diamond, Dashes::Dashed),
    ("lateral-edges", SKY, Shape::Flag, Dashes::Dashed),
    ("prior", GREY, Shape::Circle, Dashes::Dotted),
    ("perfect", Colour::BLACK, Shape::Star, Dashes::Dotted),
];

/// Of one's own mappers the first is black; so are no others.
const OWN: (Colour, Shape) = (Colour::BLACK, Shape::Flag);

/// The styles of the mappers of a picture. Those of our own have theirs whatever else is drawn, up to [`MOST_COLOURS`];
/// beyond that, and from the second one that is nobody's but the user's, lines are grey, with their names beside them.
pub fn of_mappers(names: &[&str]) -> Vec<Style> {
    let place = |name: &str| MAPPERS.iter().position(|(known, ..)| *known == name);
    let mut coloured: Vec<(usize, usize)> =
        names.iter().enumerate().filter_map(|(k, name)| Some((place(name)?, k))).collect();
    coloured.sort_unstable();
    let own: Vec<usize> = (0..names.len()).filter(|k| place(names[*k]).is_none()).collect();
    coloured.truncate(MOST_COLOURS - own.len().min(1));
    let style = |(k, name): (usize, &&str)| match place(name) {
        Some(at) => {
            let (_, colour, shape, dashes) = MAPPERS[at];
            let kept = coloured.iter().any(|(_, other)| *other == k);
            let style = Style::marked(if kept { colour } else { GREY }, shape).broken(dashes);
            Style { labelled: !kept, ..style }
        }
        None if own.first() == Some(&k) => Style::marked(OWN.0, OWN.1),
        None => {
            let number = own.iter().position(|other| *other == k).unwrap_or(0);
            Style { labelled: true, ..Style::marked(GREY, Shape::ALL[number % Shape::ALL.len()]) }
        }
    };
    names.iter().enumerate().map(style).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How light a colour is printed in grey, 0 to 255.
    fn grey(Colour(r, g, b): Colour) -> f64 {
        0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)
    }

    #[test]
    fn every_mapper_has_a_style_of_its_own() {
        let known: Vec<&str> = mapper::catalogue::MAPPERS.iter().map(|entry| entry.name).collect();
        for (k, name) in known.iter().enumerate() {
            let (_, colour, shape, dashes) = MAPPERS.iter().find(|entry| entry.0 == *name).expect(name);
            assert!(grey(*colour) < 175.0, "{name} is too light for a line");
            for other in &known[..k] {
                let like = MAPPERS.iter().find(|entry| entry.0 == *other).expect(other);
                assert_ne!((colour, shape), (&like.1, &like.2), "{name} and {other} ({dashes:?})");
            }
        }
        assert_eq!(known.len(), MAPPERS.len());
    }

    #[test]
    fn a_mapper_looks_the_same_whatever_stands_beside_it() {
        let alone = of_mappers(&["mrf"]);
        let among = of_mappers(&["prior", "visibility", "own", "mrf"]);
        assert_eq!(alone[0], among[3]);
        assert_eq!(among[2].stroke.colour, Colour::BLACK);
    }

    #[test]
    fn eight_at_most_have_a_colour_and_the_others_their_names() {
        let names: Vec<&str> = MAPPERS.iter().map(|entry| entry.0).chain(["own", "second"]).collect();
        let styles = of_mappers(&names);
        let grey = |style: &&Style| style.stroke.colour == GREY;
        assert_eq!(styles.iter().filter(|style| !grey(style)).count(), MOST_COLOURS);
        assert!(styles.iter().filter(grey).all(|style| style.labelled));
        assert!(!styles[0].labelled && !styles[names.len() - 2].labelled);
    }

    #[test]
    fn the_first_eight_differ_in_shape() {
        let shapes: Vec<Shape> = MAPPERS[..9].iter().map(|entry| entry.2).collect();
        assert!(shapes.iter().enumerate().all(|(k, shape)| !shapes[..k].contains(shape)));
    }
}
