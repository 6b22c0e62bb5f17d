//! The transformations of layers.
//!
//! A layer's property `transform.matrix` has 16 numbers, still or on keys. They are the columns of a matrix one after the other,
//! so a translation is the thirteenth and the fourteenth. In coordinates of the file a point (x, y) goes to the first two
//! numbers of M (x, y, 0, 1), divided by the fourth: the matrix may be a perspective. A layer's own matrix comes first, then those
//! of the layers around it. Between keys the numbers change evenly; a key with `interp="hold"` keeps its own.
//!
//! Source: M. Borgo's exporter for Nuke (NukeFXSExporter), which maps the corners of the picture by each layer's transformation
//! and writes the projective matrix from corners to corners; Nuke stores a `Matrix4` by columns.

use super::super::problem::{number, quoted};
use rototoon_base::geometry::Point;
use roxmltree::Node;

/// Difference from the identity that is only rounding. At 10 000 lines it is a pixel.
const ROUNDING: f64 = 1e-4;
/// Difference from the key before that is only rounding of the written decimals.
const SAME: f64 = 2e-6;
/// The least number that a point may be divided by. Beyond it lies the horizon of a perspective.
const LEAST: f64 = 1e-6;

type Matrix = [f64; 16];

const IDENTITY: Matrix = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];

fn same(a: &Matrix, b: &Matrix, most: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= most)
}

/// A matrix on a frame.
struct Key {
    frame: f64,
    held: bool,
    matrix: Matrix,
}

/// The matrices of a layer.
pub(super) struct Transform {
    keys: Vec<Key>,
}

impl Transform {
    /// The matrices in a property; `None` if they move nothing. `first` is the frame of a key 0.
    ///
    /// # Errors
    ///
    /// What was found and expected, in words.
    pub fn read(property: Node, first: f64) -> Result<Option<Self>, String> {
        let mut keys = Vec::new();
        for node in property.children().filter(Node::is_element) {
            let Some(matrix) = matrix(node.text().unwrap_or("")) else {
                let found = quoted(node.text().map(str::trim));
                return Err(format!("transform.matrix: found {found}, expected 16 numbers"));
            };
            let frame = number(node, "frame").map_err(|error| error.to_string())?.unwrap_or_default() + first;
            let held = node.attribute("interp").is_some_and(|text| text.eq_ignore_ascii_case("hold"));
            keys.push(Key { frame, held, matrix });
        }
        keys.sort_by(|a, b| a.frame.total_cmp(&b.frame));
        let moves = keys.iter().any(|key| !same(&key.matrix, &IDENTITY, ROUNDING));
        Ok(moves.then_some(Self { keys }))
    }

    /// The frames on which the matrix may turn to another one.
    pub fn turns(&self) -> Vec<f64> {
        let mut found = Vec::new();
        for pair in self.keys.windows(2).filter(|pair| !same(&pair[0].matrix, &pair[1].matrix, SAME)) {
            found.extend([pair[0].frame, pair[1].frame]);
            found.extend(pair[0].held.then_some(pair[1].frame - 1.0));
        }
        found.sort_by(f64::total_cmp);
        found.dedup();
        found
    }

    fn at(&self, frame: f64) -> Matrix {
        let next = self.keys.partition_point(|key| key.frame <= frame);
        match (next.checked_sub(1).map(|k| &self.keys[k]), self.keys.get(next)) {
            (Some(from), Some(to)) if !from.held => {
                let share = (frame - from.frame) / (to.frame - from.frame);
                std::array::from_fn(|k| from.matrix[k] + share * (to.matrix[k] - from.matrix[k]))
            }
            (Some(key), _) | (None, Some(key)) => key.matrix,
            (None, None) => IDENTITY,
        }
    }

    /// A point of the file on a frame; `None` beyond the horizon.
    pub fn point(&self, p: Point, frame: f64) -> Option<Point> {
        let m = self.at(frame);
        let row = |k: usize| m[k] * p.x + m[4 + k] * p.y + m[12 + k];
        let depth = row(3);
        (depth >= LEAST).then(|| Point::new(row(0), row(1)) / depth)
    }
}

fn matrix(text: &str) -> Option<Matrix> {
    let text = text.trim().trim_start_matches('(').trim_end_matches(')');
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let numbers: Matrix = numbers?.try_into().ok()?;
    numbers.iter().all(|number| number.is_finite()).then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(keys: &str) -> Result<Option<Transform>, String> {
        let text = format!("<Property>{keys}</Property>");
        let document = roxmltree::Document::parse(&text).unwrap();
        Transform::read(document.root_element(), 10.0)
    }

    fn near(found: Option<Point>, x: f64, y: f64) {
        assert!(found.unwrap().distance(Point::new(x, y)) < 1e-12, "{found:?}");
    }

    #[test]
    fn the_columns_follow_one_another() {
        // x' = 2 x + 3 y + 0.5, y' = 4 x + 5 y + 0.25, w = 1 + x.
        let found = read("<Value>(2,4,0,1, 3,5,0,0, 0,0,1,0, 0.5,0.25,0,1)</Value>").unwrap().unwrap();
        near(found.point(Point::new(0.25, 0.5), 3.0), 2.5 / 1.25, 3.75 / 1.25);
        assert_eq!(found.point(Point::new(-1.0, 0.0), 3.0), None, "the horizon");
        assert_eq!(found.turns(), [0.0; 0]);
    }

    #[test]
    fn keys_move_evenly_or_hold() {
        let key = |frame: i32, x: f64, held: &str| {
            format!("<Key frame=\"{frame}\" interp=\"{held}\">(1,0,0,0,0,1,0,0,0,0,1,0,{x},0,0,1)</Key>")
        };
        let still = key(8, 0.4, "linear") + &key(9, 0.400001, "linear");
        let text = key(4, 0.4, "hold") + &key(0, 0.0, "linear") + &key(6, 0.2, "linear") + &still;
        let found = read(&text).unwrap().unwrap();
        for (frame, x) in
            [(0.0, 0.0), (11.0, 0.1), (14.0, 0.4), (15.0, 0.4), (16.0, 0.2), (17.0, 0.3), (30.0, 0.400001)]
        {
            near(found.point(Point::ZERO, frame), x, 0.0);
        }
        assert_eq!(found.turns(), [10.0, 14.0, 15.0, 16.0, 18.0]);
    }

    #[test]
    fn what_moves_nothing_is_none_and_what_is_no_matrix_is_told() {
        assert!(read("<Value>(1,0,0,0,0,1,0,0,0,0,1,0,0.00009,-0,0,1)</Value>").unwrap().is_none());
        assert!(read("").unwrap().is_none());
        for text in ["(1,0,0)", "", "(1,0,0,0,0,1,0,0,0,0,1,0,nan,0,0,1)"] {
            let told = read(&format!("<Value>{text}</Value>")).err().unwrap();
            assert!(told.contains("expected 16 numbers"), "{told}");
        }
    }
}
