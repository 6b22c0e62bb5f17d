//! Pictures of ids and mattes of each part, as bytes of a file.
//!
//! A picture of ids has a colour for each part. In OpenEXR its channels R, G, B and A contain that picture in linear
//! light, and Cryptomatte layers accompany it. A matte with layers has the matte of all parts in R, G, B and A, as
//! without layers. In addition, a layer with the name of each part has that part's own matte in its channel A, even
//! where other parts hide it. Instead of a layer it can be a part of the file.

use super::composite::Layers;
use super::coverage::Window;
use super::encode::{self, EncodeError, Format};
use super::form::Form;
use super::layers::{layer_name, layer_names};
use super::streamed::{self, Line, Part};
use super::visible::{Share, Visible, visible};
use super::{cryptomatte, matte};
use rototoon_base::scene::{FrameNumber, Raster, Scene, palette};
use rototoon_image::colour;
use std::collections::BTreeSet;

/// The visible area of each part in each pixel, in the part's colour: red, green and blue, sRGB-encoded and
/// premultiplied, then alpha.
pub fn ids(visible: &Visible) -> Raster<[f32; 4]> {
    let mut pixels = visible.pixels();
    Raster::from_fn(visible.width(), visible.height(), |_, _| mixed(pixels.next().unwrap_or(&[])))
}

/// The colours of the parts of a pixel by their shares, premultiplied, then alpha.
fn mixed(shares: &[Share]) -> [f32; 4] {
    let mut sum = [0.0; 4];
    for share in shares {
        let [r, g, b] = palette::distinct(share.part);
        for (sum, value) in sum.iter_mut().zip([r, g, b, 1.0]) {
            *sum += share.coverage * value;
        }
    }
    sum
}

/// The lines of a channel of that picture in linear light.
fn light(visible: &Visible, channel: usize) -> Line<'_> {
    let light = move |shares: &[Share]| match (channel, mixed(shares)) {
        (3, [.., alpha]) => alpha,
        (_, colour) if colour[3] > 0.0 => colour::decode(colour[channel] / colour[3]) * colour[3],
        _ => 0.0,
    };
    Box::new(move |y, row| row.iter_mut().zip(visible.row(y)).for_each(|(own, shares)| *own = light(shares)))
}

/// Encodes a picture of ids. `parts` selects parts by index; `None` takes all.
///
/// # Errors
///
/// An [`EncodeError`] if encoding fails or two parts have the same Cryptomatte id.
pub fn id_picture(
    scene: &Scene,
    frame: FrameNumber,
    parts: Option<&[usize]>,
    format: Format,
) -> Result<Vec<u8>, EncodeError> {
    let visible = visible(scene, frame, parts);
    let Format::Exr(form) = format else { return encode::premultiplied(&ids(&visible)) };
    let (width, height) = (visible.width(), visible.height());
    let names: Vec<&str> = scene.parts.iter().map(|part| &part.name[..]).collect();
    let attributes = cryptomatte::attributes(closed(scene, parts).map(|index| names[index]))
        .map_err(|error| EncodeError { width, height, reason: error.to_string() })?;
    let mut channels = cryptomatte::lines(&names, &visible);
    let own = ["R", "G", "B", "A"].into_iter().enumerate();
    channels.extend(own.map(|(channel, name)| (name.to_owned(), light(&visible, channel))));
    streamed::encode((width, height), vec![Part { name: None, channels, attributes }], form)
}

/// Encodes the matte of all parts and of each part as OpenEXR. `parts` selects parts by index; `None` takes all.
///
/// # Errors
///
/// An [`EncodeError`].
pub fn matte_layers(
    scene: &Scene,
    frame: FrameNumber,
    parts: Option<&[usize]>,
    form: Form,
) -> Result<Vec<u8>, EncodeError> {
    let whole = matte::matte(scene, frame, parts);
    let masks = Masks::new(scene, frame, parts);
    let mut channels = equal(&whole);
    channels.extend(masks.lines().map(|(name, line)| (format!("{name}.A"), line)));
    streamed::encode((whole.width(), whole.height()), vec![Part { name: None, channels, attributes: Vec::new() }], form)
}

/// Encodes the same mattes as the parts of one OpenEXR file. The first has the matte of all parts in R, G, B and A, and the
/// name `rgba`, by which compositors know the main part. The others have the names of the document's parts and a channel A.
///
/// # Errors
///
/// An [`EncodeError`].
pub fn matte_parts(
    scene: &Scene,
    frame: FrameNumber,
    parts: Option<&[usize]>,
    form: Form,
) -> Result<Vec<u8>, EncodeError> {
    let whole = matte::matte(scene, frame, parts);
    let masks = Masks::new(scene, frame, parts);
    // A part of the document keeps its name, whatever it is.
    let mut taken = masks.list.iter().map(|(name, _)| name.clone()).collect();
    let mut files =
        vec![Part { name: Some(layer_name("rgba", &mut taken)), channels: equal(&whole), attributes: Vec::new() }];
    files.extend(masks.lines().map(|(name, line)| Part {
        name: Some(name.to_owned()),
        channels: vec![("A".to_owned(), line)],
        attributes: Vec::new(),
    }));
    streamed::encode((whole.width(), whole.height()), files, form)
}

/// The masks of closed parts, each with the name of its layer.
struct Masks {
    list: Vec<(String, Layers)>,
    window: Window,
}

impl Masks {
    fn new(scene: &Scene, frame: FrameNumber, parts: Option<&[usize]>) -> Self {
        let order: Vec<usize> = closed(scene, parts).collect();
        let names: Vec<&str> = order.iter().map(|&index| &scene.parts[index].name[..]).collect();
        let masks = order.iter().map(|&index| matte::layers_of(scene, frame, index));
        let (right, bottom) = (scene.footage.width as i64, scene.footage.height as i64);
        let window = Window { left: 0, top: 0, right, bottom };
        Self { list: layer_names(&names, &mut BTreeSet::new()).into_iter().zip(masks).collect(), window }
    }

    /// The name of each mask, and its lines. What a mask needs for them is made with its first line and gone after its last one.
    fn lines(&self) -> impl Iterator<Item = (&str, Line<'_>)> {
        self.list.iter().map(|(name, mask)| {
            let (mut rows, window) = (None, self.window);
            let line: Line = Box::new(move |y, row| {
                let go_on = &mut || true;
                if y == 0 {
                    rows = mask.rows(window, go_on);
                }
                if let Some(values) = rows.as_mut().and_then(|rows| rows.next(go_on)) {
                    row.copy_from_slice(values);
                }
                if y as i64 + 1 == window.bottom {
                    rows = None;
                }
            });
            (&name[..], line)
        })
    }
}

/// A matte in all four channels.
fn equal(matte: &Raster<f32>) -> Vec<(String, Line<'_>)> {
    let line = || -> Line { Box::new(|y, row| row.copy_from_slice(matte.row(y))) };
    ["R", "G", "B", "A"].map(|name| (name.to_owned(), line())).into()
}

/// The closed ones of some parts.
fn closed(scene: &Scene, parts: Option<&[usize]>) -> impl Iterator<Item = usize> {
    (0..scene.parts.len())
        .filter(move |index| scene.parts[*index].closed && parts.is_none_or(|parts| parts.contains(index)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::{Footage, Part};
    use std::collections::BTreeMap;

    /// Discs in a ring. Each overlaps the next one, and all of them overlap in the middle.
    fn scene(count: usize) -> Scene {
        let footage = Footage { pattern: "%d".into(), first: 0, last: 0, fps: 1.0, width: 60, height: 50, held: false };
        let part = |index: usize| {
            let turn = std::f64::consts::TAU / count as f64;
            let middle = Point::new(30.3, 24.6) + 10.0 * Point::from_angle(turn * index as f64);
            let points = (0..30).map(|k| middle + 10.4 * Point::from_angle(0.21 * f64::from(k))).collect();
            let depth = (index * 2 % count) as f64;
            let name = format!("part {index}.é");
            Part { name, closed: true, depth, keys: BTreeMap::from([(0, points)]), ..Part::default() }
        };
        Scene { footage, parts: (0..count).map(part).collect() }
    }

    type File = (BTreeMap<String, Vec<f32>>, BTreeMap<String, String>);

    fn read(bytes: &[u8]) -> File {
        use exr::prelude::{ReadChannels, ReadLayers};
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(std::io::Cursor::new(bytes))
            .unwrap();
        let text = |text: &exr::prelude::Text| String::from_utf8(text.as_slice().to_vec()).unwrap();
        let layer = &image.layer_data;
        let channels = &layer.channel_data.list;
        let channels = channels.iter().map(|c| (text(&c.name), c.sample_data.values_as_f32().collect())).collect();
        let attributes = layer.attributes.other.iter().filter_map(|(name, value)| match value {
            exr::prelude::AttributeValue::Text(value) => Some((text(name), text(value))),
            _ => None,
        });
        (channels, attributes.collect())
    }

    /// A part's matte, read by the rules of the specification alone.
    fn keyed((channels, attributes): &File, name: &str) -> Vec<f32> {
        let value = |field: &str| {
            let mut found =
                attributes.iter().filter(|(key, _)| key.starts_with("cryptomatte/") && key.ends_with(field));
            let value = found.next().unwrap().1.clone();
            assert!(found.next().is_none());
            value
        };
        assert_eq!([value("/hash"), value("/conversion")], ["MurmurHash3_32", "uint32_to_float32"]);
        let manifest: serde_json::Value = serde_json::from_str(&value("/manifest")).unwrap();
        let id = u32::from_str_radix(manifest[name].as_str().unwrap(), 16).unwrap();
        let layer = value("/name");
        let mut sum = vec![0.0; channels["A"].len()];
        for rank in (0..100).take_while(|rank| channels.contains_key(&format!("{layer}{rank:02}.R"))) {
            for pair in [["R", "G"], ["B", "A"]] {
                let [ids, coverage] = pair.map(|channel| &channels[&format!("{layer}{rank:02}.{channel}")]);
                for (at, sum) in sum.iter_mut().enumerate() {
                    if ids[at].to_bits() == id {
                        *sum += coverage[at];
                    }
                }
            }
        }
        sum
    }

    #[test]
    fn every_part_is_keyed_from_the_cryptomatte_layers() {
        for count in [1, 3, 9] {
            let scene = scene(count);
            let file = read(&id_picture(&scene, 0, None, Format::EXR).unwrap());
            assert_eq!(file.0.len() % 4, 0);
            let mut nearest: Vec<usize> = (0..count).collect();
            nearest.sort_by(|&a, &b| scene.parts[b].depth.total_cmp(&scene.parts[a].depth));
            for (rank, &part) in nearest.iter().enumerate() {
                let before = matte::matte(&scene, 0, Some(&nearest[..rank]));
                let with = matte::matte(&scene, 0, Some(&nearest[..=rank]));
                let found = keyed(&file, &scene.parts[part].name);
                let mut partial = 0;
                for (at, found) in found.iter().enumerate() {
                    let expected = with.data()[at] - before.data()[at];
                    assert!((found - expected).abs() < 1.0 / 255.0, "{count} {part} {at}: {found} {expected}");
                    partial += usize::from((0.05..0.95).contains(&expected));
                }
                assert!(partial > 4, "{count} {part}: {partial}");
            }
            let whole = matte::matte(&scene, 0, None);
            assert!(file.0["A"].iter().zip(whole.data()).all(|(a, b)| (a - b).abs() < 1e-5));
        }
    }

    #[test]
    fn ranks_fall_and_what_is_unused_is_zero() {
        let (channels, _) = read(&id_picture(&scene(9), 0, None, Format::EXR).unwrap());
        let rank = |rank: usize| {
            let [id, coverage] = [["R", "G"], ["B", "A"]][rank % 2];
            let name = |channel: &str| format!("CryptoObject{:02}.{channel}", rank / 2);
            (&channels[&name(id)], &channels[&name(coverage)])
        };
        for at in 0..60 * 50 {
            for n in 0..6 {
                let (id, coverage) = rank(n);
                assert_eq!(id[at] == 0.0, coverage[at] == 0.0);
                assert!(n == 0 || coverage[at] <= rank(n - 1).1[at]);
            }
        }
    }

    #[test]
    fn more_parts_in_a_pixel_than_ranks_are_all_kept() {
        let mut scene = scene(9);
        for (index, part) in scene.parts.iter_mut().enumerate() {
            let (left, right) = (30.0 + index as f64 / 9.0, 30.0 + (index + 1) as f64 / 9.0);
            let points = [(left, 20.0), (right, 20.0), (right, 30.0), (left, 30.0)].map(|(x, y)| Point::new(x, y));
            part.keys.insert(0, points.into());
        }
        let file = read(&id_picture(&scene, 0, None, Format::EXR).unwrap());
        for part in &scene.parts {
            assert!((keyed(&file, &part.name)[25 * 60 + 30] - 1.0 / 9.0).abs() < 1e-5);
        }
        assert!(file.0.contains_key("CryptoObject04.R") && !file.0.contains_key("CryptoObject05.R"));
    }

    #[test]
    fn layers_hold_whole_mattes() {
        let scene = scene(3);
        let (channels, _) = read(&matte_layers(&scene, 0, Some(&[0, 2]), Form::default()).unwrap());
        let names: Vec<_> = channels.keys().map(String::as_str).collect();
        assert_eq!(names, ["A", "B", "G", "R", "part 0_é.A", "part 2_é.A"]);
        assert_eq!(channels["A"], matte::matte(&scene, 0, Some(&[0, 2])).data());
        assert_eq!(channels["part 2_é.A"], matte::matte(&scene, 0, Some(&[2])).data());
    }

    #[test]
    fn parts_of_a_file_hold_whole_mattes() {
        let mut scene = scene(3);
        // A name that the file's first part would have.
        scene.parts[1].name = "rgba".into();
        let bytes = matte_parts(&scene, 0, Some(&[1, 2]), Form::default()).unwrap();
        let read = exr::prelude::read_all_flat_layers_from_file;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        std::fs::write(&path, &bytes).unwrap();
        let parts = read(&path).unwrap().layer_data;
        let names = parts.iter().map(|part| part.attributes.layer_name.as_ref().unwrap().as_slice().to_vec());
        let names: Vec<String> = names.map(|name| String::from_utf8(name).unwrap()).collect();
        assert_eq!(names, ["rgba 2", "rgba", "part 2_é"]);
        let expected = [Some(&[1, 2][..]), Some(&[1]), Some(&[2])].map(|parts| matte::matte(&scene, 0, parts));
        for (part, (expected, channels)) in parts.iter().zip(expected.iter().zip([4, 1, 1])) {
            assert_eq!(part.channel_data.list.len(), channels);
            for channel in &part.channel_data.list {
                assert!(channel.sample_data.values_as_f32().eq(expected.data().iter().copied()));
            }
        }
    }

    #[test]
    fn the_header_names_the_closed_ones_of_the_parts() {
        let mut scene = scene(3);
        scene.parts[1].closed = false;
        let named = |parts: Option<&[usize]>| {
            let (_, attributes) = read(&id_picture(&scene, 0, parts, Format::EXR).unwrap());
            let manifest = attributes.iter().find(|(key, _)| key.ends_with("/manifest")).unwrap().1;
            serde_json::from_str::<BTreeMap<String, String>>(manifest).unwrap().into_keys().collect::<Vec<_>>()
        };
        assert_eq!(named(None), ["part 0.é", "part 2.é"]);
        assert_eq!(named(Some(&[0, 1])), ["part 0.é"]);
    }

    #[test]
    fn ids_in_png_are_colours_of_parts() {
        let scene = scene(2);
        let bytes = id_picture(&scene, 0, None, Format::Png).unwrap();
        let image = image::load_from_memory(&bytes).unwrap().to_rgba8();
        let [r, g, b] = palette::distinct(0).map(|c| (c * 255.0).round() as u8);
        assert_eq!(image.get_pixel(40, 24).0, [r, g, b, 255]);
        assert_eq!(image.get_pixel(0, 0).0[3], 0);
    }
}
