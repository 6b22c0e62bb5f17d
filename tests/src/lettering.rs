//! Lettering for plots and sheets. Characters are made of strokes, so pictures need no font and look the same everywhere.
//!
//! Each character is a few polylines on a grid of 5 columns and 9 rows. A polyline is written as pairs of digits (column,
//! row). Capitals use rows 0 to 6, small letters rows 2 to 6, and descenders reach row 8. A polyline of one point is a dot.

use tiny_skia::{Color, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

/// Rows from the top of a capital to the baseline.
const CAPITAL: f32 = 6.0;
/// Columns between characters.
const SPACE: f32 = 2.0;
/// Columns of a blank.
const BLANK: f32 = 2.0;
/// Width of a stroke in rows.
const STROKE: f32 = 0.8;

/// The width in pixels of a text whose capitals are `size` pixels high.
pub fn width(text: &str, size: f32) -> f32 {
    let columns: f32 = text.chars().map(|c| columns(c) + SPACE).sum();
    (columns - SPACE).max(0.0) * size / CAPITAL
}

/// Draws a text with capitals of `size` pixels. `at` is the left end of the baseline, in pixels. If `turned`, the text runs
/// upwards.
pub fn draw(picture: &mut Pixmap, text: &str, at: [f32; 2], size: f32, colour: Color, turned: bool) {
    let Some(path) = path(text) else { return };
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(colour);
    let stroke = Stroke { width: STROKE, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    let turn = if turned { Transform::from_rotate(-90.0) } else { Transform::identity() };
    let scale = size / CAPITAL;
    let place = turn.post_scale(scale, scale).post_translate(at[0], at[1]);
    picture.stroke_path(&path, &paint, &stroke, place, None);
}

/// The strokes of a text, in rows, with the left end of the baseline as origin.
fn path(text: &str) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let mut left = 0.0;
    for c in text.chars() {
        for line in strokes(c).split_whitespace() {
            let digits: Vec<f32> = line.bytes().map(|b| f32::from(b - b'0')).collect();
            let places: Vec<[f32; 2]> = digits.chunks_exact(2).map(|p| [left + p[0], p[1] - CAPITAL]).collect();
            builder.move_to(places[0][0], places[0][1]);
            places[1..].iter().for_each(|p| builder.line_to(p[0], p[1]));
            if places.len() == 1 {
                builder.line_to(places[0][0] + 0.01, places[0][1]);
            }
        }
        left += columns(c) + SPACE;
    }
    builder.finish()
}

/// The width of a character in columns.
fn columns(c: char) -> f32 {
    let places = strokes(c).split_whitespace().flat_map(|line| line.bytes().step_by(2));
    places.max().map_or(BLANK, |column| f32::from(column - b'0'))
}

/// Characters and their polylines.
const STROKES: [(&str, &str); 80] = [
    (" ", ""),
    ("0O", "103041453616050110"),
    ("1", "022026 0646"),
    ("2", "01103041420646"),
    ("3", "01103041423313 334445361605"),
    ("4", "36300444"),
    ("5", "400002324345361605"),
    ("6", "413010010516364544331304"),
    ("7", "004016"),
    ("8", "103041423313020110 1304051636454433"),
    ("9", "051636454130100102133342"),
    ("A", "062046 1434"),
    ("B", "00063645443303 3342413000"),
    ("C", "4130100105163645"),
    ("D", "00062644422000"),
    ("E", "40000646 0333"),
    ("F", "400006 0333"),
    ("G", "41301001051636454323"),
    ("H", "0006 4046 0343"),
    ("I", "0006"),
    ("J", "4045361605"),
    ("K", "0006 4003 1346"),
    ("L", "000646"),
    ("M", "0600234046"),
    ("N", "06004640"),
    ("P", "06003041423303"),
    ("Q", "103041453616050110 2446"),
    ("R", "06003041423303 2346"),
    ("S", "413010010213334445361605"),
    ("T", "0040 2026"),
    ("U", "000516364540"),
    ("V", "002640"),
    ("W", "0016223640"),
    ("X", "0046 4006"),
    ("Y", "002340 2326"),
    ("Z", "00400646"),
    ("a", "12324346 43130405163645"),
    ("b", "0006 0312324345361605"),
    ("c", "4332120305163645"),
    ("d", "4046 4332120305163645"),
    ("e", "04444332120305163645"),
    ("f", "30201116 0232"),
    ("g", "4332120305163645 4247381807"),
    ("h", "0006 0312324346"),
    ("i", "0206 00"),
    ("j", "121708 10"),
    ("k", "0006 3204 1436"),
    ("l", "000516"),
    ("m", "0206 03122326 23324346"),
    ("n", "0206 0312324346"),
    ("o", "123243453616050312"),
    ("p", "0208 0312324345361605"),
    ("q", "4248 4332120305163645"),
    ("r", "0206 031232"),
    ("s", "43321203143445361605"),
    ("t", "10152636 0232"),
    ("u", "0205163645 4246"),
    ("v", "022642"),
    ("w", "0216233642"),
    ("x", "0246 4206"),
    ("y", "0226 42261808"),
    ("z", "02420646"),
    (".", "06"),
    (",", "1508"),
    (":", "03 06"),
    (";", "13 1508"),
    ("'", "0002"),
    ("-", "0434"),
    ("–", "0444"),
    ("_", "0747"),
    ("%", "4006 0010110100 3545463635"),
    ("/", "4007"),
    ("(", "20121527"),
    (")", "00121507"),
    ("+", "0444 2226"),
    ("=", "0343 0545"),
    ("<", "420446"),
    (">", "024406"),
    ("·", "04"),
    ("×", "0246 4206"),
];

/// The polylines of a character that is not in the table: a box.
const BOX: &str = "0040460600";

/// The polylines of a character.
fn strokes(c: char) -> &'static str {
    STROKES.iter().find(|(characters, _)| characters.contains(c)).map_or(BOX, |(_, lines)| lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz.,:;'-–_%/()+=<>·×";

    #[test]
    fn strokes_are_on_the_grid_and_characters_differ() {
        let mut seen: Vec<(char, &str)> = Vec::new();
        for c in KNOWN.chars() {
            for line in strokes(c).split(' ') {
                assert!(!line.is_empty() && line.len() % 2 == 0, "{c}: {line:?}");
                assert!(line.bytes().step_by(2).all(|b| (b'0'..=b'4').contains(&b)), "{c}: {line:?}");
                assert!(line.bytes().skip(1).step_by(2).all(|b| (b'0'..=b'8').contains(&b)), "{c}: {line:?}");
            }
            let twin = seen.iter().find(|(_, other)| *other == strokes(c));
            assert!(twin.is_none_or(|(other, _)| ['0', 'x'].contains(other)), "{c} looks like {twin:?}");
            assert_ne!(strokes(c), strokes('\u{7f}'), "{c} is not known");
            seen.push((c, strokes(c)));
        }
    }

    #[test]
    fn a_text_has_its_stated_width() {
        assert_eq!(width("", 12.0), 0.0);
        assert_eq!(width("I", 12.0), 0.0);
        assert_eq!(width("HH", 12.0), 20.0);
        let mut picture = Pixmap::new(60, 40).unwrap();
        draw(&mut picture, "HH", [10.0, 30.0], 12.0, Color::BLACK, false);
        let inked = |x: u32| (0..40).any(|y| picture.pixel(x, y).unwrap().alpha() > 128);
        let columns: Vec<u32> = (0..60).filter(|&x| inked(x)).collect();
        assert_eq!((columns[0], columns[columns.len() - 1]), (9, 30));
        let rows: Vec<u32> = (0..40).filter(|&y| (0..60).any(|x| picture.pixel(x, y).unwrap().alpha() > 128)).collect();
        assert_eq!((rows[0], rows[rows.len() - 1]), (18, 29));
    }

    #[test]
    fn turned_text_goes_upwards() {
        let mut picture = Pixmap::new(40, 60).unwrap();
        draw(&mut picture, "HH", [30.0, 50.0], 12.0, Color::BLACK, true);
        let inked = |x: u32, y: u32| picture.pixel(x, y).unwrap().alpha() > 128;
        assert!((19..30).all(|x| inked(x, 49)), "the first stroke is horizontal");
        assert!((0..40).all(|x| !inked(x, 55) && !inked(x, 20)));
    }
}
